"""The floor of an episode: how far each point is from all obstacles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.convex import Convex

CELL = 0.02
"""Cell size of the grid, m; free spots are known to about 1.5 cm."""
MOST_CELLS = 4_000_000
"""Most cells; a larger floor gets larger cells."""
DOORSTEP = 0.03
"""Height below which a robot drives over a part, m."""
FRACTION_BITS = 4
"""Outlines are drawn with a precision of a sixteenth of a cell."""

Point = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A part of a body as an obstacle for the base. outline: (n, 2) convex, on the floor plan."""

    body: str
    outline: Array

    def distance(self, point: Point) -> float:
        """From a point, m; below 0 inside."""
        polygon = self.outline.astype(np.float32)[:, None]
        return -float(cv2.pointPolygonTest(polygon, (float(point[0]), float(point[1])), True))

    def depth(self, polygon: Array) -> float:
        """How deep it overlaps a convex polygon (n, 2), by the separating axis theorem; m."""
        axes = np.concatenate([_normals(self.outline), _normals(polygon)])
        ours, theirs = self.outline @ axes.T, polygon @ axes.T
        overlap = np.minimum(
            ours.max(axis=0) - theirs.min(axis=0), theirs.max(axis=0) - ours.min(axis=0)
        )
        return max(0.0, float(overlap.min()))


def obstacle(body: str, solid: Convex, ceiling: float) -> Obstacle | None:
    """A solid as an obstacle for a robot `ceiling` m high; None if it drives over or below it."""
    low, high = solid.box
    if high[2] <= DOORSTEP or low[2] >= ceiling:
        return None
    around = cv2.convexHull(solid.vertices[:, :2].astype(np.float32))[:, 0]
    return Obstacle(body, around.astype(np.float64)) if len(around) > 2 else None


class Ground:
    """A grid over the floor; its border is closed."""

    def __init__(
        self,
        obstacles: Iterable[Obstacle],
        low: Array,
        high: Array,
        zones: Iterable[Obstacle] = (),
    ) -> None:
        """low, high: the corners (2,) of the area, m. zones: simple polygons, convex or not."""
        kept_out = tuple(zones)
        self.obstacles = (*obstacles, *kept_out)
        extent = np.maximum(high - low, 1.0)
        self.cell = max(CELL, math.sqrt(float(extent.prod()) / MOST_CELLS))
        self.low = low
        columns, rows = (int(n) for n in np.ceil(extent / self.cell))
        free = np.full((rows, columns), 255, dtype=np.uint8)
        for each in self.obstacles:
            points = np.round(((each.outline - low) / self.cell - 0.5) * 2**FRACTION_BITS)
            drawn = points.astype(np.int32)
            if each in kept_out:
                cv2.fillPoly(free, [drawn], 0, shift=FRACTION_BITS)
            else:
                cv2.fillConvexPoly(free, drawn, 0, shift=FRACTION_BITS)
        free[[0, -1], :] = 0
        free[:, [0, -1]] = 0
        self.clearance: NDArray[np.float32] = self.cell * cv2.distanceTransform(
            free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE
        )
        """(rows along y, columns along x) m; distance of a cell's centre from what is nearest."""

    def free(self, radius: float) -> NDArray[np.bool_]:
        """Where the centre of a disc may be; rounding to the grid favours the disc."""
        return np.asarray(self.clearance >= max(self.cell / 2, radius - self.cell))

    def reached(self, start: Point, radius: float) -> NDArray[np.bool_]:
        """Cells that a disc reaches from a point, or from the nearest free cell in its radius."""
        free = self.free(radius)
        _, regions = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
        near = np.where(free, self._distances(start), np.inf)
        first = int(near.argmin())
        if not near.flat[first] <= max(radius, self.cell):
            return np.zeros_like(free)
        return np.asarray(regions == regions.flat[first])

    def room_at(self, point: Point, around: float = 0.0) -> float:
        """Clearance at a point, or the greatest within `around` m of it; 0 off the grid."""
        column, row = np.floor((np.asarray(point) - self.low) / self.cell).astype(int)
        reach = math.ceil(around / self.cell)
        rows, columns = self.clearance.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return 0.0
        window = self.clearance[
            max(0, row - reach) : row + reach + 1, max(0, column - reach) : column + reach + 1
        ]
        return float(window.max())

    def at(self, mask: NDArray[np.bool_], point: Point) -> bool:
        """Whether the cell of a point is in a mask."""
        column, row = np.floor((np.asarray(point) - self.low) / self.cell).astype(int)
        rows, columns = mask.shape
        return bool(0 <= row < rows and 0 <= column < columns and mask[row, column])

    def centres(self, mask: NDArray[np.bool_], point: Array, distance: float) -> Array:
        """Centres (n, 2) of a mask's cells within `distance` m of a point, along x and along y."""
        first = np.maximum(np.floor((point[:2] - distance - self.low) / self.cell).astype(int), 0)
        last = np.maximum(np.ceil((point[:2] + distance - self.low) / self.cell).astype(int), 0)
        rows, columns = np.nonzero(mask[first[1] : last[1], first[0] : last[0]])
        cells = np.column_stack([columns + first[0], rows + first[1]])
        return np.asarray(self.low + self.cell * (cells + 0.5))

    def blocking(self, point: Point, but: Callable[[str], bool] = lambda body: False) -> str:
        """The body that is nearest to a point or contains it; "" if there is none."""
        near = [(each.distance(point), each.body) for each in self.obstacles if not but(each.body)]
        return min(near)[1] if near else ""

    def _distances(self, point: Point) -> Array:
        rows, columns = self.clearance.shape
        x = self.low[0] + self.cell * (np.arange(columns) + 0.5) - point[0]
        y = self.low[1] + self.cell * (np.arange(rows) + 0.5) - point[1]
        return np.asarray(np.hypot(x[None], y[:, None]))


def _normals(polygon: Array) -> Array:
    edges = np.roll(polygon, -1, axis=0) - polygon
    edges = edges[np.hypot(edges[:, 0], edges[:, 1]) > 0]
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))
