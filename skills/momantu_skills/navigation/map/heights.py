"""What of a site's maps may be taller than a surface: maps have no heights, surfaces have one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.redrawing import DRAWN, Mask
from momantu_bt.world import Surface
from momantu_skills.navigation.map.believed import raster
from momantu_skills.navigation.map.costmap import FAR, room
from momantu_skills.navigation.map.fields import Field, clearance
from momantu_skills.navigation.map.maps import GridMap, overlaid


@dataclass(frozen=True, slots=True, eq=False)
class Tall:
    """Distances to what may be tall. field, frame: as `Costmap` has them."""

    field: Field
    frame: Array

    def room(self, pose: Pose2D, discs: Array) -> float:
        """Clearance in m of discs (m, 3) at a pose, map; negative in a collision."""
        x, y, yaw = float(pose.x), float(pose.y), float(pose.yaw)
        return float(room(self.field, self.frame, discs, x, y, yaw))


def taller_than(grids: Sequence[GridMap], surfaces: Iterable[Surface], height: float) -> Tall:
    """What may reach above a height, m: everything on the maps but surfaces that are lower."""
    low = [surface for surface in surfaces if surface.height <= height]
    grid = grids[0]
    field = np.minimum(clearance(tall_cells(grids, low), grid.resolution), np.float32(FAR))
    return Tall(field, np.array([*grid.origin, grid.resolution]))


def tall_cells(grids: Sequence[GridMap], surfaces: Sequence[Surface]) -> Mask:
    """The occupied cells (rows, columns) of the first grid, or of any, that show no surface.

    What is drawn beside a surface's outline belongs to it, unless something goes on from there.
    """
    grid = grids[0]
    occupied = grid.cells == OCCUPIED
    for layer in grids[1:]:
        occupied = occupied | overlaid(layer, grid)
    cells = raster(grid)
    inside, beside = np.zeros((2, *occupied.shape), dtype=np.bool_)
    for surface in surfaces:
        inside |= cells.on(surface)
        beside |= cells.on(surface, DRAWN)
    beyond = _grown(occupied & ~beside)
    return np.asarray(occupied & ~inside & (~beside | beyond))


def _grown(mask: Mask) -> NDArray[np.bool_]:
    """The mask (rows, columns) with the eight neighbours of each of its cells."""
    wide = np.pad(mask, 1)
    rows, columns = mask.shape
    grown = np.zeros_like(mask)
    for i in range(3):
        for j in range(3):
            grown |= wide[i : i + rows, j : j + columns]
    return grown
