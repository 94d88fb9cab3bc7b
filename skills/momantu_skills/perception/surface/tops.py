"""Tops of tables among the points of several views, and which of them is the one that is meant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.detector import View
from momantu_bt.geometry import Array, Pose2D, Transform, wrap_angle
from momantu_bt.world import Surface
from momantu_skills.perception.geometry.grids import Grid, closed, largest_component, opened
from momantu_skills.perception.geometry.rectangles import TRIM, smallest_rectangle
from momantu_skills.perception.surface.planes import PlaneConfig, find_plane

PLANE = PlaneConfig(inlier=0.015, cell=0.03)
"""Tops are seen from farther away here than objects are."""
MOST = 6
"""Most level patches that are looked at."""
THIN = 2
"""Patches at most twice this many cells wide are edges of walls and the like, not tops."""
LEAST = 0.10
"""Least visible area of a top, m2."""
EVEN = 0.01
"""Edge of the cells of which one point each tells how far a top reaches, m."""
FILLED = 0.55
"""Least share of its rectangle that is seen of a whole top; what stands on it hides the rest."""
UPRIGHT_CELL, UPRIGHT = 0.05, 0.10
"""Edge of a part of the floor, and the height above it that only uprights have there, m."""
ALIKE = 0.09
"""Largest difference between a measured and a told edge of one top, m."""


@dataclass(frozen=True, slots=True, eq=False)
class Top:
    """A level patch, as a rectangle.

    pose: of its middle, in the frame of the points, along its first edge. size: (2,) m. height: m.
    area: what is seen of it, m2.
    """

    pose: Pose2D
    size: tuple[float, float]
    height: float
    area: float

    @property
    def filled(self) -> float:
        """The share of the rectangle that is seen."""
        return self.area / max(self.size[0] * self.size[1], 1e-9)


def tops_among(points: Array, low: float, high: float) -> list[Top]:
    """The level patches between two heights (m) among points (n, 3), those with most area first."""
    found: list[Top] = []
    for _ in range(MOST):
        plane = find_plane(points, low, high, PLANE)
        if plane is None:
            break
        top = _top(points[plane.inliers][:, :2], plane.height)
        if top is not None:
            found.append(top)
        points = points[~plane.inliers]
    return sorted(found, key=lambda top: -top.area)


def tops_in(views: Sequence[View], map_from_odom: Transform, low: float, high: float) -> list[Top]:
    """The level patches between two heights (m) that views show in a room, in the map."""
    points = np.concatenate([view.points for view in views])
    return tops_among(map_from_odom.apply(without_uprights(points)), low, high)


def without_uprights(points: Array) -> Array:
    """Points (n, 3) without those on walls, sides and legs: where little floor has much height.

    A level top covers each part of the floor at one height. Of a room full of walls only tops are
    left to be found then.
    """
    if not len(points):
        return points
    grid = Grid.over(points[:, :2], UPRIGHT_CELL)
    cells = grid.cells(points[:, :2])
    size = grid.shape[0] * grid.shape[1]
    low, high = np.full(size, np.inf), np.full(size, -np.inf)
    np.minimum.at(low, cells, points[:, 2])
    np.maximum.at(high, cells, points[:, 2])
    return np.asarray(points[(high - low)[cells] < UPRIGHT])


def _top(flat: Array, height: float) -> Top | None:
    """The rectangle around the widest part of a patch (n, 2); None if it is too small or thin."""
    grid = Grid.over(flat, PLANE.cell)
    wide = opened(closed(grid.counts(flat) > 0, 1), THIN)
    wide = largest_component(wide)
    area = float(wide.sum()) * PLANE.cell**2
    if area < LEAST:
        return None
    around = smallest_rectangle(_even(flat[wide.ravel()[grid.cells(flat)]]))
    x, y = (float(v) for v in around.centre)
    whole = around.size / (1.0 - 2.0 * TRIM / 100.0)
    size = float(whole[0]), float(whole[1])
    return Top(Pose2D(x, y, around.yaw), size, height, min(area, size[0] * size[1]))


def _even(flat: Array) -> Array:
    """One of the points (n, 2) in each cell: near ones are denser, and would outweigh far edges.

    The rectangle around them leaves out a share of them at each side, for the noise; of an even
    patch that is the same share of its edge.
    """
    cells = np.floor(flat / EVEN).astype(np.int64)
    return np.asarray(flat[np.unique(cells, axis=0, return_index=True)[1]])


def is_whole(top: Top, surface: Surface) -> bool:
    """Whether a patch has the size of a whole surface."""
    return top.filled >= FILLED and any(
        max(abs(a - b) for a, b in zip(top.size, told, strict=True)) <= ALIKE
        for told in (surface.size, surface.size[::-1])
    )


def may_be_part(top: Top, surface: Surface) -> bool:
    """Whether a patch is no larger than a surface, so that it may be a part of it."""
    small, large = sorted(top.size)
    least, most = sorted(surface.size)
    return small <= least + ALIKE and large <= most + ALIKE


def turned_as(top: Top, surface: Surface, yaw: float) -> Pose2D:
    """The pose of a whole top, with the surface's axes; of those possible the nearest to `yaw`."""
    poses: list[Pose2D] = []
    for quarter in range(4):
        size = top.size if quarter % 2 == 0 else top.size[::-1]
        if max(abs(a - b) for a, b in zip(size, surface.size, strict=True)) <= ALIKE:
            turned = wrap_angle(top.pose.yaw + quarter * math.pi / 2)
            poses.append(Pose2D(top.pose.x, top.pose.y, turned))
    return min(poses, key=lambda pose: abs(wrap_angle(pose.yaw - yaw)))


def nearest(tops: Sequence[Top], to: Pose2D) -> Top | None:
    """The top whose middle is nearest to a pose."""
    return min(tops, key=lambda top: top.pose.distance_to(to), default=None)
