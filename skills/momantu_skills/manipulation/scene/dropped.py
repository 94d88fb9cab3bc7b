"""Where something that the hand has lost may lie on the floor, until a picture shows it."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.messages import GRAVITY, RobotState

ASIDE = 0.3
"""How far a thing that has fallen may jump or roll away, m. What rolls farther comes into view of a
camera that looks ahead."""
GRID = 0.05
"""Distance between the points that stand for the floor, m."""


def dropped(state: RobotState, there: Array, size: float, front: float) -> Array:
    """Points (n, 2) of the floor, odom, m, on which a thing that fell from `there` may lie.

    there: (3,) where it was in the hand, base frame, m. size: its longest edge, m. It goes on as
    the base moves while it falls: it lies between below the hand and where that leads it. front: x
    of the base's front, base frame, m. Only points ahead of it count, which the base could drive
    onto; so a base over which the hand is can still turn away or back out.
    """
    falls = math.sqrt(2.0 * max(0.0, float(there[2])) / GRAVITY)
    velocity = np.array([state.linear, state.lateral])
    velocity += state.angular * np.array([-there[1], there[0]])
    points = _around(there[:2], there[:2] + falls * velocity, ASIDE + size / 2.0)
    points = points[points[:, 0] > front]
    return np.asarray(Pose2D.from_transform(state.odom_from_base).apply(points))


def _around(start: Array, end: Array, radius: float) -> Array:
    """Grid points (n, 2) within `radius` of the way from `start` (2,) to `end` (2,)."""
    low, high = np.minimum(start, end) - radius, np.maximum(start, end) + radius
    x, y = (np.arange(a, b + GRID, GRID) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    way = end - start
    share = (points - start) @ way / max(float(way @ way), 1e-12)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * way
    return np.asarray(points[np.linalg.norm(points - nearest, axis=1) <= radius])
