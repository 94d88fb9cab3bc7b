"""Turn, size and place by the depth itself, where enough of a thing is seen.

The network says what a thing is and about how it lies. Its coordinates are less exact than the
depth, and their errors make things wider, so the thing's own points tell where its sides are.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_skills.perception.geometry.revolution import fit_revolution
from momantu_skills.perception.learned import boxes
from momantu_skills.perception.learned.boxes import Sides
from momantu_skills.perception.learned.solids import Solid

MARGIN = 0.015
"""How far outside the box that the coordinates give a thing's points may lie, m."""
MOVED = 0.025
"""Farthest that a thing's end, side or axis is moved, m; else its points show a part of it."""
LEAST = 25
"""Fewest points for fitting sides."""
INNER = 0.6
"""Points nearer to the axis than this share of the radius are on an end, not on the side."""
END = 0.008
"""Points so near to a thing's upper end, m, are on it, not on the side: seen from above, they are
most, and their slice would be too narrow."""
MISFIT = 0.004
"""Median distance of points to a fitted side up to which it explains them, m."""
WIDEST = 90.0
"""Percentile of the radii that is the widest part's, of what is not as wide everywhere."""
ENDS = 2.0
"""Per cent of the points that noise puts beyond each end."""
RIM, EDGE = 0.015, 95.0
"""A bowl's rim: so far below its upper end, m, and the percentile of the points at its edge."""
HANDLE, FARTHEST = 0.008, 0.045
"""From where to where outside a mug's side its handle lies, m."""
BETWEEN = 0.1
"""A handle keeps this share of the height away from both ends of its mug."""
GRIP, TOGETHER = 4, 0.8
"""Fewest points of a handle, and the least length of their mean direction: they lie on one side."""
LEVEL = 0.001
"""Share of an axis along the vertical up to which it is level; `solids` makes nearly level ones so.
"""
TOP = 98.0
"""Percentile of the points' heights at the upper side of what lies; noise is above it."""
STANDS = 0.025
"""Height of a thing's lower end above the surface up to which it stands there, m."""


class Seen(NamedTuple):
    """What is seen of one thing, in the frame `level`.

    points: (n, 3), m. normals: (n, 3), 0 where they are not known. of_handle: (n,) which points
    show a handle. around: (m, 3) points above the surface that are of no thing, m. eye: height of
    the camera, which is above the origin, m.
    """

    points: Array
    normals: Array
    of_handle: NDArray[np.bool_]
    around: Array
    eye: float


def refined(thing: Solid, seen: Seen) -> Solid:
    """A thing as its points show it; z = 0 is the surface. What they do not show stays."""
    object_from_level = thing.frame_from_object.inverse()
    own = object_from_level.apply(seen.points)
    near = (np.abs(own) < np.array(thing.size) / 2 + MARGIN).all(axis=1)
    body = own[near & ~seen.of_handle]
    if len(body) < LEAST:
        return thing
    low, high = _ends(thing, body)
    sides = None
    if thing.symmetry is Symmetry.BOX:
        sides = boxes.sides(thing, own, seen.normals @ object_from_level.rotation.T, high)
    elif thing.has_axis:
        eye = object_from_level.apply((0.0, 0.0, seen.eye))
        sides = _resting(thing, body, eye) or _round(thing, body, high, eye)
    sides = sides or Sides(0.0, np.zeros(2), thing.size[:2])
    if thing.symmetry is Symmetry.HANDLE:
        around = object_from_level.apply(seen.around)
        bearing = _bearing(own, seen.of_handle, around, sides, (low, high))
        thing = replace(thing, handle=bearing is not None)
        sides = sides._replace(turn=bearing or 0.0)
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), sides.turn)
    change = Transform((*sides.centre, (low + high) / 2), turn)
    size = (*sides.size, high - low)
    return replace(thing, frame_from_object=thing.frame_from_object @ change, size=size)


