"""The site's floor plan as a grid of cells in map coordinates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats import maps
from momantu_bt.geometry import Array
from momantu_bt.messages import frozen


@dataclass(frozen=True, slots=True, eq=False)
class GridMap:
    """A floor plan: `cells[row, column]` is FREE, OCCUPIED or UNKNOWN.

    cells: (rows, columns) uint8, row 0 at the smallest y. resolution: m per cell.
    origin: map coordinates (x, y) of the lower left corner of cell (0, 0), m.
    """

    cells: NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float]

    @classmethod
    def of(cls, picture: maps.MapPicture) -> GridMap:
        """The floor plan that a map's files hold."""
        return cls(frozen(picture.cells()), picture.resolution, picture.origin)

    @property
    def size(self) -> tuple[float, float]:
        """Extent (x, y) in m."""
        rows, columns = self.cells.shape
        return columns * self.resolution, rows * self.resolution

    @property
    def free_area(self) -> float:
        """Square metres of free cells."""
        return float((self.cells == maps.FREE).sum() * self.resolution**2)

    def index(self, x: float, y: float) -> tuple[int, int]:
        """(row, column) of the cell at map coordinates; may lie outside the grid."""
        return (
            math.floor((y - self.origin[1]) / self.resolution),
            math.floor((x - self.origin[0]) / self.resolution),
        )

    def centre(self, row: int, column: int) -> tuple[float, float]:
        """Map coordinates (x, y) of a cell's centre, m."""
        x, y = self.origin
        return x + (column + 0.5) * self.resolution, y + (row + 0.5) * self.resolution

    def beside(self, value: int) -> NDArray[np.bool_]:
        """The cells (rows, columns) that share an edge with one of this value."""
        there = np.pad(self.cells == value, 1)
        sides = there[:-2, 1:-1] | there[2:, 1:-1] | there[1:-1, :-2] | there[1:-1, 2:]
        return np.asarray(sides)

    def contains(self, x: float, y: float) -> bool:
        """Whether map coordinates lie on the grid."""
        row, column = self.index(x, y)
        rows, columns = self.cells.shape
        return bool(0 <= row < rows and 0 <= column < columns)

    def centers(self, mask: NDArray[np.bool_]) -> Array:
        """Map coordinates (n, 2) of the centres of the cells where `mask` holds, row by row."""
        rows, columns = np.nonzero(mask)
        middle = np.stack([columns, rows], axis=1) + 0.5
        return np.asarray(middle * self.resolution + np.array(self.origin))


def read_grid(path: Path) -> GridMap:
    """Read the map that a map_server YAML file describes.

    Raises:
        MapError: a file is missing or broken; the message says which, where and what is valid.
    """
    return _read_grid(path.resolve())


@lru_cache(maxsize=8)
def _read_grid(path: Path) -> GridMap:
    return GridMap.of(maps.read_map(path))


def overlaid(layer: GridMap, grid: GridMap) -> NDArray[np.bool_]:
    """The occupied cells of `layer` in the raster of `grid`: (rows, columns) of `grid`."""
    blocked = np.zeros(grid.cells.shape, dtype=np.bool_)
    points = layer.centers(layer.cells == maps.OCCUPIED)
    cells = np.floor((points - np.array(grid.origin)) / grid.resolution).astype(np.int64)
    rows, columns = grid.cells.shape
    inside = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
    blocked[cells[inside, 1], cells[inside, 0]] = True
    return blocked
