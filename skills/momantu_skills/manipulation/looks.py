"""What a depth picture says about a place where something stands, stood, or should stand."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import DetectedObject

INSIDE = 0.012
"""m around an object in which points are its own."""
ABOVE = 0.012
"""m above the support below which points are the support's."""
SOME = 25
"""Points (every fourth pixel each way) that show something: of a can there are 150 at 1 m."""
TOP = 0.02
"""m below the expected top in which an upright object shows points."""
AROUND = 0.12
"""m around a spot in which a toppled object still lies."""
LYING = 0.75
"""Share of the height below which what stands there has fallen over."""


def points_of(points: Array, pose: Transform, thing: DetectedObject, support: float) -> Array:
    """Those of points (n, 3) that lie on an object at `odom_from_object`, above its support."""
    local = pose.inverse().apply(points)
    half = np.array(thing.size) / 2 + INSIDE
    if thing.shape == "cylinder":
        within = np.linalg.norm(local[:, :2], axis=1) <= half[:2].max()
    else:
        within = (np.abs(local[:, :2]) <= half[:2]).all(axis=1)
    within &= (np.abs(local[:, 2]) <= half[2]) & (points[:, 2] > support + ABOVE)
    return np.asarray(points[within])


def stands_there(points: Array, pose: Transform, thing: DetectedObject, support: float) -> bool:
    """Whether the picture's points (n, 3), odom, show something where the object should be."""
    return len(points_of(points, pose, thing, support)) >= SOME


def standing(points: Array, pose: Transform, thing: DetectedObject, support: float) -> str:
    """What the points (n, 3) show around a spot: "upright", "toppled" or "gone".

    pose: `odom_from_object` of the object standing upright there.
    """
    flat = np.linalg.norm(points[:, :2] - pose.position[:2], axis=1)
    mine = points_of(points, pose, thing, support)
    top = support + thing.size[2]
    if len(mine) >= SOME and float(np.quantile(mine[:, 2], 0.98)) > top - TOP:
        return "upright"
    near = points[(flat < AROUND) & (points[:, 2] > support + ABOVE)]
    near = near[near[:, 2] < top + TOP]
    if len(near) < SOME:
        return "gone"
    return (
        "toppled"
        if float(np.quantile(near[:, 2], 0.98)) < support + LYING * (top - support)
        else "gone"
    )
