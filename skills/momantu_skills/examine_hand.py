"""examine_hand: find out whether the hand holds something, where a check cannot tell."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from typing import Any

from momantu_bt.claim import Claim, Holding
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import GripperCommand
from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.skill import Compute, Needs, Out, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene

with lazily():
    from momantu_skills.gaze import look_at
    from momantu_skills.manipulation import arm as arms
    from momantu_skills.manipulation.hand import evidence, weighing


LIFT = 0.05
"""How far the hand is lifted, m: more than the arm sags, so that nothing carries it any more."""
PRESSING = 10
"""Ticks for which the fingers are pressed together: 0.5 s, in which they close by 50 mm."""
WITHIN = 0.35
"""Angle off the camera's axis at which the hand is still in the picture, rad."""


class ExamineHand(Skill):
    """Find out whether the hand holds something. It succeeds whatever the answer is.

    The robot weighs fingers, weight and picture as `check: holding` does. Where they do not tell,
    it looks at the hand, presses the fingers together, and lifts the hand off what it may lean on,
    one after the other until the answer is known. It never opens the hand. A `check` that follows
    sees and weighs the same.
    """

    holding: bool = Out(doc="whether the hand holds something")
    also_called = ("inspect_hand", "feel_hand", "look_at_hand")
    failures = {
        "HOLDING_UNKNOWN": "neither fingers nor weight nor picture tell, whatever was tried",
        "ARM_STUCK": "the arm does not follow while it lifts the hand",
    }
    uses = {ARM, CAMERA_CARRIER, "gripper"}
    activities = {}
    symptoms = {
        "HOLDING_UNKNOWN": {Symptom.NOT_HELD, Symptom.HAND_STUCK},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Examine the hand as it is."""
        return {"inputs": {}}

    def run(self, robot: Robot) -> Run:
        """Weigh; where that does not tell: look, press, lift, and weigh again after each."""
        tried: list[str] = []
        found = yield from weighing.weigh(self, robot, self.planning_scene)
        for name, way in self._ways():
            if evidence.weighed(found) is not evidence.Grip.UNKNOWN:
                break
            if (yield from way(robot)):
                tried.append(name)
                found = yield from weighing.weigh(self, robot, self.planning_scene)
        grip = evidence.weighed(found)
        if grip is evidence.Grip.UNKNOWN:
            raise Failure(
                "HOLDING_UNKNOWN",
                f"{weighing.told(found)}; tried: {', '.join(tried) or 'nothing was possible'}",
                tried=tried,
                **weighing.odds(found),
            )
        self.log(f"{grip.value}: {weighing.told(found)}")
        self.holding = grip is evidence.Grip.HELD

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim the answer; a failure claims nothing."""
        return None if failure is not None else Holding(self.holding)

    def _ways(self) -> tuple[tuple[str, Callable[[Robot], Generator[Any, Any, bool]]], ...]:
        return (("looking", self._look), ("pressing", self._press), ("lifting", self._lift))

    def _look(self, robot: Robot) -> Generator[str | Compute, Any, bool]:
        """Turn a head to the hand; a camera on the hand always sees it. Whether it was possible."""
        description = robot.description
        carrier = description.resolve_use(CAMERA_CARRIER)
        if carrier is None or description.eye_in_hand:
            return False
        hand = description.hand
        odom_from_grasp = self.frames.lookup(ODOM, hand.frame) @ Transform(
            (hand.grasp_offset, 0.0, 0.0)
        )
        try:
            yield from look_at.look_at(self, robot, odom_from_grasp.position, within=WITHIN)
        except Failure as failure:
            if failure.code != "OUT_OF_VIEW":
                raise
            return False
        return True

    def _press(self, robot: Robot) -> Generator[str, Any, bool]:
        """Close the fingers as in a grasp: on nothing they shut, and what is loose they hold."""
        force = arms.Arm(self, robot, self.planning_scene).force
        for _ in range(PRESSING):
            robot.command(robot.description.hand.actuator, GripperCommand(0.0, force))
            yield "pressing"
        return True

    def _lift(self, robot: Robot) -> Generator[str | Compute, Any, bool]:
        """Lift the hand straight up where nothing is in the way; whether it was possible."""
        arm = arms.Arm(self, robot, self.planning_scene)
        yield from arm.settle()
        arm.observe()
        if not (yield from arm.rise(LIFT)):
            return False
        yield from arm.settle()
        return True
