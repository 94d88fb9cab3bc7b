"""Forward and inverse kinematics of a serial chain, compiled. Poses are base_from_tip (4, 4)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from momantu_bt.geometry import Array

DAMPING = 1e-4
"""Lambda squared of damped least squares, in m2 of weighted joint motion: it keeps steps small near
singularities and costs a few iterations elsewhere."""
LONGEST_STEP = 0.35
"""Largest motion of a joint in one iteration, rad (or scaled m): the range of the linearisation."""


class Chain(NamedTuple):
    """A serial chain of n joints.

    origins (n, 4, 4): each joint's fixed transform from the previous joint. axes (n, 3): unit, in
    the joint's frame. slides (n,): True where prismatic. tip (4, 4): from the last joint to the
    tip. lower, upper (n,): limits, rad or m. weights (n,): squared speeds, so that slow joints
    move little (weighted pseudo-inverse).
    """

    origins: Array
    axes: Array
    slides: NDArray[np.bool_]
    tip: Array
    lower: Array
    upper: Array
    weights: Array


@njit(cache=True)
def _rotation(axis, angle, r):  # type: ignore[no-untyped-def]
    """Write the rotation about an axis to r (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = axis[0], axis[1], axis[2]
    r[0, 0] = c + x * x * (1 - c)
    r[0, 1] = x * y * (1 - c) - z * s
    r[0, 2] = x * z * (1 - c) + y * s
    r[1, 0] = y * x * (1 - c) + z * s
    r[1, 1] = c + y * y * (1 - c)
    r[1, 2] = y * z * (1 - c) - x * s
    r[2, 0] = z * x * (1 - c) - y * s
    r[2, 1] = z * y * (1 - c) + x * s
    r[2, 2] = c + z * z * (1 - c)


@njit(cache=True)
def _product(ra, pa, rb, pb, r, p):  # type: ignore[no-untyped-def]
    """Write the product of two poses to r (3, 3) and p (3,)."""
    for i in range(3):
        for j in range(3):
            r[i, j] = ra[i, 0] * rb[0, j] + ra[i, 1] * rb[1, j] + ra[i, 2] * rb[2, j]
        p[i] = ra[i, 0] * pb[0] + ra[i, 1] * pb[1] + ra[i, 2] * pb[2] + pa[i]


@njit(cache=True)
def forward(chain, q):  # type: ignore[no-untyped-def]
    """Rotation (3, 3) and position (3,) of the tip, and the geometric Jacobian (6, n) in base.

    Rows: linear velocity of the tip, then angular velocity (Siciliano et al., Robotics, 3.1).
    """
    origins, axes, slides, tip = chain.origins, chain.axes, chain.slides, chain.tip
    n = len(q)
    # two poses that take turns, as new arrays for each joint would take most of the time
    r, p = np.eye(3), np.zeros(3)
    next_r, next_p = np.empty((3, 3)), np.empty(3)
    directions, points = np.empty((n, 3)), np.empty((n, 3))
    turn, zero = np.empty((3, 3)), np.zeros(3)
    for i in range(n):
        _product(r, p, origins[i, :3, :3], origins[i, :3, 3], next_r, next_p)
        r, p, next_r, next_p = next_r, next_p, r, p
        for k in range(3):
            directions[i, k] = r[k, 0] * axes[i, 0] + r[k, 1] * axes[i, 1] + r[k, 2] * axes[i, 2]
            points[i, k] = p[k]
        if slides[i]:
            for k in range(3):
                p[k] += directions[i, k] * q[i]
        else:
            _rotation(axes[i], q[i], turn)
            _product(r, p, turn, zero, next_r, next_p)
            r, p, next_r, next_p = next_r, next_p, r, p
    _product(r, p, tip[:3, :3], tip[:3, 3], next_r, next_p)
    r, p = next_r, next_p
    jacobian = np.zeros((6, n))
    for i in range(n):
        a = directions[i]
        if slides[i]:
            jacobian[:3, i] = a
        else:
            x, y, z = p[0] - points[i, 0], p[1] - points[i, 1], p[2] - points[i, 2]
            jacobian[0, i] = a[1] * z - a[2] * y
            jacobian[1, i] = a[2] * x - a[0] * z
            jacobian[2, i] = a[0] * y - a[1] * x
            jacobian[3:, i] = a
    return r, p, jacobian


@njit(cache=True)
def _error(r, p, target):  # type: ignore[no-untyped-def]
    """Twist (6,) from the pose to the target: metres, then the rotation vector in rad."""
    e = np.empty(6)
    m = np.empty((3, 3))
    for i in range(3):
        e[i] = target[i, 3] - p[i]
        for j in range(3):
            m[i, j] = target[i, 0] * r[j, 0] + target[i, 1] * r[j, 1] + target[i, 2] * r[j, 2]
    v = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    sine = 0.5 * np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)
    cosine = 0.5 * (m[0, 0] + m[1, 1] + m[2, 2] - 1.0)
    angle = np.arctan2(sine, cosine)
    if sine > 1e-9:
        e[3:] = v * (0.5 * angle / sine)
    elif cosine > 0:
        e[3:] = 0.5 * v
    else:  # half a turn about an axis the sine cannot tell: any axis leads out of it
        e[3:] = np.array([np.pi, 0.0, 0.0])
    return e


