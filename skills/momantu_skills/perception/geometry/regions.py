"""Convex regions of the floor with a range of heights, and plane geometry around them."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.frames import MAP, ODOM, FrameBuffer
from momantu_bt.geometry import Array
from momantu_bt.world import Surface

cv2.setNumThreads(1)

BESIDE = 0.20
"""Largest horizontal error of a surface's believed position, m: 0.10 m of its own, plus
localization."""
HEIGHT_ERROR = 0.12
"""Largest error of its height, m: 0.03 m of its own, the camera's mounting, and inaccurate
measurement by a person. The largest level surface in that range is taken."""
HEADROOM = 0.55
"""Height above a surface within which objects stand on it, m."""
WIDE = 0.30
"""Distance to each side of a place over which its views are spread, m."""
PATCH = 0.60
"""Radius around a place within which its surface and objects matter to the hand, m."""
PLACE_ERROR = 0.03
"""Largest height difference between a measured place and its surface, m."""


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """outline: (k, 2) convex, counter-clockwise, odom, m. low, high: heights, m."""

    outline: Array
    low: float
    high: float

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """(n,) bool: which points (n, 3) in odom lie inside."""
        inside = (points[:, 2] >= self.low) & (points[:, 2] <= self.high)
        candidates = np.nonzero(inside)[0]
        inside[candidates] = depth_inside(points[candidates, :2], self.outline) >= 0.0
        return inside


def depth_inside(points: Array, outline: Array) -> Array:
    """Distance (n,) in m of points (n, 2) to the nearest edge line of a convex outline (k, 2).

    Positive inside, negative outside. Beyond a corner it is the distance to the lines through the
    edges, a lower bound of the distance to the outline.
    """
    depth = np.full(len(points), np.inf)
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        if length < 1e-9:
            continue
        inward = np.array([-along[1], along[0]]) / length
        np.minimum(depth, points @ inward - float(start @ inward), out=depth)
    return depth


def grown(outline: Array, by: float) -> Array:
    """A convex outline (k, 2) whose edges are moved outwards by `by` m (corners are mitred)."""
    edges = np.roll(outline, -1, axis=0) - outline
    outward = np.column_stack([edges[:, 1], -edges[:, 0]])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    corners = []
    for here, before in zip(outward, np.roll(outward, 1, axis=0), strict=True):
        corners.append((here + before) / (1.0 + float(here @ before)))
    return np.asarray(outline + by * np.array(corners))


def convex_hull(points: Array) -> Array:
    """(k, 2) counter-clockwise hull of points (n, 2), n > 0."""
    index = cv2.convexHull(points.astype(np.float32), clockwise=False, returnPoints=False)
    return np.asarray(points[index[:, 0]])


def surface_corners(surface: Surface, frames: FrameBuffer) -> Array:
    """Corners (4, 3) in odom, m, of a site's surface, by the current localization."""
    half_x, half_y = surface.size[0] / 2, surface.size[1] / 2
    flat = np.array(
        [[-half_x, -half_y, 0], [half_x, -half_y, 0], [half_x, half_y, 0], [-half_x, half_y, 0]]
    )
    in_map = surface.map_from_surface.transform(surface.height)
    return (frames.lookup(ODOM, MAP) @ in_map).apply(flat)


def disc(centre: Array, radius: float, corners: int = 16) -> Array:
    """Outline (corners, 2) of a regular polygon around a point (2,), counter-clockwise."""
    angles = 2 * np.pi * np.arange(corners) / corners
    return np.asarray(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceRegion(Region):
    """The region that is searched for a surface and its objects.

    support_heights: (lowest, highest) z of the surface itself in odom, m.
    """

    support_heights: tuple[float, float]


def surface_region(corners: Array) -> SurfaceRegion:
    """The region around a surface whose corners (4, 3) in odom are roughly known."""
    height = float(corners[:, 2].mean())
    low, high = height - HEIGHT_ERROR, height + HEIGHT_ERROR
    return SurfaceRegion(grown(corners[:, :2], BESIDE), low, high + HEADROOM, (low, high))


def place_region(near: Array) -> tuple[Array, SurfaceRegion]:
    """Corners to view (4, 3), and the region for points, around a place (3,) in odom."""
    square = WIDE * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = np.column_stack([near[:2] + square, np.full(4, near[2])])
    low, high = float(near[2]) - PLACE_ERROR, float(near[2]) + PLACE_ERROR
    outline = disc(near[:2], PATCH)
    return corners, SurfaceRegion(outline, low, high + HEADROOM, (low, high))
