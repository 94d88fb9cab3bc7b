"""What a person can drive on a robot: its base, arm, head and gripper, as far as skills do."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from momantu_bt.frames import KinematicTree
from momantu_bt.lacking import lacking
from momantu_bt.plugins import PluginError
from momantu_bt.robot import ARM, CAMERA_CARRIER, ActuatorKind, BaseLimits, RobotDescription
from momantu_bt.skill import Skill
from momantu_bt.teleoperation import OPERATOR
from momantu_bt.tree.registry import Registry

STEEP = 0.7
"""Least cosine of the angle between a joint's axis and the one that it is taken to turn about."""


@dataclass(frozen=True, slots=True)
class Abilities:
    """What can be driven. None, or empty: the robot has none, or no skill drives it.

    joints: speeds of the arm's joints by name, rad/s or m/s. lift: the joint that moves the arm up.
    pan, tilt: joints of the head with the speed that turns it to the left, and up, rad/s. opening:
    widest opening of the gripper, m. skills: what drives each part: base, arm, head, gripper.
    """

    base: BaseLimits | None
    joints: Mapping[str, float]
    lift: str | None
    pan: tuple[str, float] | None
    tilt: tuple[str, float] | None
    opening: float | None
    skills: Mapping[str, str]


def drivers(registry: Registry, description: RobotDescription) -> dict[str, str]:
    """The installed skill that lets a person drive each actuator, by actuator.

    A skill for the one that carries the camera comes after skills that name their actuator.
    """
    kinds: dict[str, type[Skill]] = {}
    for name in registry.skills:
        with suppress(PluginError):
            if OPERATOR in registry.skills[name].needs:
                kinds[name] = registry.skills[name]
    found: dict[str, str] = {}
    for name in sorted(kinds, key=lambda each: CAMERA_CARRIER in kinds[each].uses):
        if any(lacking(kinds[name], registry.services, description)):
            continue
        uses = [description.resolve_use(use) for use in sorted(kinds[name].uses)]
        driven = [use for use in uses if use is not None]
        if driven and not any(use in found for use in driven):
            found |= dict.fromkeys(driven, name)
    return found


def abilities(description: RobotDescription, driven: Mapping[str, str]) -> Abilities:
    """What a person can drive. driven: see `drivers`."""
    parts = {_part(description, actuator): actuator for actuator in driven}
    kinematics, hand = description.kinematics(), description.end_effector
    arm = description.actuators[parts["arm"]].joints if "arm" in parts else ()
    head = description.actuators[parts["head"]].joints if "head" in parts else ()
    speeds = {name: description.joint_limits[name].velocity for name in (*arm, *head)}
    return Abilities(
        base=description.base if "base" in parts else None,
        joints={name: speeds[name] for name in arm},
        lift=_lift(kinematics, arm),
        pan=_about(kinematics, head, (0.0, 0.0, 1.0), speeds),
        tilt=_about(kinematics, head, (0.0, -1.0, 0.0), speeds),
        opening=hand.max_width if "gripper" in parts and hand is not None else None,
        skills={part: driven[actuator] for part, actuator in parts.items()},
    )


def _part(description: RobotDescription, actuator: str) -> str:
    """What a person calls an actuator: base, arm, head or gripper."""
    if actuator == ARM:
        return "arm"
    kind = description.actuators[actuator].kind
    return {ActuatorKind.BASE: "base", ActuatorKind.GRIPPER: "gripper"}.get(kind, "head")


def _lift(kinematics: KinematicTree, names: tuple[str, ...]) -> str | None:
    """The first of an arm's joints, if it slides upwards."""
    for joint in kinematics.joints():
        if names and joint.name == names[0] and joint.kind == "prismatic":
            axis = _axis(kinematics, joint.child, joint.axis)
            return joint.name if axis[2] > STEEP else None
    return None


def _about(
    kinematics: KinematicTree,
    names: tuple[str, ...],
    axis: tuple[float, float, float],
    speeds: Mapping[str, float],
) -> tuple[str, float] | None:
    """The first of these joints that turns about an axis of the base, and its signed speed."""
    for joint in kinematics.joints():
        if joint.name in names:
            share = float(_axis(kinematics, joint.child, joint.axis) @ np.array(axis))
            if abs(share) > STEEP:
                return joint.name, float(np.copysign(speeds[joint.name], share))
    return None


def _axis(kinematics: KinematicTree, link: str, axis: tuple[float, float, float]) -> np.ndarray:
    """A joint's axis in the base frame, all joints at 0."""
    return np.asarray(kinematics.base_from_frame(link, {}).rotation @ np.array(axis))
