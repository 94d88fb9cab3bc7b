"""The cells of a map made fit for a picture: cut out, shrunk or enlarged."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.messages import frozen
from momantu_skills.navigation.map.maps import GridMap

MARGIN = 0.25
"""Unknown floor that is kept around what is known, m."""
WALL_SHARE = 0.5
"""Share of a pixel's edge in cells that make the pixel a wall: a wall through it is as long as
the edge, and single cells do not fill a small picture."""


def known_window(known: NDArray[np.bool_], resolution: float) -> tuple[slice, slice]:
    """The rows and columns of a raster that hold what is known, with a margin; else all."""
    parts = []
    for axis in (1, 0):
        there = np.flatnonzero(known.any(axis=axis))
        if not len(there):
            return slice(0, known.shape[0]), slice(0, known.shape[1])
        margin = math.ceil(MARGIN / resolution)
        end = min(known.shape[1 - axis], int(there[-1]) + 1 + margin)
        parts.append(slice(max(0, int(there[0]) - margin), end))
    return parts[0], parts[1]


def known_part(grid: GridMap) -> GridMap:
    """The part of a map that is known, with a margin; all of it if nothing is."""
    rows, columns = known_window(grid.cells != UNKNOWN, grid.resolution)
    x, y = grid.origin
    origin = x + columns.start * grid.resolution, y + rows.start * grid.resolution
    return replace(grid, cells=frozen(grid.cells[rows, columns].copy()), origin=origin)


def resampled(cells: NDArray[np.uint8], rows: int, columns: int) -> NDArray[np.uint8]:
    """Cells (n, m) as pixels (rows, columns), of FREE, OCCUPIED and UNKNOWN.

    A pixel of several cells is occupied where a wall crosses it, else free if a part of it is.
    """
    high, wide = cells.shape
    if rows >= high and columns >= wide:
        up, along = (
            (np.arange(many) * few // many) for many, few in ((rows, high), (columns, wide))
        )
        return np.asarray(cells[up[:, None], along[None, :]])
    up, along = (np.arange(many) * few // many for many, few in ((high, rows), (wide, columns)))
    pixel = up[:, None] * columns + along[None, :]

    def count(value: int) -> NDArray[np.int64]:
        there = np.bincount(pixel[cells == value], minlength=rows * columns)
        return np.asarray(there.reshape(rows, columns))

    wall = count(OCCUPIED) >= max(1.0, WALL_SHARE * min(high / rows, wide / columns))
    return np.where(wall, OCCUPIED, np.where(count(FREE) > 0, FREE, UNKNOWN)).astype(np.uint8)
