"""How well a robot explores: what of the floor it knows, and how far off its walls are.

    python benchmarks/exploration.py --world small_flat --robot fetch --seeds 0:3 -o runs/explored

Each seed's map is made by `momantu-bt map --world` unless the folder has it already, and laid on
the true building, whose frame it has as its start was measured: where its occupied cells lie
nearest to what the laser can see. Floor counts that the base gets to with the clearance that its
planner asks for, around everything below the robot's height, and that the site's own plan has.
times_tour is the time as a multiple of what a short tour of the known building takes at the base's
full speed (`shortest_tour.py`).
"""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path

import numpy as np
from momantu_skills.mapping import exploring
from momantu_skills.navigation.control.footprint import half_width
from momantu_skills.navigation.drive.route import EXTRA
from momantu_skills.navigation.map.fields import clearance
from momantu_worlds.scenes.arrange.obstacles import DOORSTEP
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.loading import draw_episode, load_world
from momantu_worlds.scenes.site.coverage import columns_of, covered
from momantu_worlds.scenes.site.floor_plan import draw_plans
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label, map_coordinates
from scipy.optimize import least_squares
from shortest_tour import tour_length

from momantu_bt.formats.maps import OCCUPIED, UNKNOWN, MapPicture, read_map
from momantu_bt.geometry import Array
from momantu_bt.robot import RobotDescription, laser_band
from momantu_bt.robots.plugins import load_robot

CELL = 0.02
"""Cell of the true building, m."""
TOUR_CELL = 0.1
"""Cell on which the tour is looked for, m."""
MARGIN = 2.0
FAR = 0.15
"""Distance from a true surface beyond which a cell is a wall that is not there, m."""

Mask = NDArray[np.bool_]


