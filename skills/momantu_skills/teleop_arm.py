"""teleop_arm: a person jogs the arm, hand or joints; it stops at limits and before collisions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.robot import ARM, Robot
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.teleoperation import Command, Operator
from momantu_skills.controls import OPERATED, commanded, rehearsed
from momantu_skills.manipulation.jog import Jog
from momantu_skills.manipulation.motion.following import brake
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.manipulation.scene.service import PlanningSceneService


class TeleopArm(Skill):
    """Move the arm as a person commands, until the person leaves.

    The hand moves along the axes of the base frame, or joints one by one. The arm stops at its
    limits, and before it touches the robot itself, the floor, or a surface that the site or an
    earlier picture shows. It does not know of other obstacles: it takes no pictures.
    """

    failures = {**OPERATED}
    uses: ClassVar = {ARM}
    activities: ClassVar = {Activity.MOVE_ARM: ""}
    symptoms: ClassVar = {}
    operator: Operator = Needs()
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """The hand goes up for a moment."""
        services = rehearsed(lambda now: Command(now, hand=(0.0, 0.0, 0.05, 0.0, 0.0, 0.0)))
        return {"services": {**services, "planning_scene": PlanningSceneService()}}

    def run(self, robot: Robot) -> Run:
        """Move the setpoint on at each tick."""
        jog, last = Jog(robot, self.planning_scene), self.clock.now()
        while not (command := commanded(self)).ended:
            now = self.clock.now()
            phase = "standing" if now <= last else jog.advance(command, now, now - last)
            last = now
            yield phase
        if jog.setpoint.joints is not None:
            yield from brake(robot, self.clock, ARM)
