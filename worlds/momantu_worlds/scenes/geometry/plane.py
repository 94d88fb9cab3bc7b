"""Rectangles and discs on a floor plan: gaps, coverage, what a disc can get through."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.lazy import lazily

with lazily():
    import cv2
    import shapely


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle around its pose's origin; size: full extent along its own x and y, m."""

    pose: Pose2D
    size: tuple[float, float]

    def corners(self) -> Array:
        """(4, 2), counter-clockwise."""
        x, y = self.size[0] / 2, self.size[1] / 2
        c, s = math.cos(self.pose.yaw), math.sin(self.pose.yaw)
        own = np.array([(x, y), (-x, y), (-x, -y), (x, -y)])
        return np.array(own @ np.array([(c, s), (-s, c)]) + (self.pose.x, self.pose.y))

    def polygon(self) -> shapely.Polygon:
        """As Shapely's polygon, for distances from other shapes."""
        return shapely.polygons(self.corners())

    def distance(self, points: Array) -> Array:
        """Distance of points (..., 2) from the rectangle, 0 inside, m.

        It computes in the rectangle's own frame, for whole grids of cells at once. On a grid, cells
        often lie exactly at a distance; they must count alike wherever the rectangle stands.
        """
        c, s = math.cos(self.pose.yaw), math.sin(self.pose.yaw)
        dx, dy = points[..., 0] - self.pose.x, points[..., 1] - self.pose.y
        out_x = np.maximum(np.abs(c * dx + s * dy) - self.size[0] / 2, 0.0)
        out_y = np.maximum(np.abs(c * dy - s * dx) - self.size[1] / 2, 0.0)
        return np.asarray(np.hypot(out_x, out_y))


def gap(a: Rectangle, b: Rectangle) -> float:
    """Distance between two rectangles, 0 when they touch or overlap, m."""
    return float(shapely.distance(a.polygon(), b.polygon()))


def clear_of(rectangle: Rectangle, others: Iterable[Rectangle], least: float) -> bool:
    """Whether the rectangle touches no other and is at least `least` m from each."""
    reach = math.hypot(*rectangle.size) / 2 + least
    for other in others:
        far = reach + math.hypot(*other.size) / 2
        if rectangle.pose.distance_to(other.pose) < far:
            between = gap(rectangle, other)
            if between == 0.0 or between < least:
                return False
    return True


def convex_outline(points: Array) -> Array:
    """Corners (k, 2) of the convex hull of points (n, 2), counter-clockwise."""
    hull = shapely.orient_polygons(shapely.convex_hull(shapely.multipoints(points)))
    corners: Array = shapely.get_coordinates(hull)
    return corners[:-1] if hull.geom_type == "Polygon" else corners


def slab_outline(points: Array, low: float, high: float) -> Array:
    """Corners (k, 2), from above, of the convex hull of points (n, 3) between two heights.

    The hull must have a part between these heights.
    """
    z = points[:, 2]
    found = [points[(z >= low) & (z <= high), :2]]
    for height in {low, high}:
        below, above = points[z < height], points[z > height]
        if len(below) and len(above):
            share = (height - below[:, None, 2]) / (above[None, :, 2] - below[:, None, 2])
            cut = below[:, None, :2] + share[..., None] * (above[None, :, :2] - below[:, None, :2])
            found.append(cut.reshape(-1, 2))
    return convex_outline(np.concatenate(found))


def in_outline(points: Array, corners: Array) -> NDArray[np.bool_]:
    """Which of points (..., 2) lie within a simple polygon (n, 2)."""
    polygon = shapely.Polygon(corners)
    inside: NDArray[np.bool_] = shapely.contains_xy(polygon, points[..., 0], points[..., 1])
    return inside


@dataclass(frozen=True, slots=True)
class Passages:
    """The cells of a floor plan where a disc's centre may be, and paths over them.

    origin: of cell [0, 0]'s centre, m. cell: m. free: (rows along y, columns along x).
    """

    origin: tuple[float, float]
    cell: float
    free: NDArray[np.bool_]

    def reachable(self, start: tuple[float, float]) -> NDArray[np.bool_]:
        """Cells that the disc reaches from a point, by steps to four neighbours."""
        _, region = cv2.connectedComponents(self.free.astype(np.uint8), connectivity=4)
        here = region[self.index(start)]
        reached: NDArray[np.bool_] = (region == here) & (here != 0)
        return reached

    def nearest_free(self, point: tuple[float, float]) -> tuple[float, float]:
        """Centre of the free cell nearest to a point, m; ValueError when no cell is free."""
        rows, columns = np.nonzero(self.free)
        if len(rows) == 0:
            raise ValueError("no cell is free")
        x, y = self.origin[0] + self.cell * columns, self.origin[1] + self.cell * rows
        best = int(np.argmin(np.hypot(x - point[0], y - point[1])))
        return float(x[best]), float(y[best])

    def route(self, start: tuple[float, float], end: tuple[float, float]) -> Array:
        """Cell centres (n, 2) of a shortest path between two free points; (0, 2) if there is none.

        Breadth first, by steps to four neighbours.
        """
        columns = self.free.shape[1]
        flat = self.free.ravel().tolist()
        (row, column), (end_row, end_column) = self.index(start), self.index(end)
        first, last = row * columns + column, end_row * columns + end_column
        came = {first: first}
        queue = deque([first] if flat[first] else [])
        while queue and last not in came:
            at = queue.popleft()
            for after in (at + 1, at - 1, at + columns, at - columns):
                if flat[after] and after not in came:
                    came[after] = at
                    queue.append(after)
        if last not in came:
            return np.zeros((0, 2))
        cells = [last]
        while cells[-1] != first:
            cells.append(came[cells[-1]])
        back = np.array(cells[::-1])
        return np.column_stack([back % columns, back // columns]) * self.cell + self.origin

    def index(self, point: tuple[float, float]) -> tuple[int, int]:
        """(row, column) of the cell that holds a point."""
        column = round((point[0] - self.origin[0]) / self.cell)
        row = round((point[1] - self.origin[1]) / self.cell)
        return row, column


def passages(
    obstacles: Iterable[Rectangle],
    center: tuple[float, float],
    size: tuple[float, float],
    radius: float,
    cell: float = 0.1,
) -> Passages:
    """The free cells of a disc of `radius` m among obstacles, in an area with a closed border."""
    columns, rows = round(size[0] / cell), round(size[1] / cell)
    origin = (center[0] - size[0] / 2 + cell / 2, center[1] - size[1] / 2 + cell / 2)
    xs, ys = origin[0] + cell * np.arange(columns), origin[1] + cell * np.arange(rows)
    free = np.ones((rows, columns), dtype=np.bool_)
    for rectangle in obstacles:
        low = rectangle.corners().min(axis=0) - radius
        high = rectangle.corners().max(axis=0) + radius
        i = slice(int(np.searchsorted(xs, low[0])), int(np.searchsorted(xs, high[0], "right")))
        j = slice(int(np.searchsorted(ys, low[1])), int(np.searchsorted(ys, high[1], "right")))
        points = np.stack(np.meshgrid(xs[i], ys[j]), axis=-1)
        free[j, i] &= rectangle.distance(points) >= radius
    free[[0, -1], :] = False
    free[:, [0, -1]] = False
    return Passages(origin, cell, free)
