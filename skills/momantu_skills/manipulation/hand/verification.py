"""Checking in a depth picture whether an object stands, stood, or should stand at a place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject

INSIDE = 0.012
"""Margin around an object within which points belong to it, m."""
ABOVE = 0.012
"""Height above the support below which points belong to the support, m."""
SOME = 25
"""Points (every fourth pixel in each direction) that prove an object: a can at 1 m has 150."""
TOP = 0.02
"""An upright object shows points within this of its expected top, m."""
AROUND = 0.12
"""Distance from a spot within which a toppled object is still found, m."""
LYING = 0.75
"""Share of its height below which an object counts as toppled."""
THIN = 0.01
"""Half of the smallest width of a standing object, m."""
STEP = 0.004
"""Distance between two positions that are tried, m."""
CLOSE = 0.03
"""Margin around an outline that must be free of other points, m."""
STRAY = 0.1
"""Share of the points that may lie in that margin: depth noise."""
MISFIT = 0.006
"""Largest mean distance of the points from an outline, m."""
FEW = 8
"""Points that prove a top if the hand hides most of it."""
LEAN = 0.015
"""How far the wall of a hollow thing may lean inwards within `TOP` of its rim, m: one of 45
degrees, less what noise hides."""
SECTORS, ROUND_ABOUT = 12, 7
"""Sectors around a hollow thing, and in how many of them its rim must be seen: more than half of
it, since less does not tell its middle."""
KNOWN = 0.03
"""Distance from earlier points within which nothing counts as new, m: one and a half cells."""


def points_of(points: Array, pose: Transform, thing: DetectedObject, support: float) -> Array:
    """Points (n, 3) that lie on an object at `odom_from_object`, above its support."""
    local = pose.inverse().apply(points)
    half = np.array(thing.size) / 2 + INSIDE
    if thing.shape == "cylinder":
        within = np.linalg.norm(local[:, :2], axis=1) <= half[:2].max()
    else:
        within = (np.abs(local[:, :2]) <= half[:2]).all(axis=1)
    within &= (np.abs(local[:, 2]) <= half[2]) & (points[:, 2] > support + ABOVE)
    return np.asarray(points[within])


def stands_there(points: Array, pose: Transform, thing: DetectedObject, support: float) -> bool:
    """Whether the picture's points (n, 3), odom, show something at the object's place."""
    return len(points_of(points, pose, thing, support)) >= SOME


def standing(points: Array, pose: Transform, thing: DetectedObject, support: float) -> str:
    """What the points (n, 3) show around a spot: "there" (upright), "toppled" or "gone".

    pose: `odom_from_object` of the object standing upright there.
    """
    flat = np.linalg.norm(points[:, :2] - pose.position[:2], axis=1)
    mine = points_of(points, pose, thing, support)
    top = support + thing.size[2]
    if len(mine) >= SOME and float(np.quantile(mine[:, 2], 0.98)) > top - TOP:
        return "there"
    near = points[(flat < AROUND) & (points[:, 2] > support + ABOVE)]
    near = near[near[:, 2] < top + TOP]
    if len(near) < SOME:
        return "gone"
    return (
        "toppled"
        if float(np.quantile(near[:, 2], 0.98)) < support + LYING * (top - support)
        else "gone"
    )


def unseen_before(points: Array, before: Array) -> Array:
    """Points (n, 3) that are not near any point (m, 3) that was seen earlier."""
    if not len(before) or not len(points):
        return points
    apart, _ = cKDTree(before).query(points, distance_upper_bound=KNOWN)
    return np.asarray(points[~np.isfinite(apart)])


def beside(
    points: Array, pose: Transform, thing: DetectedObject, support: float, hollow: bool = False
) -> Transform | None:
    """Where points (n, 3) show the object upright next to its spot, or None.

    The object may slip while the fingers close and open. pose: `odom_from_object` at the spot. The
    spot was free, so no other object has its centre within the outline there. The match must have
    the object's height and outline and must stand alone. hollow: the object is open at the top and
    its walls may lean, so that its rim alone has the outline.
    """
    half = np.array(thing.size) / 2
    local, rise = pose.inverse().apply(points)[:, :2], points[:, 2] - support
    reach = float(half[:2].min()) + THIN
    around = np.linalg.norm(local, axis=1) < reach + float(np.hypot(*half[:2])) + AROUND / 2
    around &= rise > ABOVE
    local, rise = local[around], rise[around]
    body = rise < thing.size[2] + TOP
    top = rise[body] > thing.size[2] - TOP
    if body.sum() < SOME or top.sum() < FEW:
        return None
    shifts = _shifts(reach)
    out = _outside(local[body] - shifts[:, None], half[:2], thing.shape)
    if hollow:
        fit = _ring_misfit(out, top)
    else:
        side = rise[body] < thing.size[2] - ABOVE
        fit = _solid_misfit(out, side)
    best = int(np.argmin(fit.mean(axis=1)))
    own, close = out[best] <= INSIDE, out[best] < CLOSE
    higher = _outside(local[~body] - shifts[best], half[:2], thing.shape) <= INSIDE
    seen = own.sum() >= SOME and (own & top).sum() >= FEW
    alone = (close & ~own).sum() <= STRAY * own.sum() and higher.sum() < FEW
    counted = top if hollow else close
    if not (seen and alone and fit[best][counted].mean() < MISFIT):
        return None
    if hollow and not _seen_about(local[body][own & top] - shifts[best]):
        return None
    return pose @ Transform((*shifts[best], 0.0))


def _solid_misfit(out: Array, side: NDArray[np.bool_]) -> Array:
    """Distance (k, n) of points from a solid with upright sides, m.

    out: (k, n) outside its outline. side: which points (n,) are below its top.
    """
    return np.minimum(np.where(side, np.abs(out), np.maximum(out, 0.0)), CLOSE)


def _ring_misfit(out: Array, top: NDArray[np.bool_]) -> Array:
    """Distance (k, n) of points from a hollow thing whose rim's wall leans evenly, m.

    Points below the rim are anywhere inside the outline. See `_solid_misfit`; top: which points
    (n,) show the rim.
    """
    near = np.clip(np.median(out[:, top], axis=1), -LEAN, 0.0)[:, None]
    return np.minimum(np.where(top, np.abs(out - near), np.maximum(out, 0.0)), CLOSE)


def _seen_about(rim: Array) -> bool:
    """Whether points (n, 2) of a rim lie on most sides of the middle."""
    turns = np.arctan2(rim[:, 1], rim[:, 0]) / (2 * np.pi) + 0.5
    return len(np.unique((turns * SECTORS).astype(np.int64) % SECTORS)) >= ROUND_ABOUT


def _shifts(reach: float) -> Array:
    """Positions (k, 2) at most `reach` m from a spot."""
    steps = np.arange(-reach, reach + STEP / 2, STEP)
    places = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    return np.asarray(places[np.linalg.norm(places, axis=1) <= reach])


def _outside(flat: Array, half: Array, shape: str) -> Array:
    """Distance of points (..., 2) outside an upright object's outline, m; negative inside."""
    if shape == "cylinder":
        return np.asarray(np.linalg.norm(flat, axis=-1) - half.max())
    over = np.abs(flat) - half
    inside = np.minimum(over.max(axis=-1), 0.0)
    return np.asarray(np.linalg.norm(np.maximum(over, 0.0), axis=-1) + inside)
