"""Checking in a depth picture whether a round object lies where it was set down."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.hand.verification import ABOVE, INSIDE, SOME, TOP, points_of

ASIDE = np.arange(-0.06, 0.0601, 0.005)
"""How far it may have rolled, m: fingers that open push it a little."""
TURNS = np.radians(np.arange(-25.0, 25.1, 2.5))
"""How far it may have turned, rad."""
MOST_POINTS = 300
"""Points that are fitted at most."""
FAR = 0.012
"""Distance from the side beyond which a point counts no more, m: a bottle's neck is narrower."""
MISFIT = 0.006
"""Largest mean distance from the side, m."""
ALONE = 0.7
"""Least share of the points around it that are its own."""
AROUND = 0.03
"""How far around it, m."""
SHIFT = 0.05
"""Farthest that it may have moved along its axis, m."""


def beside(
    points: Array, pose: Transform, thing: DetectedObject, support: float
) -> Transform | None:
    """Where points (n, 3), odom, show the object lying at its spot or next to it, or None.

    pose: `odom_from_object` at the spot, with a level z axis. support: height of the surface, m.
    The axis is fitted to the points by trying all shifts and turns: of those in the picture, the
    mean distance from the side of the cylinder is the least.
    """
    radius, half = max(thing.size[:2]) / 2, thing.size[2] / 2
    up = pose.rotation[2]
    side = np.cross(up, (0.0, 0.0, 1.0))
    local = pose.inverse().apply(points[points[:, 2] > support + ABOVE])
    along, aside, high = local[:, 2], local @ side, local @ up
    near = (np.abs(along) < half + SHIFT) & (high < radius + TOP)
    near &= np.abs(aside) < radius + ASIDE[-1] + AROUND
    along, aside, high = along[near], aside[near], high[near]
    if len(along) < SOME:
        return None
    step = -(-len(along) // MOST_POINTS)
    turns, shifts = (each.ravel()[:, None] for each in np.meshgrid(TURNS, ASIDE))
    across = (aside[::step] - shifts) * np.cos(turns) - along[::step] * np.sin(turns)
    off = np.abs(np.hypot(across, high[::step]) - radius)
    misfit = np.minimum(off, FAR).mean(axis=1)
    best = int(np.argmin(misfit))
    turn, shift = float(turns[best, 0]), float(shifts[best, 0])
    across = (aside - shift) * math.cos(turn) - along * math.sin(turn)
    length = along * math.cos(turn) + (aside - shift) * math.sin(turn)
    away = np.hypot(across, high)
    own = (away < radius + INSIDE) & (np.abs(length) < half + SHIFT)
    around = (away < radius + AROUND) & (np.abs(length) < half + AROUND)
    if misfit[best] > MISFIT or own.sum() < SOME or own.sum() < ALONE * around.sum():
        return None
    moved = shift * side + np.array((0.0, 0.0, _middle(length[own], half)))
    return pose @ Transform(moved, quaternion_from_axis_angle(up, turn))


def at(points: Array, pose: Transform, thing: DetectedObject, support: float) -> str:
    """What points (n, 3) show where the object should lie: "there" or "gone"."""
    mine = points_of(points, pose, thing, support)
    high = support + max(thing.size[:2])
    seen = len(mine) >= SOME and abs(float(np.quantile(mine[:, 2], 0.98)) - high) < TOP
    return "there" if seen else "gone"


def _middle(length: Array, half: float) -> float:
    """How far the middle is along the axis, m: no farther than what is seen demands.

    A part that is seen may lie anywhere along the object. length: (n,) of its points, m.
    """
    low, high = np.quantile(length, (0.02, 0.98)).tolist()
    least, most = high - half, low + half
    return (low + high) / 2 if least > most else float(np.clip(0.0, least, most))
