"""Turn and sides of a box that stands, by its points and normals, also where a part is hidden.

Upright faces tell the turn, however little of them is seen. The points tell where the visible sides
are, and what is hidden is as long as the network says.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.perception.geometry.rectangles import (
    Rectangle,
    fitted_to,
    rectangle_at,
    smallest_rectangle,
)
from momantu_skills.perception.learned.solids import Solid

LEAST = 25
"""Fewest points of a box for fitting its sides."""
BEYOND = 0.03
"""How far outside the ball around the network's box a box's points may lie, m."""
BELOW_TOP = 0.010
"""Points of a box's sides lie at least so far below its top, m."""
STEEP = 0.45
"""Vertical share of a normal up to which its face is upright."""
FACING, ALIKE = 15, 0.6
"""Fewest normals of upright faces that tell a turn, and the least length of their mean."""
MARGIN = 0.015
"""How far outside the told sides a box's points may lie, m."""
HIDDEN = 0.04
"""A side that is seen to be shorter by more than this, m, is hidden in part."""


class Sides(NamedTuple):
    """turn: about the axis, rad. centre: (2,) and size: (x, y) across it, m, in its frame."""

    turn: float
    centre: Array
    size: tuple[float, float]


def sides(thing: Solid, own: Array, normals: Array, high: float) -> Sides | None:
    """The sides of a box, seen from above; None if it leans, or if too little is seen.

    own: (n, 3) its points, normals: (n, 3), 0 where they are not known, high: its upper end; all in
    its frame, m.
    """
    if not thing.upright:
        return None
    ball = np.linalg.norm(own, axis=1) < float(np.linalg.norm(thing.size)) / 2 + BEYOND
    body, normals = own[ball], normals[ball]
    if len(body) < LEAST:
        return None
    yaw = _turn(normals)
    if yaw is None:
        start = smallest_rectangle(body[:, :2])
        yaw = fitted_to(start, body[:, :2], _below(body, high)).yaw
    told = _told(thing, yaw)
    c, s = math.cos(yaw), math.sin(yaw)
    across = np.abs(body[:, :2] @ np.array([[c, -s], [s, c]]))
    body = body[(across < told / 2 + MARGIN).all(axis=1)]
    if len(body) < LEAST:
        return None
    start = rectangle_at(body[:, :2], yaw)
    return _completed(fitted_to(start, body[:, :2], _below(body, high)), thing)


def _below(body: Array, high: float) -> Array:
    """Points (n, 2) of the sides, from above."""
    return body[body[:, 2] < high - BELOW_TOP][:, :2]


def _turn(normals: Array) -> float | None:
    """The turn about z that upright faces have by their normals, in [-pi/4, pi/4); None if unsure.

    Faces at right angles count alike: the mean is that of four times the bearings.
    """
    upright = (np.abs(normals[:, 2]) < STEEP) & (normals != 0.0).any(axis=1)
    if int(upright.sum()) < FACING:
        return None
    bearings = np.arctan2(normals[upright, 1], normals[upright, 0])
    x, y = float(np.cos(4.0 * bearings).mean()), float(np.sin(4.0 * bearings).mean())
    return math.atan2(y, x) / 4.0 if math.hypot(x, y) > ALIKE else None


def _told(thing: Solid, yaw: float) -> Array:
    """Sizes (2,) that the network says a box has along the axes at a yaw within its frame, rad."""
    x, y, _ = thing.size
    c, s = abs(math.cos(yaw)), abs(math.sin(yaw))
    return np.array([x, y] if c > s else [y, x])


def _completed(found: Rectangle, thing: Solid) -> Sides:
    """Sides from those that are seen, and as long as told where an end is hidden."""
    c, s = math.cos(found.yaw), math.sin(found.yaw)
    axes = np.array([[c, -s], [s, c]])
    at, size = axes.T @ found.centre, found.size.copy()
    for axis, told in enumerate(_told(thing, found.yaw)):
        missing = told - size[axis]
        if missing > HIDDEN:
            # one end is seen: of both ways to go on from it the one that ends nearer to the told
            at[axis] = min(at[axis] - missing / 2, at[axis] + missing / 2, key=abs)
            size[axis] = told
    x, y = size.tolist()
    return Sides(found.yaw, axes @ at, (x, y))
