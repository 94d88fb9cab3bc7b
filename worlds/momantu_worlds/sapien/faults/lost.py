"""object.lost: the item is taken out of the hand and laid on the floor."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Transform
from momantu_worlds.sapien.faults.floor_space import walls_between
from momantu_worlds.sapien.faults.laid import lying
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.geometry.support import UprightCylinder

DISTANCES = (0.7, 0.9, 1.1, 1.4, 1.8)
"""Distances from the robot, m; the first one that is free is used."""
DIRECTIONS = 24
ASIDE = 0.05
"""Least gap to everything at the new pose, m."""


class Lost:
    """The item stays on the floor."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._fault, self._item = stage, fault, UprightCylinder(stage.item)

    def begin(self) -> None:
        """Lay it on the floor beside the robot.

        Raises:
            FaultError: it is not held now, or the floor around the robot is full.
        """
        stage = self._stage
        if not stage.held():
            raise FaultError(f"{self._fault.name}: {stage.goal.item} is not in the hand now")
        start = float(stage.random(self._fault).uniform(0.0, 2 * math.pi))
        for distance in DISTANCES:
            for i in range(DIRECTIONS):
                pose = self._laid(distance, start + 2 * math.pi * i / DIRECTIONS)
                if self._free(pose):
                    stage.move_item(pose)
                    return
        raise FaultError(f"{self._fault.name}: the floor around the robot is full")

    def end(self) -> None:
        """Nothing is undone: the item stays there."""

    def _laid(self, distance: float, direction: float) -> Transform:
        base = self._stage.base()
        x, y = base.x + distance * math.cos(direction), base.y + distance * math.sin(direction)
        return lying(self._item, x, y, 0.0, direction + math.pi / 2)

    def _free(self, pose: Transform) -> bool:
        stage = self._stage
        prism, base = stage.item_prism(pose), stage.base()
        at = float(pose.position[0]), float(pose.position[1])
        return (
            prism.clear_of(stage.prisms(stage.goal.item), ASIDE)
            and prism.clear_of(stage.robot_prisms(), ASIDE)
            and not walls_between(stage, (base.x, base.y), at)
        )
