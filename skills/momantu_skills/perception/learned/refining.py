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
from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle, rotation_between
from momantu_skills.perception.geometry.rectangles import fitted_to, smallest_rectangle
from momantu_skills.perception.geometry.revolution import fit_revolution
from momantu_skills.perception.learned.solids import Solid

MARGIN = 0.015
"""How far outside the box that the coordinates give a thing's points may lie, m."""
MOVED = 0.025
"""Farthest that a thing's end, side or axis is moved, m; else its points show a part of it."""
LEAST = 25
"""Fewest points for fitting sides."""
INNER = 0.6
"""Points nearer to the axis than this share of the radius are on an end, not on the side."""
MISFIT = 0.004
"""Median distance of points to a fitted side up to which it explains them, m."""
WIDEST = 90.0
"""Percentile of the radii that is the widest part's, of what is not as wide everywhere."""
ENDS = 2.0
"""Per cent of the points that noise puts beyond each end."""
BELOW_TOP = 0.010
"""Points of a box's sides lie at least so far below its top, m."""
RIM, EDGE = 0.015, 95.0
"""A bowl's rim: so far below its upper end, m, and the percentile of the points at its edge."""
HANDLE, FARTHEST = 0.008, 0.045
"""From where to where outside a mug's side its handle lies, m."""
BETWEEN = 0.1
"""A handle keeps this share of the height away from both ends of its mug."""
GRIP, TOGETHER = 4, 0.8
"""Fewest points of a handle, and the least length of their mean direction: they lie on one side."""
SLANT = 0.6
"""Points whose normals have a larger share along the axis are on an end, not on the side."""
NARROW, ALIGNED = 0.35, math.cos(math.radians(25.0))
"""An axis by normals counts if they spread so much less along it, and if it is near the other."""
STANDS = 0.025
"""Height of a thing's lower end above the surface up to which it stands there, m."""
UPRIGHT = 0.999
"""Cosine of the tilt up to which an axis is upright; `solids` makes nearly upright ones so."""


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


class _Sides(NamedTuple):
    """turn: about the axis, rad. centre: (2,) and size: (x, y) across it, m, in its frame."""

    turn: float
    centre: Array
    size: tuple[float, float]


def refined(thing: Solid, seen: Seen) -> Solid:
    """A thing as its points show it; z = 0 is the surface. What they do not show stays."""
    if thing.has_axis:
        thing = _aligned(thing, seen)
    object_from_level = thing.frame_from_object.inverse()
    own = object_from_level.apply(seen.points)
    near = (np.abs(own) < np.array(thing.size) / 2 + MARGIN).all(axis=1)
    body = own[near & ~seen.of_handle]
    if len(body) < LEAST:
        return thing
    low, high = _ends(thing, body)
    sides = None
    if thing.symmetry is Symmetry.BOX:
        sides = _rectangle(thing, body, high)
    elif thing.has_axis:
        sides = _round(thing, body, high, object_from_level.apply((0.0, 0.0, seen.eye)))
    sides = sides or _Sides(0.0, np.zeros(2), thing.size[:2])
    if thing.symmetry is Symmetry.HANDLE:
        around = object_from_level.apply(seen.around)
        bearing = _bearing(own, seen.of_handle, around, sides, (low, high))
        thing = replace(thing, handle=bearing is not None)
        sides = sides._replace(turn=bearing or 0.0)
    turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), sides.turn)
    change = Transform((*sides.centre, (low + high) / 2), turn)
    size = (*sides.size, high - low)
    return replace(thing, frame_from_object=thing.frame_from_object @ change, size=size)


def _aligned(thing: Solid, seen: Seen) -> Solid:
    """A round thing with the axis that its side's normals show, unless it is upright.

    Normals of a cone or cylinder lie on a circle about the axis, so they spread least along it.
    """
    frame = thing.frame_from_object
    axis = frame.rotation[:, 2]
    if abs(float(axis[2])) > UPRIGHT:
        return thing
    own = frame.inverse().apply(seen.points)
    side = np.hypot(own[:, 0], own[:, 1]) > INNER * thing.size[0] / 2
    side &= ~seen.of_handle & (np.abs(seen.normals @ axis) < SLANT)
    side &= (seen.normals != 0.0).any(axis=1)
    if int(side.sum()) < LEAST:
        return thing
    spread, directions = np.linalg.eigh(np.cov(seen.normals[side].T))
    found = directions[:, 0] * math.copysign(1.0, float(directions[:, 0] @ axis))
    if spread[0] > NARROW * spread[1] or float(found @ axis) < ALIGNED:
        return thing
    rotation = rotation_between(axis, found) @ frame.rotation
    return replace(thing, frame_from_object=Transform.from_rotation(rotation, frame.position))


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
    if abs(up) > UPRIGHT and middle - half < STANDS:
        return (-float(middle), high) if up > 0.0 else (low, float(middle))
    return low, high


def _round(thing: Solid, body: Array, high: float, eye: Array) -> _Sides | None:
    """The side of a round thing; None if too little of it is seen.

    body: (n, 3), high: upper end, eye: (3,) camera, all in its frame, m.
    """
    radius = thing.size[0] / 2
    side = body[np.hypot(body[:, 0], body[:, 1]) > INNER * radius]
    if thing.category != "bowl":  # of a bowl the inside is seen
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
    return _Sides(0.0, found.centre, (2 * wide, 2 * wide))


def _rectangle(thing: Solid, body: Array, high: float) -> _Sides | None:
    """The sides of a box, seen from above; None if it leans, or if a part of it is seen.

    body: (n, 3), high: upper end, both in its frame, m.
    """
    if abs(float(thing.frame_from_object.rotation[2, 2])) < UPRIGHT:
        return None
    faces = body[body[:, 2] < high - BELOW_TOP][:, :2]
    found = fitted_to(smallest_rectangle(body[:, :2]), body[:, :2], faces)
    told = np.array(thing.size[:2])
    if float(np.abs(found.size - told).max()) > MOVED or float(np.hypot(*found.centre)) > MOVED:
        return None
    x, y = found.size.tolist()
    return _Sides(found.yaw, found.centre, (x, y))


def _bearing(
    own: Array,
    of_handle: NDArray[np.bool_],
    around: Array,
    sides: _Sides,
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
