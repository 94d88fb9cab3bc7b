"""Which actuators of a robot its base, arm and gripper are."""

from __future__ import annotations

from momantu_bt.robot import ActuatorKind, RobotDescription

_ARM = "arm"


def base_of(description: RobotDescription) -> str:
    """The actuator that drives; KeyError when there is none."""
    return _first(description, ActuatorKind.BASE)


def arm_of(description: RobotDescription) -> str:
    """The actuator called arm, else the one that moves most joints; KeyError if none moves any."""
    joints = {
        n: a.joints for n, a in description.actuators.items() if a.kind is ActuatorKind.JOINTS
    }
    if not joints:
        raise KeyError(_lacks(description, "arm"))
    return _ARM if _ARM in joints else max(joints, key=lambda name: len(joints[name]))


def gripper_of(description: RobotDescription) -> str:
    """The end effector's actuator; KeyError when there is none."""
    effector = description.end_effector
    if effector is None or effector.actuator not in description.actuators:
        raise KeyError(_lacks(description, "gripper"))
    return effector.actuator


def _first(description: RobotDescription, kind: ActuatorKind) -> str:
    found = [name for name, actuator in description.actuators.items() if actuator.kind is kind]
    if not found:
        raise KeyError(_lacks(description, kind.value))
    return found[0]


def _lacks(description: RobotDescription, what: str) -> str:
    names = ", ".join(description.actuators) or "none"
    return f"the robot has no {what}; its actuators: {names}"