@njit(cache=True)
def _stepped(chain, q, jacobian, e):  # type: ignore[no-untyped-def]
    """Joints (n,) after one damped, weighted step against an error (k,), within their limits."""
    weighted = jacobian * chain.weights
    system = weighted @ jacobian.T
    for i in range(len(e)):
        system[i, i] += DAMPING
    step = weighted.T @ np.linalg.solve(system, e)
    largest = np.max(np.abs(step))
    if largest > LONGEST_STEP:
        step *= LONGEST_STEP / largest
    return np.minimum(np.maximum(q + step, chain.lower), chain.upper)


@njit(cache=True)
def descend(chain, target, q, rounds, near, turn):  # type: ignore[no-untyped-def]
    """Damped least squares from `q` to `target`: joints (n,) and whether they reach it.

    near, turn: tolerances in m and rad. Limits are applied after every step.
    """
    q = q.copy()
    for _ in range(rounds):
        r, p, jacobian = forward(chain, q)
        e = _error(r, p, target)
        if (
            np.sqrt(e[0] ** 2 + e[1] ** 2 + e[2] ** 2) < near
            and np.sqrt(e[3] ** 2 + e[4] ** 2 + e[5] ** 2) < turn
        ):
            return q, True
        q = _stepped(chain, q, jacobian, e)
    return q, False


@njit(cache=True)
def solve(chain, targets, seeds, rounds, near, turn):  # type: ignore[no-untyped-def]
    """Solve each target (m, 4, 4) from each seed (s, n): joints (m, s, n) and success (m, s)."""
    m, s, n = len(targets), len(seeds), seeds.shape[1]
    found, good = np.empty((m, s, n)), np.zeros((m, s), dtype=np.bool_)
    for i in range(m):
        for j in range(s):
            found[i, j], good[i, j] = descend(
                chain,
                targets[i],
                seeds[j],
                rounds,
                near,
                turn,
            )
    return found, good


@njit(cache=True)
def trace(chain, targets, start, near, turn, jump):  # type: ignore[no-untyped-def]
    """Follow poses (k, 4, 4) at small distances from `start`: joints (k, n), number reached.

    It stops at an unreachable pose, or if a joint would move more than `jump` between two poses.
    """
    path = np.empty((len(targets), len(start)))
    q = start
    for i in range(len(targets)):
        previous = q
        q, good = descend(chain, targets[i], q, 25, near, turn)
        if not good or np.max(np.abs(q - previous)) > jump:
            return path, i
        path[i] = q
    return path, len(targets)


@njit(cache=True)
def poses(chain, postures):  # type: ignore[no-untyped-def]
    """base_from_tip (m, 4, 4) at joints (m, n)."""
    found = np.zeros((len(postures), 4, 4))
    for i in range(len(postures)):
        r, p, _ = forward(chain, postures[i])
        found[i, :3, :3] = r
        found[i, :3, 3] = p
        found[i, 3, 3] = 1.0
    return found


@njit(cache=True)
def _off_ray(r, p, ray, target):  # type: ignore[no-untyped-def]
    """Rotation vector (3,) in base from ray to target, angle, the line's direction, length."""
    way = target - p
    length = max(1e-9, np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2))
    way = way / length
    a = r @ ray
    cross = np.array(
        [
            a[1] * way[2] - a[2] * way[1],
            a[2] * way[0] - a[0] * way[2],
            a[0] * way[1] - a[1] * way[0],
        ]
    )
    sine = np.sqrt(cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2)
    angle = np.arctan2(sine, a[0] * way[0] + a[1] * way[1] + a[2] * way[2])
    if sine > 1e-9:
        cross *= angle / sine
    return cross, angle, way, length


@njit(cache=True)
def point(chain, starts, ray, target, rounds, near):  # type: ignore[no-untyped-def]
    """Rotate the tip's `ray` (3,) towards `target` (3,) from each of starts (m, n).

    Damped least squares on the angle between the ray and the line of sight. These are two
    conditions; the other degrees of freedom stay as they are. Returns joints (m, n) and the
    remaining angles (m,).
    """
    found, left = starts.copy(), np.empty(len(starts))
    for k in range(len(starts)):
        q = starts[k].copy()
        for _ in range(rounds):
            r, p, jacobian = forward(chain, q)
            e, angle, way, length = _off_ray(r, p, ray, target)
            left[k] = angle
            if angle < near:
                break
            turning = np.empty((3, len(q)))
            for i in range(len(q)):
                v, w = jacobian[:3, i], jacobian[3:, i]
                along = w[0] * way[0] + w[1] * way[1] + w[2] * way[2]
                turning[0, i] = w[0] - along * way[0] + (way[1] * v[2] - way[2] * v[1]) / length
                turning[1, i] = w[1] - along * way[1] + (way[2] * v[0] - way[0] * v[2]) / length
                turning[2, i] = w[2] - along * way[2] + (way[0] * v[1] - way[1] * v[0]) / length
            q = _stepped(chain, q, turning, e)
        found[k] = q
        r, p, _ = forward(chain, q)
        _, left[k], _, _ = _off_ray(r, p, ray, target)
    return found, left
