"""doorway.blocked: a crate stands in the next doorway on the robot's path."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sapien.faults.floor_space import WALL, free_floor
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.catalogue.furniture import furniture
from momantu_worlds.scenes.geometry.bodies import Body, Gap
from momantu_worlds.scenes.geometry.prisms import Prism, body_prism

DEPTH, HEIGHT = 0.45, 0.6
"""Depth along the passage and height of the crate, m."""
SLIT = 0.1
"""Width of the doorway that stays open, m, both sides together."""
ASIDE = 0.3
"""Least gap to the robot, m: a doorway that is nearer is not blocked."""
ANGLES = 90
STEP, LONGEST = 0.02, 2.0
"""Step and largest distance of the search from the centre of a doorway to its jambs, m."""


class DoorwayBlocked:
    """A static crate that lasers and cameras see; it is removed at the end."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._doorways, self._support = stage.doorways, stage.goal.support
        self._stage, self._fault = stage, fault
        self._added: str | None = None

    def begin(self) -> None:
        """Add the crate; FaultError if the robot stands in every doorway in question."""
        for gap in self._in_order():
            body = self._crate(gap)
            if self._clear(body):
                self._added = self._stage.add(body)
                return
        raise FaultError(f"{self._fault.name}: the robot is too near to every doorway")

    def end(self) -> None:
        """Remove the crate."""
        if self._added is not None:
            self._stage.remove(self._added)
            self._added = None

    def _in_order(self) -> list[Gap]:
        """Doorways in the order in which the robot passes them; then the others, near ones first.

        The robot drives to the item, unless it holds it, and then to the table where the item is to
        be placed.
        """
        stage, floor = self._stage, free_floor(self._stage)
        pose = stage.simulator.truth.pose
        stops = [stage.base()]
        if not stage.held():
            stops.append(Pose2D.from_transform(stage.item_pose()))
        stops.append(Pose2D.from_transform(pose(self._support)))
        points = [floor.nearest_free((stop.x, stop.y)) for stop in stops]
        way = np.concatenate([floor.route(a, b) for a, b in pairwise(points)])
        passed: list[tuple[float, float, int]] = []
        for index, gap in enumerate(self._doorways):
            away = np.hypot(*(way - gap.at).T) if len(way) else np.zeros(0)
            through = np.flatnonzero(away <= gap.clear)
            first = float(through[0]) if len(through) else math.inf
            passed.append((first, math.dist(gap.at, points[0]), index))
        return [self._doorways[index] for _, _, index in sorted(passed)]

    def _crate(self, gap: Gap) -> Body:
        middle, across, width = self._opening(gap)
        size = (DEPTH, width - SLIT, HEIGHT)
        pose = Pose2D(middle[0], middle[1], across - math.pi / 2).transform()
        return Body("blocking_crate", "crate", pose, furniture("crate", size))

    def _opening(self, gap: Gap) -> tuple[tuple[float, float], float, float]:
        """Middle of the narrowest line between the jambs, its direction (rad) and length (m)."""
        walls = [w for w in self._stage.prisms(categories=(WALL,)) if w.bottom < HEIGHT]
        angles = math.pi * np.arange(ANGLES) / ANGLES
        steps = np.arange(STEP, LONGEST, STEP)
        best = (math.inf, 0.0, 0.0)
        for angle in angles.tolist():
            ahead, behind = (
                _free_length(walls, gap.at, angle + turn, steps) for turn in (0, math.pi)
            )
            if ahead + behind < best[0]:
                best = (ahead + behind, angle, (ahead - behind) / 2)
        width, angle, shift = best
        middle = gap.at[0] + shift * math.cos(angle), gap.at[1] + shift * math.sin(angle)
        return middle, angle, width

    def _clear(self, crate: Body) -> bool:
        prism = body_prism(crate, crate.map_from_body)
        assert prism is not None
        stage = self._stage
        return prism.clear_of(stage.robot_prisms(), ASIDE) and prism.clear_of(stage.prisms(), 0.0)


def _free_length(walls: list[Prism], at: tuple[float, float], angle: float, steps: Array) -> float:
    """Distance from a point to a wall, m; the last of `steps` (n,) if there is none."""
    points = np.column_stack([at[0] + steps * math.cos(angle), at[1] + steps * math.sin(angle)])
    met = np.zeros(len(steps), dtype=np.bool_)
    for wall in walls:
        met |= wall.base.distance(points) == 0.0
    return float(steps[int(np.argmax(met))] if met.any() else steps[-1])
