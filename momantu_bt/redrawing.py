"""What floor plans show of a surface, and the same drawn at another place."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Pose2D
from momantu_bt.world import Surface

DRAWN = 0.06
"""How far around a surface what is drawn on the maps belongs to it, m."""
Mask = NDArray[np.bool_]
Grid = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Raster:
    """The cells of a floor plan. shape: (rows, columns), row 0 at the smallest y.

    resolution: m per cell. origin: map coordinates (x, y) of the lower left corner, m.
    """

    shape: tuple[int, ...]
    resolution: float
    origin: tuple[float, float]

    def on(self, surface: Surface, margin: float = 0.0) -> Mask:
        """Which cells have their middle on a surface, or `margin` m beside it."""
        x, y = self._seen_from(surface.map_from_surface)
        half_x, half_y = (edge / 2 + margin for edge in surface.size)
        if surface.round:
            return np.asarray(np.hypot(x, y) <= half_x)
        return np.asarray((np.abs(x) <= half_x) & (np.abs(y) <= half_y))

    def moved(self, occupied: Mask, here: Surface, there: Surface) -> tuple[Mask, Mask]:
        """The cells that show a surface at one place, and those that show it at another.

        occupied: the cells where something is drawn while the surface is `here`.
        """
        x, y = self._seen_from(there.map_from_surface)
        at = here.map_from_surface
        c, s = math.cos(at.yaw), math.sin(at.yaw)
        column = np.floor((at.x + c * x - s * y - self.origin[0]) / self.resolution)
        row = np.floor((at.y + s * x + c * y - self.origin[1]) / self.resolution)
        rows, columns = self.shape
        drawn = self.on(there, DRAWN) & (row >= 0) & (row < rows) & (column >= 0)
        drawn &= column < columns
        drawn[drawn] = occupied[row[drawn].astype(np.int64), column[drawn].astype(np.int64)]
        return occupied & self.on(here, DRAWN), drawn

    def _seen_from(self, frame: Pose2D) -> tuple[Grid, Grid]:
        """X and y of the middle of each cell in a frame of the map, m."""
        rows, columns = np.indices(self.shape)
        x = self.origin[0] + (columns + 0.5) * self.resolution - frame.x
        y = self.origin[1] + (rows + 0.5) * self.resolution - frame.y
        c, s = math.cos(frame.yaw), math.sin(frame.yaw)
        return np.asarray(c * x + s * y), np.asarray(c * y - s * x)


def surface_at(surface: Surface, map_from_surface: Pose2D) -> Surface:
    """The surface at another place, with what hangs over it."""
    motion = map_from_surface @ surface.map_from_surface.inverse()
    over = tuple(
        replace(one, map_from_overhang=motion @ one.map_from_overhang) for one in surface.over
    )
    return replace(surface, map_from_surface=map_from_surface, over=over)
