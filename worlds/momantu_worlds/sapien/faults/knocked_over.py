"""object.knocked_over: the item is tipped over and lies on its table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Transform
from momantu_worlds.sapien.faults.laid import lying
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import TableTop, item_top, obstacles
from momantu_worlds.scenes.geometry.prisms import Prism
from momantu_worlds.scenes.geometry.support import UprightCylinder

ASIDE = 0.01
"""Least gap to everything at the new pose, m."""
DIRECTIONS = 24


class KnockedOver:
    """The item stays as it lies."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._fault, self._item = stage, fault, UprightCylinder(stage.item)

    def begin(self) -> None:
        """Tip the item over its rim in a seeded free direction.

        Raises:
            FaultError: it stands on no table now, or all directions are blocked.
        """
        top = item_top(self._stage)
        start = float(self._stage.random(self._fault).uniform(0.0, 2 * math.pi))
        others = obstacles(self._stage, top, self._stage.goal.item)
        for i in range(DIRECTIONS):
            pose = self._tipped(top, start + 2 * math.pi * i / DIRECTIONS)
            if self._free(top, pose, others):
                self._stage.move_item(pose)
                return
        raise FaultError(
            f"{self._fault.name}: {self._stage.goal.item} has no room to lie on {top.name}"
        )

    def end(self) -> None:
        """Nothing is undone: the item stays there."""

    def _tipped(self, top: TableTop, direction: float) -> Transform:
        x, y, _ = (float(v) for v in self._stage.item_pose().position)
        rim_x = x + self._item.radius * math.cos(direction)
        rim_y = y + self._item.radius * math.sin(direction)
        return lying(self._item, rim_x, rim_y, float(top.map_from_top.position[2]), direction)

    def _free(self, top: TableTop, pose: Transform, others: Sequence[Prism]) -> bool:
        prism = self._stage.item_prism(pose)
        return top.holds(prism) and prism.clear_of(others, ASIDE)