def _ends(thing: Solid, body: Array) -> tuple[float, float]:
    """Where a thing begins and ends along its axis, m in its frame.

    body: (n, 3) points in its frame. What stands on the surface begins there.
    """
    half = thing.size[2] / 2
    shown = np.percentile(body[:, 2], [ENDS, 100.0 - ENDS]).tolist()
    low, high = (
        found if abs(found - told) < MOVED else told
        for found, told in zip(shown, (-half, half), strict=True)
    )
    up, middle = float(thing.frame_from_object.rotation[2, 2]), thing.frame_from_object.position[2]
    if thing.upright and middle - half < STANDS:
        return (-float(middle), high) if up > 0.0 else (low, float(middle))
    return low, high


def _resting(thing: Solid, body: Array, eye: Array) -> Sides | None:
    """The side of a round thing that lies with its axis level; None of any other.

    It rests on the surface, so its highest points tell its radius. body: (n, 3), eye: (3,) camera,
    both in its frame, m.
    """
    frame = thing.frame_from_object
    if abs(float(frame.rotation[2, 2])) > LEVEL or thing.symmetry is Symmetry.ROUND:
        return None
    radius = float(np.percentile(frame.apply(body)[:, 2], TOP)) / 2
    up = frame.rotation[2, :2]
    lift = radius - float(frame.position[2])
    if abs(radius - thing.size[0] / 2) > MOVED or abs(lift) > MOVED:
        return None
    side = body[(body[:, :2] * (eye[:2] - body[:, :2])).sum(axis=1) > 0.0]
    found = fit_revolution(side, radius) if len(side) >= LEAST else None
    aside = np.zeros(2)
    if found is not None and found.misfit < MISFIT:
        aside = found.centre - float(found.centre @ up) * up
    if float(np.hypot(*aside)) > MOVED:
        return None
    return Sides(0.0, aside + lift * up, (2 * radius, 2 * radius))


def _round(thing: Solid, body: Array, high: float, eye: Array) -> Sides | None:
    """The side of a round thing; None if too little of it is seen.

    body: (n, 3), high: upper end, eye: (3,) camera, all in its frame, m.
    """
    radius = thing.size[0] / 2
    side = body[np.hypot(body[:, 0], body[:, 1]) > INNER * radius]
    if thing.category != "bowl":  # of a bowl the inside is seen
        side = side[side[:, 2] < high - END]
        side = side[(side[:, :2] * (eye[:2] - side[:, :2])).sum(axis=1) > 0.0]
    found = fit_revolution(side) if len(side) >= LEAST else None
    if found is None or found.misfit > MISFIT:
        return None
    wide = found.radius
    if thing.symmetry is Symmetry.ROUND:
        wide = float(np.percentile(found.radii[~np.isnan(found.radii)], WIDEST))
    if thing.category == "bowl":
        rim = body[body[:, 2] > high - RIM, :2] - found.centre
        if len(rim) >= LEAST:
            wide = max(wide, float(np.percentile(np.hypot(rim[:, 0], rim[:, 1]), EDGE)))
    if abs(wide - radius) > MOVED or float(np.hypot(*found.centre)) > MOVED:
        return None
    return Sides(0.0, found.centre, (2 * wide, 2 * wide))


def _bearing(
    own: Array,
    of_handle: NDArray[np.bool_],
    around: Array,
    sides: Sides,
    ends: tuple[float, float],
) -> float | None:
    """Bearing of a mug's handle about its axis, rad; None if none is seen.

    What the network takes for a handle shows it, else what lies beside the mug. own: (n, 3), with
    of_handle (n,), and around: (m, 3), in its frame, m.
    """
    radius, room = sides.size[0] / 2, BETWEEN * (ends[1] - ends[0])
    grip = own[of_handle, :2] - sides.centre
    grip = grip[np.hypot(grip[:, 0], grip[:, 1]) > radius]
    if len(grip) < GRIP:
        every = np.concatenate([own, around])
        between = (every[:, 2] > ends[0] + room) & (every[:, 2] < ends[1] - room)
        grip = every[between, :2] - sides.centre
        away = np.hypot(grip[:, 0], grip[:, 1])
        grip = grip[(away > radius + HANDLE) & (away < radius + FARTHEST)]
    if len(grip) < GRIP:
        return None
    x, y = (grip / np.linalg.norm(grip, axis=1, keepdims=True)).mean(axis=0).tolist()
    return math.atan2(y, x) if math.hypot(x, y) > TOGETHER else None
