"""release: open the hand."""

from __future__ import annotations

from typing import Any

from momantu_bt.robot import Robot
from momantu_bt.skill import Needs, Run, Skill


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
