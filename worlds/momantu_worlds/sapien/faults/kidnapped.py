"""robot.kidnapped: the robot, with its held object, is lifted and set down elsewhere."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.sapien.faults.floor_space import free_floor
from momantu_worlds.sapien.faults.parameters import number, only
from momantu_worlds.sapien.faults.stage import Stage

FARTHEST = 20.0
"""Largest distance, m."""
FARTHER = 0.25
"""If nothing is free at the requested distance, it is increased by this step, m."""
RINGS = 13
DIRECTIONS = 24
ASIDE = 0.1
"""Least gap of the robot and its held object to everything, m."""


class Kidnapped:
    """Odometry and wheels do not register the move."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """Parameters: distance, the least distance, m; turn, the angle of rotation, rad."""
        only(fault, "distance", "turn")
        self._distance = number(fault, "distance", 0.0, FARTHEST, "m")
        self._turn = number(fault, "turn", -math.pi, math.pi, "rad")
        self._stage, self._fault = stage, fault

    def begin(self) -> None:
        """Set the robot down in a seeded direction on free floor; FaultError if none is near."""
        stage, before = self._stage, self._stage.base()
        held = stage.held()
        after = self._place(before, held)
        stage.simulator.robot.carry(after)
        if held:
            move = after.transform() @ before.transform().inverse()
            stage.move_item(move @ stage.item_pose())

    def end(self) -> None:
        """Nothing is undone: the robot stays there."""

    def _place(self, before: Pose2D, held: bool) -> Pose2D:
        draw, floor = self._stage.random(self._fault), free_floor(self._stage)
        reached = floor.reachable(floor.nearest_free((before.x, before.y)))
        start = float(draw.uniform(0.0, 2 * math.pi))
        yaw = before.yaw + self._turn * (1.0 if draw.random() < 0.5 else -1.0)
        rows, columns = reached.shape
        for ring in range(RINGS):
            distance = self._distance + FARTHER * ring
            for i in range(DIRECTIONS):
                angle = start + 2 * math.pi * i / DIRECTIONS
                x = before.x + distance * math.cos(angle)
                y = before.y + distance * math.sin(angle)
                row, column = floor.index((x, y))
                inside = 0 <= row < rows and 0 <= column < columns
                after = Pose2D(x, y, yaw)
                if inside and reached[row, column] and self._fits(before, after, held):
                    return after
        raise FaultError(
            f"{self._fault.name}: there is no free floor {self._distance:g} m from the robot"
        )

    def _fits(self, before: Pose2D, after: Pose2D, held: bool) -> bool:
        stage = self._stage
        prisms = stage.robot_prisms(after)
        if held:
            move = after.transform() @ before.transform().inverse()
            prisms.append(stage.item_prism(move @ stage.item_pose()))
        others = stage.prisms(*([stage.goal.item] if held else []))
        return all(prism.clear_of(others, ASIDE) for prism in prisms)
