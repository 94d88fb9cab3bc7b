"""Distance fields over a grid, and their bilinear lookup."""

from __future__ import annotations

import math

import cv2
import numba
import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float32]


def clearance(blocked: NDArray[np.bool_], resolution: float) -> Field:
    """Distance in m from each cell's centre to the nearest blocked cell's face, 0 inside.

    blocked: (rows, columns). Exact Euclidean distance between centres, less half a cell.
    """
    free = np.ascontiguousarray(~blocked).view(np.uint8)
    if free.all():
        return np.full(blocked.shape, np.float32(math.hypot(*blocked.shape) * resolution))
    cells = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    return np.asarray(np.maximum((cells - 0.5) * resolution, 0.0), dtype=np.float32)


def surface_distance(occupied: NDArray[np.bool_], resolution: float, cap: float) -> Field:
    """Distance in m, at most `cap`, from each cell's centre to the nearest occupied surface.

    Positive outside and inside alike: a laser sees surfaces, and a thick wall has two of them.
    Where a wall meets a free cell the surface lies half a cell from both centres.
    """
    outside = clearance(occupied, resolution)
    inside = clearance(~occupied, resolution)
    return np.minimum(np.where(occupied, inside, outside), np.float32(cap)).astype(np.float32)


@numba.njit(cache=True, inline="always")
def sample(field: Field, column: float, row: float, outside: float) -> float:
    """Bilinear value at fractional cell coordinates (0 is the first cell's centre)."""
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
