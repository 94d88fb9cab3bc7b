"""Compute the joint positions that point a camera at a point."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.frames import KinematicTree
from momantu_bt.geometry import Array
from momantu_bt.robot import JointLimit

ITERATIONS = 25
"""Newton steps from one start; two joints converge in five."""
DAMPING = 1e-3
"""Damping, rad; limits steps where a joint does not move the view."""
STEP = 0.6
"""Largest step of one joint, rad: well inside the range of the linearisation."""
DIFFERENCE = 1e-4
"""Step of the finite differences, rad: far above rounding errors."""
CONVERGED = 1e-4
"""Angle off the axis at which the iteration has converged, rad: a sixteenth of a pixel."""


@dataclass(frozen=True, slots=True)
class Aim:
    """positions: of the carrier's joints, in their order. off_axis: remaining angle, rad."""

    positions: tuple[float, ...]
    off_axis: float


def aim(
    kinematics: KinematicTree,
    camera_frame: str,
    joints: Sequence[str],
    limits: Mapping[str, JointLimit],
    positions: Mapping[str, float],
    point_base: Array,
) -> Aim:
    """Positions of `joints` that put `point_base` (3,) on the optical axis, within the limits.

    Damped least squares on the view's angular error, started at the current positions, then at the
    middle of the joint ranges; the other joints stay at `positions`. If the limits forbid a
    solution, the best result is returned with its `off_axis`.
    """
    low, high = _bounds(joints, limits)
    best: Aim | None = None
    current = np.clip([positions.get(j, 0.0) for j in joints], low, high)
    for start in (current, np.clip(np.zeros(len(joints)), low, high)):
        found = _descend(kinematics, camera_frame, joints, positions, point_base, start, low, high)
        if best is None or found.off_axis < best.off_axis:
            best = found
        if best.off_axis <= CONVERGED:
            break
    assert best is not None
    return best


def _descend(
    kinematics: KinematicTree,
    camera_frame: str,
    joints: Sequence[str],
    positions: Mapping[str, float],
    point_base: Array,
    start: Array,
    low: Array,
    high: Array,
) -> Aim:
    def error(values: Array) -> Array:
        moved = {**positions, **dict(zip(joints, (float(v) for v in values), strict=True))}
        camera = kinematics.base_from_frame(camera_frame, moved)
        return view_error(camera.inverse().apply(point_base))

    values = start.copy()
    off = error(values)
    for _ in range(ITERATIONS):
        if float(np.hypot(*off)) <= CONVERGED:
            break
        jacobian = np.empty((2, len(values)))
        for column in range(len(values)):
            moved = values.copy()
            moved[column] += DIFFERENCE
            jacobian[:, column] = (error(moved) - off) / DIFFERENCE
        damped = jacobian @ jacobian.T + DAMPING**2 * np.eye(2)
        step = -jacobian.T @ np.linalg.solve(damped, off)
        step *= min(1.0, STEP / max(1e-12, float(np.abs(step).max())))
        moved = np.clip(values + step, low, high)
        if float(np.abs(moved - values).max()) < CONVERGED / 10:
            break
        values, off = moved, error(moved)
    return Aim(tuple(float(v) for v in values), float(np.hypot(*off)))


def view_error(point_optical: Array) -> Array:
    """Angular error (2,) in rad of a point (3,) in an optical frame: to the right and down."""
    x, y, z = (float(v) for v in point_optical)
    across = math.hypot(x, y)
    if across < 1e-12:
        return np.array([0.0 if z >= 0 else math.pi, 0.0])
    angle = math.atan2(across, z)
    return np.array([angle * x / across, angle * y / across])


def _bounds(joints: Sequence[str], limits: Mapping[str, JointLimit]) -> tuple[Array, Array]:
    low = [limits[j].lower if limits[j].lower is not None else -math.pi for j in joints]
    high = [limits[j].upper if limits[j].upper is not None else math.pi for j in joints]
    return np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
