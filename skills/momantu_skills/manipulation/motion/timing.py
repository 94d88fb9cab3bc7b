"""Turning a path of joints into a timed trajectory within speed and acceleration limits."""

from __future__ import annotations

import logging
from itertools import pairwise

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.lazy import putting_off
from momantu_bt.messages import JointTrajectory, frozen
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.group import Group

# for plots that nobody draws here, and it takes longer than toppra itself
with putting_off("matplotlib", "matplotlib.pyplot"):
    import toppra
    from toppra import algorithm, constraint

PER_WAYPOINT = 10
"""Grid points between two waypoints: with fewer the spline's curvature at corners is missed."""
SHORTEST = 1e-4
"""Length below which a path is not a motion, rad or m."""

logging.getLogger("toppra").setLevel(logging.ERROR)
toppra.setup_logging("ERROR")


def densified(path: Array, distance: float) -> Array:
    """The same polyline (k, n) with waypoints at most `distance` (largest joint) apart."""
    pieces = [path[:1]]
    for a, b in pairwise(path):
        count = max(1, int(np.ceil(float(np.max(np.abs(b - a))) / distance)))
        pieces.append(a + np.linspace(0.0, 1.0, count + 1)[1:, None] * (b - a))
    return np.vstack(pieces)


def rounded(path: Array, distance: float, radius: float) -> Array:
    """Like `densified`, without the points (k, n) within `radius` of a corner.

    A spline through the remaining points rounds the corner.
    """
    pieces = [path[:1]]
    last = len(path) - 2
    for i, (a, b) in enumerate(pairwise(path)):
        length = float(np.max(np.abs(b - a)))
        low = 0.0 if i == 0 else min(0.5, radius / max(length, SHORTEST))
        high = 1.0 if i == last else max(0.5, 1.0 - radius / max(length, SHORTEST))
        count = max(1, int(np.ceil((high - low) * length / distance)))
        shares = np.linspace(low, high, count + 1) if high > low else np.array([low])
        pieces.append(a + (shares[1:] if i == 0 else shares)[:, None] * (b - a))
    return np.vstack(pieces)


def timed(
    group: Group,
    path: Array,
    config: PlanningConfig,
    tip_speed: float | None = None,
    rounding: float | None = None,
    joint_speed: float | None = None,
) -> JointTrajectory:
    """The fastest trajectory along waypoints (k, n), at rest at both ends.

    tip_speed: largest speed of the tip, m/s. rounding: see `rounded`. joint_speed: largest speed of
    any joint, rad/s or m/s. Method: Pham and Pham, "A New
    Approach to Time-Optimal Path Parameterization Based on Reachability Analysis" (TOPP-RA), 2018.

    Raises:
        ValueError: no timing within the limits; only a discontinuous path can cause it.
    """
    dense = (
        densified(path, config.densify)
        if rounding is None
        else rounded(path, config.densify, rounding)
    )
    points = _distinct(dense)
    if len(points) < 2:
        return at_rest(group, path[-1])
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spline = toppra.SplineInterpolator(knots, points)
    limits = [
        constraint.JointVelocityConstraint(_both(group.velocity * config.speed)),
        constraint.JointAccelerationConstraint(_both(group.acceleration * config.speed)),
    ]
    grid = np.linspace(0.0, knots[-1], max(30, PER_WAYPOINT * len(points)))
    solver = algorithm.TOPPRA(limits, spline, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    result = solver.compute_trajectory()
    if result is None:
        raise ValueError(f"no timing within the limits for a path of {len(path)} waypoints")
    count = max(2, int(np.ceil(result.duration / config.sample)) + 1)
    times = np.linspace(0.0, result.duration, count)
    # beside a limit the spline swings a few milliradians past it; the joints stay inside
    positions = np.clip(result(times), group.lower, group.upper)
    velocities = result(times, 1)
    velocities[0] = velocities[-1] = 0.0
    slow = 1.0 if tip_speed is None else _slowdown(group, positions, velocities, tip_speed)
    if joint_speed is not None:
        slow = max(slow, float(np.abs(velocities).max()) / joint_speed)
    return _trajectory(group, times * slow, positions, velocities / slow)


def at_rest(group: Group, q: Array) -> JointTrajectory:
    """A trajectory that stays at joints (n,)."""
    two = np.vstack([q, q])
    return _trajectory(group, np.array([0.0, 0.05]), two, np.zeros_like(two))


def _slowdown(group: Group, positions: Array, velocities: Array, tip_speed: float) -> float:
    """Factor (at least 1) that stretches time so that the tip keeps its speed limit."""
    speeds = [
        float(np.linalg.norm((group.jacobian(q) @ v)[:3]))
        for q, v in zip(positions, velocities, strict=True)
    ]
    return max(1.0, max(speeds) / tip_speed)


def _distinct(points: Array) -> Array:
    keep = np.ones(len(points), dtype=bool)
    keep[1:] = np.max(np.abs(np.diff(points, axis=0)), axis=1) > SHORTEST
    return points[keep]


def _both(limit: Array) -> Array:
    return np.stack([-limit, limit], axis=1)


def _trajectory(group: Group, times: Array, positions: Array, velocities: Array) -> JointTrajectory:
    return JointTrajectory(group.names, frozen(times), frozen(positions), frozen(velocities))
