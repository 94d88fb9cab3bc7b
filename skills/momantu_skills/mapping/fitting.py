"""How well a scan fits a map that is still being made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from momantu_bt.formats.maps import OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from momantu_skills.navigation.localize.fit import HIT, scan_fit
from momantu_skills.navigation.map.fields import Field, surface_distance
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

FEWEST = 20
"""Fewest beams that end on known floor for a fit; with fewer there is nothing to compare with."""


def surfaces(grid: GridMap) -> Field:
    """Distances (rows, columns) to the map's surfaces, m, as far as `fit` needs them."""
    return surface_distance(grid.cells == OCCUPIED, grid.resolution, 2.0 * HIT)


def fit(grid: GridMap, field: Field, map_from_base: Pose2D, rays: Rays) -> float:
    """0..1, as `scan_fit`, of the beams that end where the map knows something.

    A beam into a room that nobody has seen speaks neither for nor against a pose. 1 if there are
    too few others. field: of `surfaces`.
    """
    ends = rays.origin + rays.directions * np.where(rays.hit, rays.ranges, 0.0)[:, None]
    there = np.floor((map_from_base.apply(ends) - np.array(grid.origin)) / grid.resolution)
    column, row = there.astype(np.int64).T
    rows, columns = grid.cells.shape
    on = (row >= 0) & (row < rows) & (column >= 0) & (column < columns) & rays.hit
    new = (grid.cells[row[on], column[on]] == UNKNOWN) & (field[row[on], column[on]] > HIT)
    told = on.copy()
    told[on] = ~new
    if np.count_nonzero(told) < FEWEST:
        return 1.0
    return scan_fit(grid, field, map_from_base, replace(rays, hit=told))
