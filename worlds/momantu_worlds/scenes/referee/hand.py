"""The parts of a robot as the referee distinguishes them: fingers, links, base."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.robot import ActuatorKind, RobotDescription


@dataclass(frozen=True, slots=True)
class Hand:
    """The names of a robot's links and joints that the referee watches.

    gripper: link whose origin lies between the pads. fingers: links that squeeze what is held.
    joints: of the arm and of the gripper, which must rest when a run is over, as the base must.
    """

    gripper: str
    fingers: frozenset[str]
    joints: frozenset[str] = frozenset()


def hand_of(description: RobotDescription) -> Hand:
    """The hand of a robot."""
    effector = description.end_effector
    arm = {joint for group in description.groups.values() for joint in group.joints}
    grips = {
        joint
        for actuator in description.actuators.values()
        if actuator.kind is ActuatorKind.GRIPPER
        for joint in actuator.joints
    }
    fingers = frozenset(effector.touch_links) - {effector.frame}
    return Hand(effector.frame, fingers, frozenset(arm | grips))
