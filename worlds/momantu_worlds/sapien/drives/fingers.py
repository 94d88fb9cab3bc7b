"""A gripper's fingers in physics: their levers, their coupling, and what hangs on them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.robot import EndEffector, Linkage, RobotDescription, SimulationModel
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

    lever: force at the pads along the closing direction is torque / lever; m, or 1 if it slides;
    that of its knuckle for a joint that hangs on one.
    closing: sign of its motion when the gripper closes. span: its travel from open to closed.
    closed: its position when the gripper is closed, rad or m. knuckle: the finger joint that this
    one follows, as it hangs on it or is a bar beside it; None of a joint with a motor's force.
    """

    joint: Any
    gains: Gains
    lever: float
    closing: float
    span: float
    closed: float
    knuckle: str | None = None


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
    effector, found = description.hand, dict[str, Finger]()
    if not effector.opening:
        raise WorldError(
            f"the gripper {effector.actuator!r} of {description.name} has no joints; a simulated "
            "gripper needs at least one finger"
        )
    for name, rows in effector.opening.items():
        knuckle = knuckle_of(description, simulation.finger_links, name)
        lever = _lever(description, name if knuckle is None else knuckle)
        if lever < LEAST_LEVER:
            raise WorldError(
                f"the finger joint {name!r} of {description.name} does not move its finger along y "
                f"of {effector.frame!r}, the direction in which the gripper closes; turn that frame"
            )
        usual = _usual(lever, knuckle, _turns(description, name), physics)
        gains = with_own(simulation.drives.get(name), usual)
        way = rows[0][1] - rows[-1][1]
        sign = math.copysign(1.0, way)
        found[name] = Finger(joints[name], gains, lever, sign, abs(way), rows[0][1], knuckle)
    return found


def _usual(lever: float, knuckle: str | None, turns: bool, physics: Physics) -> Gains:
    """Gains at the pads as those of a joint; a joint that follows another is held stiffly.

    A finger that turns feels the rotor of its motor through the gears: without it, light fingers
    give way to what they hold, and it creeps out of them.
    """
    if knuckle is None:
        stiffness, damping, force = physics.finger_stiffness, physics.finger_damping, 0.0
    else:
        stiffness, damping, force = physics.tendon_stiffness, physics.tendon_damping, math.inf
    rotor = physics.finger_rotor * lever**2 if turns else 0.0
    return Gains(stiffness * lever**2, damping * lever**2, force, rotor)


def _turns(description: RobotDescription, joint: str) -> bool:
    tree = description.kinematics()
    return next(each.kind for each in tree.joints() if each.name == joint) != "prismatic"


def knuckle_of(
    description: RobotDescription, finger_links: Sequence[str], joint: str
) -> str | None:
    """The finger joint that another one follows; None of a joint that closes a finger itself.

    That is the nearest one on the way to the palm; for a bar on the palm that carries no finger,
    the first that does.
    """
    opening, tree = description.hand.opening, description.kinematics()
    carried = [[j.name for j in tree.chain(link) if j.name in opening] for link in finger_links]
    leading = [names[0] for names in carried if names]
    child = next(each.child for each in tree.joints() if each.name == joint)
    above = [each.name for each in tree.chain(child) if each.name in opening][:-1]
    if above:
        return above[-1]
    if not leading or joint in leading:
        return None
    return next(name for name in opening if name in leading)


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
    """Make the fingers of one hand move together, each by the same share of its travel.

    This stands for motors that follow one command and that a held object cannot push back. Joints
    that follow others do so in `Hanging`.
    """
    leading = [finger for finger in fingers.values() if finger.knuckle is None]
    if not leading:
        return
    first, *others = leading
    for other in others:
        if other.joint.parent_link is not first.joint.parent_link:
            continue
        share = -first.closing * other.closing * first.span / other.span
        articulation.create_fixed_tendon(
            [first.joint.parent_link, first.joint.child_link, other.joint.child_link],
            [0, 1, share],
            [0, 1, 1 / share],
            rest_length=0,
            offset=0,
            stiffness=physics.tendon_stiffness * first.lever**2,
            damping=physics.tendon_damping * first.lever**2,
        )


class Hanging:
    """Finger joints that hang on others or are bars beside them, and turn with them.

    Each is driven to where its knuckle is, stiffly: the bars hold it, whatever presses on it.
    """

    def __init__(
        self, effector: EndEffector, fingers: Mapping[str, Finger], index: Mapping[str, int]
    ) -> None:
        """index: of each joint in qpos."""
        self._driven = []
        for name, finger in fingers.items():
            if finger.knuckle is not None:
                finger.gains.give(finger.joint)
                rows = [np.array(effector.opening[n])[:, 1] for n in (finger.knuckle, name)]
                order = np.argsort(rows[0])
                self._driven.append(
                    (finger.joint, index[finger.knuckle], rows[0][order], rows[1][order])
                )

    def follow(self, positions: Array) -> None:
        """Send each to where it belongs beside its knuckle; positions: of all joints now (dof,)."""
        for joint, place, knuckle, own in self._driven:
            joint.set_drive_target(float(np.interp(positions[place], knuckle, own)))


def torques(fingers: Mapping[str, Finger], force: float) -> dict[str, float]:
    """Torque of each leading finger joint at which each side presses with `force`, N; Nm or N."""
    number = sides(fingers)
    return {n: force * f.lever / number for n, f in fingers.items() if f.knuckle is None}


def sides(fingers: Mapping[str, Finger]) -> float:
    """Leading fingers on each side; a single one presses against a fixed part."""
    return max(1.0, sum(finger.knuckle is None for finger in fingers.values()) / 2)


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