class Truth:
    """The building of an episode. seen: what the laser meets; floor: what the base gets to."""

    def __init__(self, world: str, episode: Episode, robot: RobotDescription) -> None:
        parts = [c for b in episode.bodies for c in columns_of(b.parts, b.map_from_body)]
        x0, y0, x1, y1 = episode.site.area or (-20.0, -20.0, 20.0, 20.0)
        self.low = np.array([x0, y0]) - MARGIN
        columns, rows = np.ceil((np.array([x1, y1]) + MARGIN - self.low) / CELL).astype(int)
        axes = (self.low[k] + CELL * (np.arange(n) + 0.5) for k, n in enumerate((columns, rows)))
        centres = np.stack(np.meshgrid(*axes), axis=-1)
        self.seen: Mask = covered(centres, parts, CELL, laser_band(robot))
        solid = self.seen | covered(centres, parts, CELL, (DOORSTEP, robot.height))
        radius = half_width(np.array(robot.footprint)) + EXTRA
        stands = clearance(solid, CELL) >= radius
        regions, _ = label(stands)
        row, column = (
            (np.array([episode.start.y, episode.start.x]) - self.low[::-1]) / CELL
        ).astype(int)
        reached = regions == regions[row, column]
        self.floor: Mask = (distance_transform_edt(~reached) * CELL <= radius) & ~solid
        self.floor &= _indoors(world, robot, centres)
        self.stands: Mask = reached
        self.start = int(row), int(column)
        self.away: Array = distance_transform_edt(~self.seen) * CELL

    def tour(self) -> float:
        """Length of a short tour that shows the floor, m."""
        step = round(TOUR_CELL / CELL)
        return tour_length(
            _coarse(self.seen, step, any_of=True),
            _coarse(self.floor, step, any_of=False),
            _coarse(self.stands, step, any_of=True),
            (self.start[0] // step, self.start[1] // step),
            step * CELL,
        )

    def distances(self, points: Array) -> Array:
        """Distances (n,) of points (n, 2) to what the laser can meet, m; 0 inside."""
        at = (points - self.low) / CELL - 0.5
        return np.asarray(map_coordinates(self.away, at[:, ::-1].T, order=1, mode="nearest"))


def _coarse(mask: Mask, step: int, *, any_of: bool) -> Mask:
    """A mask of larger cells, of which any or all must be part of it."""
    rows, columns = (edge // step * step for edge in mask.shape)
    blocks = mask[:rows, :columns].reshape(rows // step, step, columns // step, step)
    return np.asarray(blocks.any(axis=(1, 3)) if any_of else blocks.all(axis=(1, 3)))


def _indoors(world: str, robot: RobotDescription, centres: Array) -> Mask:
    """Which of points (rows, columns, 2) the site's own floor plan has."""
    plan = draw_plans(load_world(world), laser_band(robot), robot.height)[0]
    cells = plan.cells()
    at = np.floor((centres - np.array(plan.origin)) / plan.resolution).astype(int)
    columns, rows = at[..., 0], at[..., 1]
    on = (at >= 0).all(axis=-1) & (columns < cells.shape[1]) & (rows < cells.shape[0])
    inside = cells[np.where(on, rows, 0), np.where(on, columns, 0)] != UNKNOWN
    return np.asarray(on & inside)


def judged(plan: MapPicture, truth: Truth) -> dict[str, float]:
    """Share of the floor that is known, and distances of occupied cells to true surfaces, m.

    shift_m and turn_rad say how far the map was moved for that.
    """
    cells = plan.cells()
    rows, columns = np.nonzero(cells == OCCUPIED)
    walls = _centres(plan, rows, columns)

    def off(pose: Array) -> Array:
        return truth.distances(_moved(walls, pose))

    # its steps are in proportion to the unknowns, which therefore lie around 1
    solved = least_squares(
        lambda x: off(x - 1.0), np.ones(3), loss="soft_l1", f_scale=0.05, diff_step=1e-4
    )
    found = solved.x - 1.0
    apart = off(found)
    floor = np.argwhere(truth.floor)[:, ::-1]
    there = _moved_back(truth.low + (floor + 0.5) * CELL, found)
    at = np.floor((there - np.array(plan.origin)) / plan.resolution).astype(int)
    on = (at >= 0).all(axis=1) & (at[:, 0] < cells.shape[1]) & (at[:, 1] < cells.shape[0])
    known = cells[at[on, 1], at[on, 0]] != UNKNOWN
    return {
        "floor_m2": round(len(floor) * CELL**2, 1),
        "known_per_cent": round(100.0 * float(np.count_nonzero(known)) / len(floor), 2),
        "error_mean_m": round(float(apart.mean()), 4),
        "error_max_m": round(float(apart.max()), 3),
        "cells_beyond_per_cent": round(100.0 * float((apart > FAR).mean()), 3),
        "shift_m": round(math.hypot(*found[:2]), 3),
        "turn_rad": round(float(found[2]), 4),
    }


def _seconds(folder: Path) -> float:
    """The time that a map took, s, by its first and last scan."""
    stamps = np.loadtxt(folder / "trajectory.tum", usecols=0)
    return float(stamps[-1] - stamps[0])


def _centres(plan: MapPicture, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Array:
    return np.array(plan.origin) + (np.column_stack([columns, rows]) + 0.5) * plan.resolution


def _moved(points: Array, pose: Array) -> Array:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + pose[:2])


def _moved_back(points: Array, pose: Array) -> Array:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.asarray((points - pose[:2]) @ np.array([[c, -s], [s, c]]))


def main() -> None:
    """Explore with each seed, and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", required=True)
    parser.add_argument("--robot", required=True)
    parser.add_argument("--seeds", default="0:3")
    parser.add_argument("-o", "--out", type=Path, required=True)
    given = parser.parse_args()
    robot = load_robot(given.robot)
    for seed in range(*map(int, given.seeds.split(":"))):
        folder = given.out / f"{given.world}_{given.robot}_{seed}"
        line: dict[str, object] = {"world": given.world, "robot": given.robot, "seed": seed}
        if not folder.exists():
            begun = time.perf_counter()
            came = exploring.explore(given.world, given.robot, seed, folder, lambda *_: None)
            line |= {"status": came.status, "why": came.why, "time_s": round(came.seconds, 1)}
            line["wall_s"] = round(time.perf_counter() - begun)
        episode = draw_episode(given.world, seed)
        report = json.loads((folder / "report.json").read_text())
        line |= {"way_m": report["way_m"], "loops": report["loops"]}
        truth = Truth(given.world, episode, robot)
        tour = truth.tour()
        line["tour_m"] = round(tour, 1)
        line["times_tour"] = round(_seconds(folder) * robot.base.linear / tour, 2)
        line |= judged(read_map(folder / "map.yaml"), truth)
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
