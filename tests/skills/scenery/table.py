"""Fetch before a table with a can on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from momantu_skills.manipulation.scene.service import PlanningSceneService
from momantu_worlds.robots import fetch

from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.messages import (
    CameraImage,
    DetectedObject,
    GripperCommand,
    WrenchReading,
    frozen,
)
from momantu_bt.robot import RobotDescription
from momantu_bt.testing import (
    ScriptedRobot,
)
from momantu_bt.testing.painting import Block, Painter, Round, Solid

SceneOf = Callable[[ScriptedRobot], PlanningSceneService]

TABLE = 0.72
"""m; height of the scripted table's top."""


class Tabletop(ScriptedRobot):
    """Fetch, or another robot, before a table with a can on it; what it grasps moves with it.

    can: odom_from_can, its centre. slips: it stays behind when the hand rises. stays_hidden: the
    camera does not see it. weightless: the wrist feels nothing of it. others: more solids.
    table: height of the top as it is; surface_felt: whether touching it is felt.
    """

    def __init__(
        self,
        can: tuple[float, float] | None = (0.75, 0.0),
        pose: str = "ready",
        description: RobotDescription | None = None,
    ) -> None:
        description = description or fetch()
        joints = description.named_poses[pose]
        super().__init__(description, joints=joints)
        self.can = None if can is None else Transform((*can, TABLE + 0.065))
        self.table, self.others = TABLE, list[Solid]()
        self.slips = self.stays_hidden = self.weightless = self.topples = False
        self.surface_felt = True
        self.hand_from_can: Transform | None = None
        self.readings = {description.camera()[0]: Tabletop._picture, "wrench": Tabletop._wrench}
        self._kinematics = description.kinematics()

    def hold(self, hand_from_can: Transform) -> None:
        """Begin with the can between the fingers."""
        self.hand_from_can = hand_from_can
        self.object_width = self.gripper_width = 0.07
        self.command("gripper", GripperCommand(0.04, 45.0))
        self._follow_hand()

    @property
    def odom_from_hand(self) -> Transform:
        link = self.description.end_effector.frame
        return self.base.transform() @ self._kinematics.base_from_frame(link, self.joints)

    def advance(self, seconds: float) -> None:
        super().advance(seconds)
        if self.can is None:
            return
        inside = self.odom_from_hand.inverse().apply(self._nearest_of_axis())
        between = bool((np.abs(inside) < (0.02, 0.02, 0.07)).all())
        self.object_width = 0.07 if between or self.hand_from_can is not None else None
        if self.hand_from_can is None and between and self.gripper_effort > 0.0:
            self.hand_from_can = self.odom_from_hand.inverse() @ self.can
        elif self.hand_from_can is not None and self.gripper_width > 0.072:
            self._drop()
        if self.hand_from_can is not None:
            lifted = self.odom_from_hand @ self.hand_from_can
            if self.slips and lifted.position[2] > self.table + 0.075:
                self._drop()
            else:
                self._follow_hand()

    def _nearest_of_axis(self) -> Array:
        """The point (3,) of the can's axis that is nearest to the hand, odom."""
        assert self.can is not None
        along = float(self.can.inverse().apply(self.odom_from_hand.position)[2])
        return self.can.apply((0.0, 0.0, min(max(along, -0.06), 0.06)))

    def _follow_hand(self) -> None:
        assert self.hand_from_can is not None
        self.can = self.odom_from_hand @ self.hand_from_can

    def _drop(self) -> None:
        assert self.can is not None
        self.hand_from_can = self.object_width = None
        x, y, _ = self.can.position
        self.can = Transform((x, y, self.table + 0.065))

    def detected(self, stamp: float | None = None) -> DetectedObject:
        """The can as a detector would report it."""
        assert self.can is not None
        pose = Pose(self.can, "odom", self.time if stamp is None else stamp)
        return DetectedObject("can", pose, (0.07, 0.07, 0.13), "cylinder", 0.9, TABLE)

    def _picture(self) -> CameraImage:
        solids: list[Solid] = [Block((0.8, 1.4, self.table), (0.9, 0.0, self.table / 2))]
        if self.can is not None and not self.stays_hidden:
            x, y, z = self.can.position
            if self.topples and self.hand_from_can is None:
                solids.append(Block((0.13, 0.07, 0.07), (x, y, self.table + 0.035)))
            else:
                solids.append(Round((x, y, z - 0.065), 0.13, 0.035))
        return Painter([*solids, *self.others])(self)

    def _wrench(self) -> WrenchReading:
        force = np.zeros(3)
        if self.hand_from_can is not None and self.can is not None and not self.weightless:
            depth = self.table - (float(self.can.position[2]) - 0.065)
            carried = 3000.0 * max(0.0, depth) if self.surface_felt else 0.0
            force[2] = carried - 3.9
        frame = self.description.end_effector.frame
        turned = self.odom_from_hand.rotation.T @ force
        return WrenchReading(self.time, frame, frozen(turned), frozen(np.zeros(3)))
