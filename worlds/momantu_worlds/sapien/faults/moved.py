"""object.moved: someone shifts the item on the table that it stands on."""

from __future__ import annotations

import math
from collections.abc import Sequence

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Transform
from momantu_worlds.sapien.faults.parameters import number, only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import TableTop, item_top, obstacles, things_on
from momantu_worlds.scenes.arrange.spots import Disc, lane
from momantu_worlds.scenes.geometry.prisms import Prism
from momantu_worlds.scenes.geometry.support import UprightCylinder

FARTHEST = 2.0
"""Largest distance, m."""
ASIDE = 0.02
"""Least gap to everything at the new place, m."""
DIRECTIONS = 24


class Moved:
    """The item stays at its new place."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """Parameters: distance of the shift, m."""
        only(fault, "distance")
        self._distance = number(fault, "distance", 0.01, FARTHEST, "m")
        self._stage, self._fault = stage, fault
        self._item = UprightCylinder(stage.item)

    def begin(self) -> None:
        """Shift it in a seeded direction, if possible to where a hand can still reach it.

        Raises:
            FaultError: it stands on no table now, or nothing is free at that distance.
        """
        top = item_top(self._stage)
        start = float(self._stage.random(self._fault).uniform(0.0, 2 * math.pi))
        angles = [start + 2 * math.pi * i / DIRECTIONS for i in range(DIRECTIONS)]
        others = obstacles(self._stage, top, self._stage.goal.item)
        free = [pose for pose in map(self._shifted, angles) if self._free(top, pose, others)]
        if not free:
            raise FaultError(
                f"{self._fault.name}: nothing is free {self._distance:g} m from "
                f"{self._stage.goal.item} on {top.name}"
            )
        reached = (pose for pose in free if self._hand_gets_to(top, pose))
        self._stage.move_item(next(reached, free[0]))

    def end(self) -> None:
        """Nothing is undone: the item stays there."""

    def _shifted(self, angle: float) -> Transform:
        pose = self._stage.item_pose()
        x, y, z = (float(v) for v in pose.position)
        along, across = self._distance * math.cos(angle), self._distance * math.sin(angle)
        return Transform((x + along, y + across, z), pose.quaternion)

    def _free(self, top: TableTop, pose: Transform, others: Sequence[Prism]) -> bool:
        prism = self._stage.item_prism(pose)
        return top.holds(prism) and prism.clear_of(others, ASIDE)

    def _hand_gets_to(self, top: TableTop, pose: Transform) -> bool:
        x, y, _ = (float(v) for v in top.map_from_top.inverse().apply(pose.position))
        spot = Disc(x, y, self._item.radius, self._item.height)
        return lane(spot, things_on(self._stage, top, self._stage.goal.item), top.side)
