"""Where a robot can stand and drive in an imported world, on a grid."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sdf.write.indoors import inside

CELL = 0.05
"""m."""
MOST_CELLS = 1500
"""Most cells along one side; larger worlds have larger cells."""
MARGIN = 2.0
"""Margin of floor around everything, m."""
LOWEST, HIGHEST = 0.03, 1.5
"""Range of heights of obstacles for a robot, m."""
EXACT = 0.001
"""Tolerance of heights, m: a slab of exactly the lowest height is driven over."""
WALL = 1.5
"""What is so high may be a wall, m."""
FENCE = 0.3
"""What is so high may fence an arena, where no walls enclose a building, m."""
LEAST_SHARE = 0.5
"""Walls enclose a building if they have at least this share of the widest region within fences."""
SMALLEST = 4.0
"""Least area of a building, m2."""
HALF_WIDTH = 0.35
"""Half the width of a robot that turns on the spot, m."""


@dataclass(frozen=True, eq=False)
class FreeFloor:
    """clearance: (rows, columns) distance to the nearest obstacle, m; row 0 is at the smallest y.

    regions: (rows, columns) number of the connected region; 0: the robot does not fit.
    walls, fences: (rows, columns) whether something as high as a wall, or a fence, stands there.
    """

    origin: tuple[float, float]
    cell: float
    clearance: NDArray[np.float32]
    regions: NDArray[np.int32]
    walls: NDArray[np.bool_]
    fences: NDArray[np.bool_]

    @cached_property
    def _enclosed(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """What encloses, and the cells within: a building, else a fenced arena, else everything.

        Of an arena the pieces that are as high as walls enclose little of where a robot drives.
        """
        building, arena = inside(self.walls), inside(self.fences)
        fenced = self._largest(building) < LEAST_SHARE * self._largest(arena)
        kinds = [(self.walls, building), (self.fences, arena)]
        for enclosing, found in kinds[::-1] if fenced else kinds:
            if float(found.sum()) * self.cell**2 > SMALLEST:
                return enclosing, found
        return self.walls, np.ones_like(self.walls)

    def _largest(self, cells: NDArray[np.bool_]) -> int:
        """Cells of the region that has most of some cells."""
        return int(np.bincount(self.regions[cells], minlength=2)[1:].max())

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Cells within a building, or an arena; all of them where there is none."""
        return self._enclosed[1]

    @cached_property
    def from_walls(self) -> NDArray[np.float32]:
        """(rows, columns) distance to the nearest wall, or fence, m."""
        free = np.where(self._enclosed[0], 0, 255).astype(np.uint8)
        return np.asarray(cv2.distanceTransform(free, cv2.DIST_L2, 5), np.float32) * self.cell

    def index(self, x: float, y: float) -> tuple[int, int] | None:
        """Row and column of a point; None beyond the grid."""
        column = int((x - self.origin[0]) / self.cell)
        row = int((y - self.origin[1]) / self.cell)
        inside = 0 <= row < self.clearance.shape[0] and 0 <= column < self.clearance.shape[1]
        return (row, column) if inside and x >= self.origin[0] and y >= self.origin[1] else None

    def region(self, x: float, y: float) -> int:
        """The region of a point; 0 where the robot does not fit."""
        index = self.index(x, y)
        return 0 if index is None else int(self.regions[index])

    def points(self, mask: NDArray[np.bool_]) -> Array:
        """Middles (n, 2) of cells, m."""
        rows, columns = np.nonzero(mask)
        cells = np.stack([columns, rows], axis=1) + 0.5
        return np.asarray(np.array(self.origin) + cells * self.cell)

    def area(self, region: int) -> float:
        """m2."""
        return float((self.regions == region).sum()) * self.cell**2


def free_floor(hulls: Iterable[Array]) -> FreeFloor:
    """The free floor between convex things, each given by points (n, 3) in the map."""
    obstacles = [h for h in hulls if h[:, 2].max() > LOWEST + EXACT and h[:, 2].min() < HIGHEST]
    footprints = [hull[:, :2] for hull in obstacles]
    everything = np.concatenate(footprints) if footprints else np.zeros((1, 2))
    low, high = everything.min(axis=0) - MARGIN, everything.max(axis=0) + MARGIN
    cell = max(CELL, float((high - low).max()) / MOST_CELLS)
    columns, rows = (int(n) for n in np.ceil((high - low) / cell).astype(int) + 1)
    free = np.full((rows, columns), 255, dtype=np.uint8)
    walls, fences = np.zeros_like(free), np.zeros_like(free)
    for footprint, hull in zip(footprints, obstacles, strict=True):
        around = cv2.convexHull(((footprint - low) / cell).astype(np.float32))
        base, top = np.floor(around).astype(np.int32), float(hull[:, 2].max())
        cv2.fillConvexPoly(free, base, 0)
        if top >= FENCE:
            cv2.fillConvexPoly(fences, base, 1)
        if top >= WALL:
            cv2.fillConvexPoly(walls, base, 1)
    clearance = np.asarray(cv2.distanceTransform(free, cv2.DIST_L2, 5), dtype=np.float32) * cell
    fits = (clearance > HALF_WIDTH).astype(np.uint8)
    _, regions = cv2.connectedComponents(fits, connectivity=4)
    origin = float(low[0]), float(low[1])
    return FreeFloor(origin, cell, clearance, np.asarray(regions), walls > 0, fences > 0)
