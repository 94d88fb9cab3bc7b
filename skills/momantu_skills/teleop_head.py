"""teleop_head: a person turns the head that carries the camera, within the limits of its joints."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.skill import Needs, Run, Skill
from momantu_bt.teleoperation import Command, Operator
from momantu_skills.controls import OPERATED, commanded, rehearsed
from momantu_skills.manipulation.motion.following import brake
from momantu_skills.manipulation.motion.setpoint import Setpoint


class TeleopHead(Skill):
    """Turn the head as a person commands, until the person leaves.

    On a robot whose arm carries the camera, or none, there is no head, and it waits for the end.
    """

    failures = {**OPERATED}
    uses: ClassVar = {CAMERA_CARRIER}
    activities: ClassVar = {}
    symptoms: ClassVar = {}
    operator: Operator = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Nothing is pressed."""
        return {"services": dict(rehearsed(lambda now: Command(now)))}

    def run(self, robot: Robot) -> Run:
        """Move the setpoint on at each tick."""
        carrier = robot.description.resolve_use(CAMERA_CARRIER)
        head = None if carrier in (None, ARM) else Setpoint(robot, str(carrier))
        last = self.clock.now()
        while not (command := commanded(self)).ended:
            now = self.clock.now()
            yield "standing" if head is None or now <= last else _turn(head, command, now - last)
            last = now
        if head is not None and head.joints is not None:
            yield from brake(robot, self.clock, str(carrier))


def _turn(head: Setpoint, command: Command, seconds: float) -> str:
    """Make a step, and say what the head does."""
    if command.stop:
        head.drop()
    late = head.held_back()
    if late is not None:
        return f"stopped: {late} does not follow"
    speeds = {name: v for name, v in command.joints.items() if name in head.names and v}
    if not speeds:
        head.command()
        return "standing"
    joints, limit = head.stepped(speeds, seconds)
    head.move(joints, seconds)
    return "turning" if limit is None else f"stopped: {limit} is at its limit"
