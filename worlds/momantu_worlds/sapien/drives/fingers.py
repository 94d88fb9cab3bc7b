"""A gripper's fingers in physics: their levers, their coupling, and tips without motors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import Linkage, RobotDescription, SimulationModel
from momantu_bt.world import WorldError
from momantu_worlds.sapien.config import Physics
from momantu_worlds.sapien.drives.gains import Gains, with_own

EXACT = 9
"""Decimals to which a lever is rounded, to remove the rounding error of a product of rotations."""
LEAST_LEVER = 1e-3
"""Least lever, m, or share of a slide's travel: a joint with less does not close the gripper."""


@dataclass(frozen=True, slots=True)
class Finger:
    """A finger joint.

    lever: force at the pads along the closing direction is torque / lever; m, or 1 if it slides.
    closing: sign of its motion when the gripper closes. span: its travel from open to closed.
    closed: its position when the gripper is closed, rad or m.
    """

    joint: Any
    gains: Gains
    lever: float
    closing: float
    span: float
    closed: float


def fingers_of(
    description: RobotDescription,
    simulation: SimulationModel,
    joints: Mapping[str, Any],
    physics: Physics,
) -> dict[str, Finger]:
    """The gripper's finger joints by name; none of a robot without a hand. joints: SAPIEN's.

    A stiffness at the pads is converted to one of the joint by the square of the lever.

    Raises:
        WorldError: the hand has none, or one does not move along the closing direction.
    """
    if description.end_effector is None:
        return {}
    effector, found = description.hand, {}
    if not effector.opening:
        raise WorldError(
            f"the gripper {effector.actuator!r} of {description.name} has no joints; a simulated "
            "gripper needs at least one finger"
        )
    for name, rows in effector.opening.items():
        lever = _lever(description, name)
        if lever < LEAST_LEVER:
            raise WorldError(
                f"the finger joint {name!r} of {description.name} does not move its finger along y "
                f"of {effector.frame!r}, the direction in which the gripper closes; turn that frame"
            )
        usual = Gains(
            physics.finger_stiffness * lever**2, physics.finger_damping * lever**2, 0.0, 0.0
        )
        gains = with_own(simulation.drives.get(name), usual)
        way = rows[0][1] - rows[-1][1]
        sign = math.copysign(1.0, way)
        found[name] = Finger(joints[name], gains, lever, sign, abs(way), rows[0][1])
    return found


def _lever(description: RobotDescription, joint: str) -> float:
    """Motion of the grasp frame's origin along the closing direction, per motion of a joint."""
    effector = description.hand
    tree = description.kinematics()
    one = next(each for each in tree.joints() if each.name == joint)
    offset = Transform((effector.grasp_offset, 0.0, 0.0))
    base_from_grasp = tree.base_from_frame(effector.frame, {}) @ offset
    base_from_joint = tree.base_from_frame(one.parent, {}) @ one.parent_from_joint
    axis = base_from_joint.rotation @ (np.asarray(one.axis) / np.linalg.norm(one.axis))
    closing: Array = base_from_grasp.rotation[:, 1]
    if one.kind == "prismatic":
        return round(abs(float(axis @ closing)), EXACT)
    arm = base_from_grasp.position - base_from_joint.position
    return round(abs(float(np.cross(axis, arm) @ closing)), EXACT)


def couple(articulation: Any, fingers: Mapping[str, Finger], physics: Physics) -> None:
    """Make all fingers of one hand move together, each by the same share of its travel.

    This stands for motors that follow one command and that a held object cannot push back.
    """
    if not fingers:
        return
    first, *others = fingers.values()
    for other in others:
        links = [first.joint.parent_link, first.joint.child_link, other.joint.child_link]
        if other.joint.parent_link is not links[0]:
            _level(articulation, other, fingers, physics)
            continue
        share = -first.closing * other.closing * first.span / other.span
        articulation.create_fixed_tendon(
            links,
            [0, 1, share],
            [0, 1, 1 / share],
            rest_length=0,
            offset=0,
            stiffness=physics.tendon_stiffness * first.lever**2,
            damping=physics.tendon_damping * first.lever**2,
        )


def _level(articulation: Any, tip: Finger, fingers: Mapping[str, Finger], physics: Physics) -> None:
    """Make a tip that hangs on another finger turn with it, as the bars of a parallel jaw do."""
    link = tip.joint.parent_link
    knuckle = next((each for each in fingers.values() if each.joint.child_link is link), None)
    if knuckle is None:
        return
    ratio = tip.closing * tip.span / (knuckle.closing * knuckle.span)
    articulation.create_fixed_tendon(
        [knuckle.joint.parent_link, link, tip.joint.child_link],
        [0, -ratio, 1],
        [0, -1 / ratio, 1],
        rest_length=tip.closed - ratio * knuckle.closed,
        offset=0,
        stiffness=physics.tendon_stiffness * knuckle.lever**2,
        damping=physics.tendon_damping * knuckle.lever**2,
    )


def torques(fingers: Mapping[str, Finger], force: float) -> dict[str, float]:
    """Torque of each finger joint at which each side presses with `force`, N; Nm or N."""
    return {name: force * finger.lever / sides(fingers) for name, finger in fingers.items()}


def sides(fingers: Mapping[str, Finger]) -> float:
    """Fingers on each side; a single finger presses against a fixed part."""
    return max(1.0, len(fingers) / 2)


@dataclass(frozen=True, slots=True)
class _Tip:
    """low, high: its limits, rad or m. place: index of its motor's joint in qpos."""

    linkage: Linkage
    joint: Any
    gains: Gains
    low: float
    high: float
    place: int
    closing: float


class Tips:
    """Finger joints that are also moved by the motor of another finger joint; see `Linkage`."""

    def __init__(
        self,
        linkages: Mapping[str, Linkage],
        fingers: Mapping[str, Finger],
        joints: Mapping[str, Any],
        gains: Mapping[str, Gains],
        index: Mapping[str, int],
    ) -> None:
        self._tips = []
        for name, linkage in linkages.items():
            low, high = (float(limit) for limit in joints[name].limits[0])
            place, closing = index[linkage.motor], fingers[linkage.motor].closing
            tip = _Tip(linkage, joints[name], gains[name], low, high, place, closing)
            self._tips.append(tip)

    def follow(self, targets: Mapping[str, float], positions: Array) -> None:
        """Turn by the part of motor commands (rad or m) that their own joints have not moved."""
        for tip in self._tips:
            motor = targets[tip.linkage.motor]
            left = tip.closing * (motor - float(positions[tip.place])) - tip.linkage.preload
            wanted = tip.low + tip.linkage.ratio * max(0.0, left)
            tip.joint.set_drive_target(min(wanted, tip.high))

    def press(self, torques: Mapping[str, float]) -> None:
        """Limit each tip to its share of its finger's current torque."""
        for tip in self._tips:
            tip.gains.give(tip.joint, tip.linkage.share * torques[tip.linkage.motor])
