"""The smallest rectangle around points projected onto the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.perception.geometry.regions import convex_hull

NEAR = 0.008
"""Distance from a side within which points of a face are used to fit that side, m."""
CORNER = 0.005
"""Distance from the corners within which a point may belong to either face, m."""
LEAST_FACE = 20
"""Fewest points for fitting a side."""
TRIM = 1.0
"""Per cent of the points removed at each side: because of noise the outermost ones lie outside."""


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle:
    """centre: (2,) m. yaw: of its first side in rad, in [-pi/4, pi/4). size: (2,) m."""

    centre: Array
    yaw: float
    size: Array

    def distances(self, points: Array) -> Array:
        """(n,) distance of points (n, 2) to the rectangle's boundary, m."""
        own = np.abs((points - self.centre) @ _axes(self.yaw))
        outside = own - self.size / 2
        beyond = np.linalg.norm(np.maximum(outside, 0.0), axis=1)
        return np.asarray(np.where((outside <= 0).all(axis=1), -outside.max(axis=1), beyond))

    def outside(self, points: Array) -> Array:
        """(n,) how far points (n, 2) lie outside, 0 within, m."""
        own = np.abs((points - self.centre) @ _axes(self.yaw)) - self.size / 2
        return np.asarray(np.linalg.norm(np.maximum(own, 0.0), axis=1))


def smallest_rectangle(points: Array) -> Rectangle:
    """The rectangle of least area around points (n, 2), then reduced by TRIM.

    (Freeman and Shapira 1975: the smallest rectangle has one side parallel to an edge of the hull.)
    """
    hull = convex_hull(points)
    if len(hull) < 3:
        low, high = points.min(axis=0), points.max(axis=0)
        return Rectangle((low + high) / 2, 0.0, high - low)
    edges = np.roll(hull, -1, axis=0) - hull
    angles = np.unique(np.round(np.arctan2(edges[:, 1], edges[:, 0]) % (math.pi / 2), 3))
    areas = [float(np.ptp(hull @ _axes(float(angle)), axis=0).prod()) for angle in angles]
    yaw = float(angles[int(np.argmin(areas))])
    return _rectangle(yaw, *_span(points, yaw))


def rectangle_at(points: Array, yaw: float) -> Rectangle:
    """The smallest rectangle around points (n, 2) with a side at a yaw, rad, reduced by TRIM."""
    return _rectangle(yaw, *_span(points, yaw))


def fitted_to(rectangle: Rectangle, points: Array, faces: Array) -> Rectangle:
    """Rotate the rectangle and move its sides to fit points (n, 2) on faces (m, 2).

    The outermost points are outermost because of noise, while the mean of a face is accurate. The
    side with the most points determines the rotation; sides without points stay at the extreme of
    all points. Opposite a face it is the extreme of the points beyond that face: of a box that is
    seen from a little above its top, a tenth of the points lie there, and `TRIM` of all would take
    much of them.
    """
    turn = _turn_of_fullest_side(rectangle, faces)
    yaw = rectangle.yaw + turn
    low, high = _span(points, yaw)
    own = faces @ _axes(yaw)
    for axis in (0, 1):
        other = 1 - axis
        between = (own[:, other] > low[other] + CORNER) & (own[:, other] < high[other] - CORNER)
        faced = []
        for limits in (low, high):
            face = own[between & (np.abs(own[:, axis] - limits[axis]) < NEAR), axis]
            faced.append(len(face) >= LEAST_FACE)
            if faced[-1]:
                limits[axis] = np.median(face)
        if faced in ([True, False], [False, True]):
            _widen(low, high, axis, points @ _axes(yaw), upwards=faced[0])
    return _rectangle(yaw, low, high)


def _widen(low: Array, high: Array, axis: int, own: Array, *, upwards: bool) -> None:
    """Move the far limit of an axis to the extreme of the points (n, 2) beyond the near face."""
    along = own[:, axis]
    if upwards and len(beyond := along[along > low[axis] + NEAR]) >= LEAST_FACE:
        high[axis] = max(high[axis], np.percentile(beyond, 100.0 - TRIM))
    elif not upwards and len(beyond := along[along < high[axis] - NEAR]) >= LEAST_FACE:
        low[axis] = min(low[axis], np.percentile(beyond, TRIM))


def _turn_of_fullest_side(rectangle: Rectangle, faces: Array) -> float:
    """Angle in rad between the side with the most points and the line through them."""
    own = (faces - rectangle.centre) @ _axes(rectangle.yaw)
    best, turn = LEAST_FACE, 0.0
    for axis in (0, 1):
        half = rectangle.size / 2
        between = np.abs(own[:, 1 - axis]) < half[1 - axis] - CORNER
        for sign in (-1.0, 1.0):
            face = own[between & (np.abs(sign * own[:, axis] - half[axis]) < NEAR)]
            if len(face) <= best or half[1 - axis] < 2 * NEAR:
                continue
            best, along = len(face), face[:, 1 - axis] - face[:, 1 - axis].mean()
            slope = float(along @ face[:, axis]) / max(float(along @ along), 1e-9)
            turn = math.atan(slope) * (1.0 if axis == 1 else -1.0)
    return turn


def _rectangle(yaw: float, low: Array, high: Array) -> Rectangle:
    """Rectangle from limits (2,) along its own axes, with its yaw moved into [-pi/4, pi/4)."""
    size, centre = high - low, _axes(yaw) @ ((low + high) / 2)
    if yaw < -math.pi / 4:
        yaw, size = yaw + math.pi / 2, size[::-1]
    if yaw >= math.pi / 4:
        yaw, size = yaw - math.pi / 2, size[::-1]
    return Rectangle(centre, yaw, size)


def _span(points: Array, yaw: float) -> tuple[Array, Array]:
    own = points @ _axes(yaw)
    low, high = np.percentile(own, [TRIM, 100.0 - TRIM], axis=0)
    return low, high


def _axes(yaw: float) -> Array:
    """Columns are the rectangle's axes."""
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s], [s, c]])
