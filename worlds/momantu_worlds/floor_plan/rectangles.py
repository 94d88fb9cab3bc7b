"""The occupied cells of a map as few rectangles."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray


class Rectangle(NamedTuple):
    """Cells `row:row_end`, `column:column_end`."""

    row: int
    column: int
    row_end: int
    column_end: int

    @property
    def cells(self) -> int:
        """How many cells it covers."""
        return (self.row_end - self.row) * (self.column_end - self.column)


def without_specks(occupied: NDArray[np.bool_], least: int) -> tuple[NDArray[np.bool_], int]:
    """Occupied cells without connected groups of fewer than `least`, and how many groups went."""
    groups, labels, stats, _ = cv2.connectedComponentsWithStats(
        occupied.astype(np.uint8), connectivity=8
    )
    large = stats[:, cv2.CC_STAT_AREA] >= least
    large[0] = False  # what is not occupied
    return np.asarray(large[labels]), groups - 1 - int(large.sum())


def rectangles(occupied: NDArray[np.bool_]) -> list[Rectangle]:
    """Rectangles that cover the occupied cells (rows, columns) exactly, each cell once.

    Greedy: from each first uncovered cell, the larger of the rectangle that is as wide as possible
    and the one that is as tall as possible.
    """
    left, found = occupied.copy(), []
    for row, column in np.argwhere(occupied):
        if not left[row, column]:
            continue
        wide = _grown(left, int(row), int(column))
        tall = _grown(left.T, int(column), int(row))
        tall = Rectangle(tall.column, tall.row, tall.column_end, tall.row_end)
        best = max(wide, tall, key=lambda each: each.cells)
        left[best.row : best.row_end, best.column : best.column_end] = False
        found.append(best)
    return found


def _grown(free: NDArray[np.bool_], row: int, column: int) -> Rectangle:
    """The widest run of cells from a cell, then as many rows as it reaches down."""
    width = _run(free[row, column:])
    height = _run(np.logical_and.reduce(free[row:, column : column + width], axis=1))
    return Rectangle(row, column, row + height, column + width)


def _run(values: NDArray[np.bool_]) -> int:
    """How many true values stand at the beginning."""
    return int(values.size if values.all() else values.argmin())
