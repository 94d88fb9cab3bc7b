"""release: open the hand."""

from __future__ import annotations

from typing import Any

from momantu_bt.claim import Claim, GripperOpen, Holding
from momantu_bt.failure import FailureValue
from momantu_bt.robot import Robot
from momantu_bt.skill import Needs, Run, Skill

OPEN = 0.01
"""m short of its widest at which the gripper still counts as open: gauge and control."""


class Release(Skill):
    """Open the gripper as wide as it goes; what it held is let go where it is."""

    failures = {"GRIPPER_STUCK": "the gripper does not open"}
    uses = {"gripper"}
    planning_scene: Any = Needs()

    def run(self, robot: Robot) -> Run:
        """Open and wait until it is."""
        from momantu_skills.manipulation.config import HandConfig
        from momantu_skills.manipulation.hand import open_hand

        config = HandConfig()
        holding = self.planning_scene.held is not None
        width = robot.description.end_effector.max_width
        yield from open_hand(robot, self.clock, width, config.force, config.close_time)
        if holding:
            self.planning_scene.released()

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """The hand is open and empty, whether that is said or denied."""
        if failure is not None and failure.code != "GRIPPER_STUCK":
            return None
        return GripperOpen(robot.description.end_effector.max_width - OPEN), Holding(False)
