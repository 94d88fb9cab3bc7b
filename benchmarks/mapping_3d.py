"""How good maps in three dimensions are: the end of a long way, and points beside true surfaces.

    python benchmarks/mapping_3d.py four_rooms warehouse --seeds 0:3 --way 150

A base with the sensors of kinova_jackal rolls from place to place at random until it has gone
that far, then back to where it began; `--sway` lets it roll and pitch. Off is how far the mapped
end lies from the true one, as a share of the way; the way itself is compared turn by turn. Points
are those of the cloud, compared with the nearest true surface.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from momantu_skills.mapping.three_d.raster import cloud_of
from momantu_skills.mapping.three_d.surveying import CloudSurvey
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.build.meshes import map_triangles
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.geometry.plane import Passages
from momantu_worlds.scenes.loading import draw_episode
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


@dataclass(frozen=True, slots=True, eq=False)
class Mapped:
    """A drive and its map. passed: (n, 3) true places of the turns; wheels: where odometry ends."""

    survey: CloudSurvey
    way: float
    passed: Array
    wheels: Transform
    seconds: float


def mapped(episode: Episode, seed: int, way: float, sway: float) -> Mapped:
    """Drive through a world and map it."""
    turning = Turning(kinova_jackal(), episode, seed, sway)
    start = episode.start.transform()
    survey = CloudSurvey(turning.base_from_imu, start)
    passed, seconds, wheels = [], 0.0, start
    for number, tick in enumerate(ways(turning, episode, way, seed)):
        cloud = turning.turn() if number % 2 else None
        began = time.process_time()
        survey.move(tick.stamp, tick.odom_from_base, tick.imu)
        if cloud is not None:
            survey.add(cloud, turning.base_from_lidar)
            passed.append(tick.truth.position)
        seconds += time.process_time() - began
        wheels = start @ tick.odom_from_base
    began = time.process_time()
    survey.mapper.finish()
    seconds += time.process_time() - began
    return Mapped(survey, turning.way, np.array(passed), wheels, seconds)


def measured(world: str, seed: int, way: float, sway: float) -> dict[str, float | str]:
    """One drive through one world, mapped."""
    named = Path(world) if world.endswith(".yaml") else world
    episode = draw_episode(named, seed)
    drive = mapped(episode, seed, way, sway)
    mapper, turns = drive.survey.mapper, len(drive.passed)
    found = np.array([pose.position for _, pose in mapper.trajectory()])
    beside = np.linalg.norm(found - drive.passed, axis=1)
    points = cloud_of(mapper)
    apart = surfaces_apart(points, map_triangles(list(episode.bodies)))
    return {
        "world": world,
        "seed": seed,
        "way_m": round(drive.way, 1),
        "turns": turns,
        "kept": len(mapper.keyframes),
        "loops": len(mapper.closed),
        "doubtful": mapper.doubtful,
        "wheels_off_m": round(math.dist(drive.wheels.position, drive.passed[-1]), 3),
        "off_m": round(float(beside[-1]), 4),
        "off_per_cent": round(100 * float(beside[-1]) / drive.way, 4),
        "way_off_mean_m": round(float(beside.mean()), 4),
        "way_off_most_m": round(float(beside.max()), 4),
        "z_off_m": round(float((found - drive.passed)[-1, 2]), 4),
        "points": len(points),
        "points_mean_m": round(float(apart.mean()), 4),
        "points_95_m": round(float(np.quantile(apart, 0.95)), 4),
        "ms_per_turn": round(1000 * drive.seconds / turns, 1),
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
