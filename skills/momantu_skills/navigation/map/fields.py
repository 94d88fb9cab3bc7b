"""Distance fields over a grid, and their bilinear lookup."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float32]


def clearance(blocked: NDArray[np.bool_], resolution: float) -> Field:
    """Distance in m from each cell's centre to the nearest blocked cell's face, 0 inside.

    blocked: (rows, columns). The value is the exact Euclidean distance between centres, less half a
    cell; if nothing is blocked it is greater than the grid's diagonal. It is bit-identical on every
    machine, unlike the vectorised square roots of a library.
    """
    return _clearance(np.ascontiguousarray(blocked), resolution)


@numba.njit(cache=True)
def _clearance(blocked: NDArray[np.bool_], resolution: float) -> Field:
    """By the algorithm of Meijster, Roerdink and Hesselink (2000)."""
    rows, columns = blocked.shape
    beyond = rows + columns
    down = np.empty((rows, columns), dtype=np.int64)
    for r in range(rows):
        for c in range(columns):
            above = down[r - 1, c] + 1 if r > 0 else beyond
            down[r, c] = 0 if blocked[r, c] else min(above, beyond)
    for r in range(rows - 2, -1, -1):
        for c in range(columns):
            down[r, c] = min(down[r, c], down[r + 1, c] + 1)
    field = np.empty((rows, columns), dtype=np.float32)
    site = np.empty(columns, dtype=np.int64)
    begin = np.empty(columns, dtype=np.int64)
    for r in range(rows):
        g = down[r]
        top = 0
        site[0] = 0
        begin[0] = 0
        for c in range(1, columns):
            while top >= 0 and _at(g, site[top], begin[top]) > _at(g, c, begin[top]):
                top -= 1
            if top < 0:
                top = 0
                site[0] = c
                continue
            i = site[top]
            meet = 1 + (c * c - i * i + g[c] * g[c] - g[i] * g[i]) // (2 * (c - i))
            if meet < columns:
                top += 1
                site[top] = c
                begin[top] = meet
        for c in range(columns - 1, -1, -1):
            cells = math.sqrt(float(_at(g, site[top], c)))
            field[r, c] = max((cells - 0.5) * resolution, 0.0)
            if c == begin[top]:
                top -= 1
    return field


@numba.njit(cache=True, inline="always")
def _at(g: NDArray[np.int64], i: int, c: int) -> int:
    """Squared distance from column c to the nearest blocked cell of column i."""
    squared: int = (c - i) * (c - i) + g[i] * g[i]
    return squared


def surface_distance(occupied: NDArray[np.bool_], resolution: float, cap: float) -> Field:
    """Distance in m, at most `cap`, from each cell's centre to the nearest occupied surface.

    The distance is positive on both sides: a laser measures surfaces, and a thick wall has two.
    Between an occupied and a free cell the surface lies half a cell from both centres.
    """
    outside = clearance(occupied, resolution)
    inside = clearance(~occupied, resolution)
    return np.minimum(np.where(occupied, inside, outside), np.float32(cap)).astype(np.float32)


@numba.njit(cache=True, inline="always")
def sample(field: Field, column: float, row: float, outside: float) -> float:
    """Bilinear interpolation at fractional cell coordinates (0 is the first cell's centre)."""
    rows, columns = field.shape
    c = math.floor(column)
    r = math.floor(row)
    if c < 0 or r < 0 or c >= columns - 1 or r >= rows - 1:
        return outside
    u = column - c
    v = row - r
    low = field[r, c] * (1.0 - u) + field[r, c + 1] * u
    high = field[r + 1, c] * (1.0 - u) + field[r + 1, c + 1] * u
    value: float = low * (1.0 - v) + high * v
    return value
