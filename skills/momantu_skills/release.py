"""release: open the hand, and retreat from the object."""

from __future__ import annotations

from momantu_bt.claim import Claim, GripperOpen, Holding
from momantu_bt.failure import FailureValue
from momantu_bt.robot import ARM, Robot
from momantu_bt.skill import In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.config import HandConfig
from momantu_skills.manipulation.hand.gripper import open_hand
from momantu_skills.manipulation.scene.arm_scene import ArmScene

OPEN = 0.01
"""The gripper counts as open up to this much below its widest opening, m: measurement and control
error."""


class Release(Skill):
    """Open the gripper fully and let go of the held object where it is."""

    back: float = In(
        0.0,
        unit="m",
        least=0,
        most=1,
        doc="distance to retreat the open hand along its fingers, where possible, so that the "
        "next motion does not push the object",
    )
    also_called = ("open_gripper", "let_go", "drop", "open_hand")
    failures = {
        "GRIPPER_STUCK": "the gripper does not open",
        "ARM_STUCK": "the arm does not follow on its way back",
    }
    uses = {"gripper", ARM}
    activities = {}
    symptoms = {
        "GRIPPER_STUCK": {Symptom.HAND_STUCK},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }
    planning_scene: ArmScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Open, wait until the gripper is open, retreat."""
        config = HandConfig()
        holding = self.planning_scene.held is not None
        effector = robot.description.hand
        force = min(config.force, effector.max_force)
        yield from open_hand(robot, self.clock, effector.max_width, force, config.close_time)
        if holding:
            self.planning_scene.released()
        if self.back > 0.0:
            arm = Arm(self, robot, self.planning_scene)
            yield from arm.settle()
            yield from arm.back_off(self.back)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the hand is open and empty; a failure denies it."""
        if failure is not None and failure.code != "GRIPPER_STUCK":
            return None
        return GripperOpen(robot.description.hand.max_width - OPEN), Holding(False)
