"""One scan made ready for matching: its end points, and the directions of the surfaces there."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.navigation.map.sensing import Rays

NEIGHBOURS = 4
"""Beams on each side whose end points make the line of a surface."""
GAP = 0.35
"""Distance above which a neighbour belongs to another surface, m."""
FLAT = 0.15
"""Largest ratio of the variances across and along a line."""


@dataclass(frozen=True, slots=True, eq=False)
class ScanPoints:
    """A scan in base, m.

    points: (n, 2). normals: (n, 2) unit vectors towards the sensor; zero where the surface has no
    direction.
    """

    points: Array
    normals: Array

    @classmethod
    def from_rays(cls, rays: Rays, longest: float) -> ScanPoints:
        """The hits of a scan at most `longest` m away."""
        near = rays.hit & (rays.ranges <= longest)
        ends = rays.origin + rays.directions[near] * rays.ranges[near, None]
        points = np.ascontiguousarray(ends, dtype=np.float64)
        return cls(points, _normals(points, rays.origin.astype(np.float64)))


@numba.njit(cache=True)
def _normals(points: Array, origin: Array) -> Array:
    """The direction of least variance of each point's neighbours along the scan."""
    n = points.shape[0]
    normals = np.zeros((n, 2))
    for i in range(n):
        count = 0
        mx = my = xx = xy = yy = 0.0
        for j in range(max(0, i - NEIGHBOURS), min(n, i + NEIGHBOURS + 1)):
            dx = points[j, 0] - points[i, 0]
            dy = points[j, 1] - points[i, 1]
            if math.hypot(dx, dy) > GAP:
                continue
            count += 1
            mx += dx
            my += dy
            xx += dx * dx
            xy += dx * dy
            yy += dy * dy
        if count < 3:
            continue
        a = xx / count - (mx / count) ** 2
        b = xy / count - mx * my / count**2
        c = yy / count - (my / count) ** 2
        root = math.sqrt(max((a - c) ** 2 / 4 + b * b, 0.0))
        along = (a + c) / 2 + root
        across = (a + c) / 2 - root
        if along < 1e-8 or across > FLAT * along:
            continue
        angle = 0.5 * math.atan2(2 * b, a - c) + math.pi / 2
        nx = math.cos(angle)
        ny = math.sin(angle)
        if nx * (points[i, 0] - origin[0]) + ny * (points[i, 1] - origin[1]) > 0.0:
            nx = -nx
            ny = -ny
        normals[i, 0] = nx
        normals[i, 1] = ny
    return normals
