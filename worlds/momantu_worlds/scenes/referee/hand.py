"""The parts of a robot that the referee distinguishes: fingers, links, base."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.robot import ActuatorKind, RobotDescription


@dataclass(frozen=True, slots=True)
class Hand:
    """The names of a robot's links and joints that the referee watches.

    gripper: link with its origin between the pads; None without a hand. fingers: links that press
    on a held object.
    joints: of the arm and of the gripper; like the base, they must be at rest at the end of a run.
    """

    gripper: str | None
    fingers: frozenset[str]
    joints: frozenset[str] = frozenset()


def hand_of(description: RobotDescription) -> Hand:
    """The hand of a robot, or what moves of one without a hand."""
    effector = description.end_effector
    arm = {joint for group in description.groups.values() for joint in group.joints}
    grips = {
        joint
        for actuator in description.actuators.values()
        if actuator.kind is ActuatorKind.GRIPPER
        for joint in actuator.joints
    }
    if effector is None:
        return Hand(None, frozenset(), frozenset(arm | grips))
    fingers = frozenset(effector.touch_links) - {effector.frame}
    return Hand(effector.frame, fingers, frozenset(arm | grips))
