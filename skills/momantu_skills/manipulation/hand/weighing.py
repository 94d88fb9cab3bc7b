"""Weighing what all senses say of the hand as it is, without moving anything."""

from __future__ import annotations

from collections.abc import Generator, Sequence

from momantu_bt.failure import Failure
from momantu_bt.robot import CameraSensor, Robot
from momantu_bt.skill import Skill
from momantu_skills.manipulation.hand import between_pads
from momantu_skills.manipulation.hand.evidence import (
    Evidence,
    Grip,
    agree,
    of_fingers,
    of_picture,
    of_weight,
    weighed,
)
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.manipulation.scene.payload import Weight, mean_weight, wrist_sensor
from momantu_skills.perception.camera.snapshot import take

FEELING = 10
"""Ticks over which fingers and weight are averaged if their first readings do not decide: 0.5 s."""


def weigh(
    skill: Skill, robot: Robot, service: ArmScene
) -> Generator[str, None, tuple[Evidence, ...]]:
    """All evidence that is needed for an answer, or all that there is.

    Fingers and weight are read once; if they do not decide, for half a second; and if those do not
    either, a picture is taken.
    """
    found = _felt(robot, service, [])
    if _in_doubt(found):
        weights = []
        for _ in range(FEELING):
            yield "feeling"
            weights.append(service.payload.weigh(robot))
        found = _felt(robot, service, weights)
    if weighed(found) is Grip.UNKNOWN:
        found += _seen(skill, robot, service)
    return tuple(found)


def _in_doubt(found: Sequence[Evidence]) -> bool:
    """Whether to feel longer: senses that differ, as where fingers are jammed."""
    grip = weighed(found)
    return grip is Grip.UNKNOWN or (grip is Grip.HELD and not agree(found))


def _felt(robot: Robot, service: ArmScene, weights: Sequence[Weight | None]) -> list[Evidence]:
    """What fingers and weight say; weights: earlier readings."""
    widest, alone = robot.description.hand.max_width, wrist_sensor(robot.description) is None
    found = [of_fingers(service.holding.fingers, widest, service.scene.config, alone=alone)]
    known = [each for each in (*weights, service.payload.weigh(robot)) if each is not None]
    if known:
        found.append(of_weight(mean_weight(known), raised=service.payload.raised))
    return found


def _seen(skill: Skill, robot: Robot, service: ArmScene) -> list[Evidence]:
    """What a picture of the hand, as it is, says; nothing without a camera that works."""
    sensors = robot.description.sensors.values()
    if not any(isinstance(sensor, CameraSensor) for sensor in sensors):
        return []
    try:
        view = between_pads.between_pads(service.scene, take(robot, skill.frames))
        return [of_picture(view, raised=service.payload.raised)]
    except Failure as failure:
        return [Evidence("picture", 0.0, failure.value.message)]


def told(found: Sequence[Evidence]) -> str:
    """What all evidence says, in words."""
    return "; ".join(each.text for each in found) or "the robot has no hand"


def odds(found: Sequence[Evidence]) -> dict[str, float]:
    """The logarithm of each sense, for a failure's data."""
    return {each.sense: round(each.odds, 1) for each in found}
