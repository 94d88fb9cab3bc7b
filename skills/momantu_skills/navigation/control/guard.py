"""The collision guard: limits every command so that the base can stop before obstacles."""

from __future__ import annotations

import math

import numba
import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.robot import BaseLimits

REACTION = 0.2
"""Time that a command stays in effect before braking begins, s: one control period and one scan."""
HARD_MARGIN = 0.02
"""Least distance between the footprint and any hit of the newest scan, m."""
NEAR = 1.6
"""Hits farther away than this, m, cannot be reached before the next scan."""
ROUNDING = 1e-6
"""How much nearer than stopping a command may bring a hit that is inside the margin, m."""
TOGETHER = 0.3
"""Distance within which columns belong together, m."""
DEEPEST = -0.01
"""Least distance that a column takes over from one beside it, m: less is a contact, not a gap that
was drawn too narrow."""
STEP = 0.05
"""Time step of the prediction, s."""
LONGEST = 3.0
"""How far it looks ahead at most, s."""


def safe_share(
    command: tuple[float, float, float],
    speed: tuple[float, float, float],
    limits: BaseLimits,
    discs: Array,
    hits: Array,
) -> float:
    """Return the largest of 1, 3/4, 1/2, 1/4, 0 that scales a command to a safe one.

    command, speed: (m/s ahead, rad/s, m/s to the left), commanded and measured. discs: footprint
    (m, 3), or (m, 5) with the lowest and highest point of each. hits: points (n, 2), or columns
    (n, 5) with the lowest and highest point of each, and its radius; all in the base frame, m. What
    has no heights is met at any. A hit that is inside the margin already does not forbid motion:
    only commands that bring it nearer than stopping are refused. Columns belong together: what
    stands beside one that is inside the margin may come as near, as on a drive along a wall, but
    not into a contact.
    """
    near = hits[np.hypot(hits[:, 0], hits[:, 1]) < NEAR]
    together = TOGETHER if near.shape[1] == 5 else 0.0
    if near.shape[1] == 2:
        near = np.column_stack([near, np.tile((-np.inf, np.inf, 0.0), (len(near), 1))])
    if discs.shape[1] == 3:
        discs = np.column_stack([discs, np.tile((-np.inf, np.inf), (len(discs), 1))])
    bounds = np.array([limits.linear_acceleration, limits.angular_acceleration])
    for share in (1.0, 0.75, 0.5, 0.25):
        wanted = np.array([*(part * share for part in command), *speed])
        if _clear(wanted, bounds, discs, near, together):
            return share
    return 0.0


@numba.njit(cache=True)
def _clear(wanted: Array, bounds: Array, discs: Array, hits: Array, together: float) -> bool:
    stopping = wanted.copy()
    stopping[:3] = 0.0
    stop, motion = _motion(stopping, bounds), _motion(wanted, bounds)
    least = np.full(hits.shape[0], HARD_MARGIN)
    for j in range(hits.shape[0]):
        if _away(0.0, 0.0, 1.0, 0.0, discs, hits[j]) < HARD_MARGIN:
            least[j] = _nearest(stop, discs, hits[j], -np.inf) - ROUNDING
    allowed = least.copy()
    for i in range(hits.shape[0]):
        if least[i] == HARD_MARGIN:
            continue
        for j in range(hits.shape[0]):
            if math.hypot(hits[i, 0] - hits[j, 0], hits[i, 1] - hits[j, 1]) < together:
                allowed[j] = min(allowed[j], max(least[i], DEEPEST))
    for j in range(hits.shape[0]):
        if _nearest(motion, discs, hits[j], allowed[j]) < allowed[j]:
            return False
    return True


@numba.njit(cache=True)
def _motion(wanted: Array, bounds: Array) -> Array:
    """Poses (n, 4), as x, y, m, and cosine and sine of the yaw, until the base has stopped.

    wanted: (m/s ahead, rad/s, m/s to the left), commanded, then measured. bounds: m/s2, rad/s2.
    """
    poses = np.empty((math.ceil(LONGEST / STEP) + 1, 4))
    x = y = yaw = 0.0
    v = wanted[3]
    w = wanted[4]
    u = wanted[5]
    t = 0.0
    count = 0
    while t < LONGEST:
        to_v = wanted[0] if t < REACTION else 0.0
        to_w = wanted[1] if t < REACTION else 0.0
        to_u = wanted[2] if t < REACTION else 0.0
        v += min(max(to_v - v, -bounds[0] * STEP), bounds[0] * STEP)
        w += min(max(to_w - w, -bounds[1] * STEP), bounds[1] * STEP)
        u += min(max(to_u - u, -bounds[0] * STEP), bounds[0] * STEP)
        yaw += w * STEP
        x += v * math.cos(yaw) * STEP - u * math.sin(yaw) * STEP
        y += v * math.sin(yaw) * STEP + u * math.cos(yaw) * STEP
        t += STEP
        poses[count, 0] = x
        poses[count, 1] = y
        poses[count, 2] = math.cos(yaw)
        poses[count, 3] = math.sin(yaw)
        count += 1
        if t > REACTION and abs(v) < 1e-9 and abs(w) < 1e-9 and abs(u) < 1e-9:
            break
    return poses[:count]


@numba.njit(cache=True)
def _nearest(motion: Array, discs: Array, hit: Array, enough: float) -> float:
    """Return the least distance from a hit to the discs on a motion, or the first below enough."""
    least = np.inf
    for i in range(motion.shape[0]):
        away = _away(motion[i, 0], motion[i, 1], motion[i, 2], motion[i, 3], discs, hit)
        if away < least:
            least = away
            if least < enough:
                break
    return least


@numba.njit(cache=True)
def _away(x: float, y: float, c: float, s: float, discs: Array, hit: Array) -> float:
    """Return the distance from a hit to the discs at its height, at (x, y), heading (cos, sin)."""
    least = 1e9
    for i in range(discs.shape[0]):
        if discs[i, 3] > hit[3] or discs[i, 4] < hit[2]:
            continue
        px = x + c * discs[i, 0] - s * discs[i, 1]
        py = y + s * discs[i, 0] + c * discs[i, 1]
        least = min(least, math.hypot(hit[0] - px, hit[1] - py) - discs[i, 2] - hit[4])
    return least
