"""One of two maps that are compared: its surfaces, and how far other points are from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, map_coordinates, minimum_filter

from momantu_bt.formats.maps import OCCUPIED, UNKNOWN
from momantu_bt.geometry import Array
from momantu_skills.navigation.map.fields import clearance
from momantu_skills.navigation.map.maps import GridMap

FAR = 1e3
"""The distance of what lies beside the map, m."""


@dataclass(frozen=True, eq=False)
class Side:
    """A map, and what is looked up in it."""

    grid: GridMap

    @cached_property
    def surface(self) -> NDArray[np.bool_]:
        """Occupied cells (rows, columns) that border on others: what a laser sees of a wall."""
        occupied = self.grid.cells == OCCUPIED
        within = minimum_filter(occupied, size=3, mode="constant", cval=0)
        return np.asarray(occupied & ~within)

    @cached_property
    def points(self) -> Array:
        """The middles (n, 2) of surface cells, map, m."""
        return self.grid.centers(self.surface)

    @cached_property
    def _to_middles(self) -> Array:
        outside = np.asarray(self.grid.cells != OCCUPIED)
        return np.asarray(distance_transform_edt(outside) * self.grid.resolution)

    @cached_property
    def _to_faces(self) -> NDArray[np.float32]:
        return clearance(self.grid.cells == OCCUPIED, self.grid.resolution)

    def from_middles(self, points: Array) -> Array:
        """Distances (n,) of points (n, 2) to the middle of the nearest occupied cell, m; smooth."""
        return self._looked_up(self._to_middles, points, order=1)

    def from_faces(self, points: Array) -> Array:
        """Distances (n,) of points (n, 2) to the nearest occupied cell, m; 0 inside."""
        return self._looked_up(self._to_faces, points, order=1)

    def cells_at(self, points: Array) -> NDArray[np.uint8]:
        """The cells (n,) in which points (n, 2) lie; UNKNOWN beside the map."""
        column, row = np.floor(self._indices(points)).astype(np.int64)
        rows, columns = self.grid.cells.shape
        there = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        found = np.full(len(points), UNKNOWN, dtype=np.uint8)
        found[there] = self.grid.cells[row[there], column[there]]
        return found

    def _indices(self, points: Array) -> Array:
        """(column, row) (2, n), fractional, from the lower left corner of the first cell."""
        return np.asarray((points - np.array(self.grid.origin)).T / self.grid.resolution)

    def _looked_up(self, field: NDArray[np.floating], points: Array, order: int) -> Array:
        column, row = self._indices(points) - 0.5
        found = map_coordinates(
            field.astype(np.float64), [row, column], order=order, mode="constant", cval=FAR
        )
        return np.asarray(found, dtype=np.float64)
