"""Floor plans drawn from walls at any pose and resolution, for tests of maps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from momantu_skills.navigation.map.maps import GridMap
from scipy.ndimage import binary_fill_holes

from momantu_bt.formats.maps import CELL_LEVELS, FREE, OCCUPIED, UNKNOWN, MapPicture, write_map
from momantu_bt.geometry import Pose2D
from tests.skills.mapping.walls import Wall

FINE = 0.01


def drawn(
    walls: Sequence[Wall], resolution: float = 0.05, map_from_walls: Pose2D | None = None
) -> GridMap:
    """The plan of walls: a cell that a wall crosses is occupied, the floor within is free."""
    at = map_from_walls or Pose2D(0.0, 0.0)
    points = np.vstack([_along(wall) for wall in walls])
    there = at.apply(points)
    low = np.floor(there.min(axis=0) / resolution - 10) * resolution
    high = there.max(axis=0) + 10 * resolution
    columns, rows = np.ceil((high - low) / resolution).astype(int)
    occupied = np.zeros((rows, columns), dtype=bool)
    column, row = np.floor((there - low) / resolution).astype(int).T
    occupied[row, column] = True
    cells = np.full((rows, columns), UNKNOWN, dtype=np.uint8)
    cells[binary_fill_holes(occupied)] = FREE
    cells[occupied] = OCCUPIED
    return GridMap(cells, resolution, (float(low[0]), float(low[1])))


def _along(wall: Wall) -> np.ndarray:
    x0, y0, x1, y1 = wall
    count = max(2, round(np.hypot(x1 - x0, y1 - y0) / FINE))
    share = np.linspace(0.0, 1.0, count)[:, None]
    return np.array([[x0, y0]]) * (1 - share) + np.array([[x1, y1]]) * share


def written(grid: GridMap, path: Path) -> Path:
    """The same as a map_server file."""
    levels = CELL_LEVELS[grid.cells[::-1]]
    write_map(path, MapPicture(levels, grid.resolution, grid.origin))
    return path
