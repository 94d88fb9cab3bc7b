"""How good maps in three dimensions are: the end of a long way, and points beside true surfaces.

    python benchmarks/mapping_3d.py four_rooms warehouse --seeds 0:3 --way 150

A base with the sensors of kinova_jackal rolls from place to place at random until it has gone
that far, then back to where it began; `--sway` lets it roll and pitch. Off is how far the mapped
end lies from the true one, as a share of the way; points are those of the cloud, and their distance
to the nearest true surface.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import trimesh
from momantu_skills.mapping.three_d.raster import cloud_of
from momantu_skills.mapping.three_d.surveying import CloudSurvey
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.build.meshes import map_triangles
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.geometry.plane import Passages
from momantu_worlds.scenes.loading import draw_episode, load_world
from rolling.turning import Tick, Turning
from rolling.world import free_floor
from scipy.spatial import cKDTree

from momantu_bt.formats.seeds import parse_seeds
from momantu_bt.geometry import Array, Transform
from momantu_bt.world import seeded

REST = 1.0
"""Time for which the base stands at first, s."""
SPACING = 0.04
"""Distance of the samples of true surfaces by which near triangles are found, m."""
NEAR = 6
"""Samples near a point whose triangles are compared."""


def ways(turning: Turning, episode: Episode, way: float, seed: int) -> Iterator[Tick]:
    """A drive of at least `way` m, back to where it began."""
    floor = free_floor(episode, kinova_jackal())
    start = floor.nearest_free((episode.start.x, episode.start.y))
    rows, columns = np.nonzero(floor.reachable(start))
    random = seeded(seed, "ways")
    yield from turning.rest(REST)
    at = start
    while turning.way < way:
        pick = int(random.integers(len(rows)))
        goal = (
            floor.origin[0] + floor.cell * float(columns[pick]),
            floor.origin[1] + floor.cell * float(rows[pick]),
        )
        yield from turning.along(straight(floor, floor.route(at, goal)))
        at = goal
    yield from turning.along(straight(floor, floor.route(at, start)))


def straight(floor: Passages, route: Array) -> list[tuple[float, float]]:
    """The corners of a route: those points from which the next ones are not in a free line."""
    kept, number = [route[0]], 0
    while number < len(route) - 1:
        after = len(route) - 1
        while after > number + 1 and not clear(floor, route[number], route[after]):
            after = number + (after - number) // 2
        number = after
        kept.append(route[number])
    return [(float(x), float(y)) for x, y in kept]


def clear(floor: Passages, begin: Array, end: Array) -> bool:
    """Whether a straight line lies on free cells."""
    steps = max(2, int(np.linalg.norm(end - begin) / (0.5 * floor.cell)))
    line = begin + np.linspace(0.0, 1.0, steps)[:, None] * (end - begin)
    columns, rows = np.rint((line - np.array(floor.origin)) / floor.cell).astype(int).T
    return bool(floor.free[rows, columns].all())


def surfaces_apart(points: Array, triangles: Array) -> Array:
    """Distances (n,) of points (n, 3) to the nearest triangle (k, 3, 3) or the floor, m."""
    mesh = trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(len(triangles) * 3).reshape(-1, 3))
    count = int(mesh.area / SPACING**2)
    samples, owner = trimesh.sample.sample_surface(mesh, count, seed=0)
    near = cKDTree(samples).query(points, k=NEAR)[1]
    best = np.abs(points[:, 2])
    for column in owner[near].T:
        closest = trimesh.triangles.closest_point(triangles[column], points)
        best = np.minimum(best, np.linalg.norm(closest - points, axis=1))
    return best


def measured(world: str, seed: int, way: float, sway: float) -> dict[str, float | str]:
    """One drive through one world, mapped."""
    named = Path(world) if world.endswith(".yaml") else world
    load_world(named)
    episode = draw_episode(named, seed)
    turning = Turning(kinova_jackal(), episode, seed, sway)
    survey = CloudSurvey(turning.base_from_imu, episode.start.transform())
    spent, turns, truth, wheels = 0.0, 0, Transform(), Transform()
    for number, tick in enumerate(ways(turning, episode, way, seed)):
        began = time.process_time()
        survey.move(tick.stamp, tick.odom_from_base, tick.imu)
        spent += time.process_time() - began
        truth, wheels = tick.truth, episode.start.transform() @ tick.odom_from_base
        if number % 2:
            cloud = turning.turn()
            began = time.process_time()
            survey.add(cloud, turning.base_from_lidar)
            spent += time.process_time() - began
            turns += 1
    began = time.process_time()
    mapper = survey.mapper
    mapper.finish()
    spent += time.process_time() - began
    off = truth.position - mapper.map_from_base.position
    points = cloud_of(mapper)
    apart = surfaces_apart(points, map_triangles(list(episode.bodies)))
    end = float(np.linalg.norm(off))
    return {
        "world": world,
        "seed": seed,
        "way_m": round(turning.way, 1),
        "turns": turns,
        "kept": len(mapper.keyframes),
        "loops": len(mapper.closed),
        "doubtful": mapper.doubtful,
        "wheels_off_m": round(math.dist(wheels.position, truth.position), 3),
        "off_m": round(end, 4),
        "off_per_cent": round(100 * end / turning.way, 4),
        "z_off_m": round(float(off[2]), 4),
        "points": len(points),
        "points_mean_m": round(float(apart.mean()), 4),
        "points_95_m": round(float(np.quantile(apart, 0.95)), 4),
        "ms_per_turn": round(1000 * spent / turns, 1),
    }


def main() -> None:
    """Measure and print one line of JSON for each drive."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("worlds", nargs="+")
    parser.add_argument("--seeds", default="0:1")
    parser.add_argument("--way", type=float, default=150.0)
    parser.add_argument("--sway", type=float, default=0.0)
    told = parser.parse_args()
    for world in told.worlds:
        for seed in parse_seeds(told.seeds):
            print(json.dumps(measured(world, seed, told.way, told.sway)), flush=True)


if __name__ == "__main__":
    main()
