"""The smallest rectangle around points of the floor plan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.perception.regions import convex_hull

TRIM = 1.0
"""Per cent of the points cut off at each side: noise makes the outermost ones lie outside."""


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
        return np.where((outside <= 0).all(axis=1), -outside.max(axis=1), beyond)


def smallest_rectangle(points: Array) -> Rectangle:
    """The rectangle of least area around points (n, 2), up to TRIM; a side lies along a hull edge.

    (Freeman and Shapira 1975: the smallest rectangle shares an edge's direction with the hull.)
    """
    hull = convex_hull(points)
    if len(hull) < 3:
        low, high = points.min(axis=0), points.max(axis=0)
        return Rectangle((low + high) / 2, 0.0, high - low)
    edges = np.roll(hull, -1, axis=0) - hull
    angles = np.unique(np.round(np.arctan2(edges[:, 1], edges[:, 0]) % (math.pi / 2), 3))
    spans = [_span(points, float(angle)) for angle in angles]
    areas = [float((high - low).prod()) for low, high in spans]
    best = int(np.argmin(areas))
    low, high = spans[best]
    yaw, size, centre = float(angles[best]), high - low, (low + high) / 2
    centre = _axes(yaw) @ centre
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
