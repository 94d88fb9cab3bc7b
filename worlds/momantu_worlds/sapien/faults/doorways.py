"""Doorways on the robot's way, and how wide they are between their jambs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sapien.faults.floor_space import free_floor
from momantu_worlds.sapien.faults.stage import WALL, Stage
from momantu_worlds.scenes.geometry.bodies import Gap
from momantu_worlds.scenes.geometry.prisms import Prism

HEIGHT = 0.6
"""Walls that begin above this are lintels, m."""
ANGLES = 90
STEP, LONGEST = 0.02, 2.0
"""Step and largest distance of the search from the centre of a doorway to its jambs, m."""


@dataclass(frozen=True, slots=True)
class Opening:
    """The narrowest line between the jambs: its middle, direction (rad) and length, m."""

    middle: tuple[float, float]
    across: float
    width: float


def doorways_ahead(stage: Stage) -> list[Gap]:
    """Doorways in the order in which the robot passes them; then the others, near ones first.

    The robot drives to the item, unless it holds it, and then to the table where the item is to be
    placed.
    """
    floor, pose = free_floor(stage), stage.simulator.truth.pose
    stops = [stage.base()]
    if not stage.held():
        stops.append(Pose2D.from_transform(stage.item_pose()))
    stops.append(Pose2D.from_transform(pose(stage.goal.support)))
    points = [floor.nearest_free((stop.x, stop.y)) for stop in stops]
    way = np.concatenate([floor.route(a, b) for a, b in pairwise(points)])
    passed: list[tuple[float, float, int]] = []
    for index, gap in enumerate(stage.doorways):
        away = np.hypot(*(way - gap.at).T) if len(way) else np.zeros(0)
        through = np.flatnonzero(away <= gap.clear)
        first = float(through[0]) if len(through) else math.inf
        passed.append((first, math.dist(gap.at, points[0]), index))
    return [stage.doorways[index] for _, _, index in sorted(passed)]


def opening(stage: Stage, gap: Gap) -> Opening:
    """The opening of a doorway."""
    walls = [w for w in stage.prisms(categories=(WALL,)) if w.bottom < HEIGHT]
    angles = math.pi * np.arange(ANGLES) / ANGLES
    steps = np.arange(STEP, LONGEST, STEP)
    best = (math.inf, 0.0, 0.0)
    for angle in angles.tolist():
        ahead, behind = (_free_length(walls, gap.at, angle + turn, steps) for turn in (0, math.pi))
        if ahead + behind < best[0]:
            best = (ahead + behind, angle, (ahead - behind) / 2)
    width, angle, shift = best
    middle = gap.at[0] + shift * math.cos(angle), gap.at[1] + shift * math.sin(angle)
    return Opening(middle, angle, width)


def _free_length(walls: list[Prism], at: tuple[float, float], angle: float, steps: Array) -> float:
    """Distance from a point to a wall, m; the last of `steps` (n,) if there is none."""
    points = np.column_stack([at[0] + steps * math.cos(angle), at[1] + steps * math.sin(angle)])
    met = np.zeros(len(steps), dtype=np.bool_)
    for wall in walls:
        met |= wall.base.distance(points) == 0.0
    return float(steps[int(np.argmax(met))] if met.any() else steps[-1])
