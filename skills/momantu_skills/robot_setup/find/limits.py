"""Limits of joints: positions and speeds from the URDF, accelerations from efforts and inertias."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import ROUND_DOWN, Context

import numpy as np
import pinocchio as pin

from momantu_bt.geometry import Array
from momantu_bt.robot import JointLimit
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import SetupJoint

POSTURES = 200
"""Random postures for the inertia about each joint."""
USABLE = 0.5
"""Share of a joint's effort for acceleration; the rest is for gravity and friction."""
GENTLE = {"prismatic": 0.3, "revolute": 1.5, "continuous": 1.5}
"""Largest proposed acceleration, m/s2 and rad/s2: arms of usual weight can do it."""
LIGHT = 2.0
"""Heads and fingers may accelerate this many times as much."""
USUAL_SPEED = {"prismatic": 0.05, "revolute": 1.0, "continuous": 1.0}
"""Speed if the URDF gives none, m/s and rad/s."""
SLOWEST = 0.01
"""Least acceleration, m/s2 and rad/s2; a lower limit would be useless."""
FOUR_DIGITS = Context(prec=4, rounding=ROUND_DOWN)
"""Format of speeds and accelerations: four digits, rounded towards 0."""


@dataclass(frozen=True)
class FoundLimit:
    """A joint's limits and what of them was guessed, in words."""

    limit: JointLimit
    guessed: tuple[str, ...] = ()


def plain_limits(found: Mapping[str, FoundLimit]) -> dict[str, JointLimit]:
    """Limits alone, by joint."""
    return {name: limit.limit for name, limit in found.items()}


def find_limits(body: Body, joints: Iterable[str], light: Iterable[str]) -> dict[str, FoundLimit]:
    """Limits of joints; `light` are those that carry little."""
    inertia = _inertias(body)
    quick = set(light)
    return {name: _limit(body, name, inertia, name in quick) for name in joints}


def _inertias(body: Body) -> Array:
    """Greatest inertia (nv,) about each joint over many postures, kg m2 or kg."""
    data = body.pin.createData()
    largest = np.zeros(body.pin.nv)
    for q in body.random_configurations(POSTURES, seed=0):
        pin.crba(body.pin, data, q)
        largest = np.maximum(largest, np.diag(data.M))
    return largest


def _limit(body: Body, name: str, inertia: Array, light: bool) -> FoundLimit:
    joint, guessed = body.skeleton.joints[name], []
    most = GENTLE[joint.kind] * (LIGHT if light else 1.0)
    weight = float(inertia[int(body.pin.joints[body.pin.getJointId(name)].idx_v)])
    if joint.effort and weight > 0:
        acceleration = max(SLOWEST, min(most, USABLE * joint.effort / weight))
    else:
        acceleration = most
        guessed.append("acceleration (no effort or no inertia in the URDF)")
    velocity = joint.velocity
    if not velocity:
        velocity = USUAL_SPEED[joint.kind]
        guessed.append("velocity (none in the URDF)")
    lower, upper = _positions(joint, guessed)
    return FoundLimit(
        JointLimit(
            lower=lower,
            upper=upper,
            velocity=_short(velocity),
            acceleration=_short(acceleration),
        ),
        tuple(guessed),
    )


def _positions(joint: SetupJoint, guessed: list[str]) -> tuple[float | None, float | None]:
    if joint.endless:
        return None, None
    if joint.lower is None or joint.upper is None or joint.lower >= joint.upper:
        guessed.append("positions (no range in the URDF)")
    return short_range(joint)


def short_range(joint: SetupJoint) -> tuple[float, float]:
    """A joint's range in five digits, rounded inwards."""
    lower, upper = joint.range
    return _inside(lower, up=True), _inside(upper, up=False)


def _inside(value: float, *, up: bool) -> float:
    """Five digits, rounded into the range."""
    rounded = round(value, 5)
    if (rounded < value) if up else (rounded > value):
        rounded += 1e-5 if up else -1e-5
    return round(rounded, 5) + 0.0


def _short(value: float) -> float:
    """Four digits, rounded towards 0: the proposal never exceeds the joint's limit."""
    return float(FOUR_DIGITS.create_decimal(repr(value)))
