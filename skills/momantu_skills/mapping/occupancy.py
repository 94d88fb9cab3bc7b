"""A floor plan of scans at their poses: which cells beams passed, and in which they ended."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.errors import InputError
from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN, MapPicture
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.messages import frozen
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

BORDER = 1.0
"""Unknown floor around all that was seen, m."""
HIT_SHARE = 0.3
"""Share of beams in a cell that ended there, from which on it is occupied: a wall that is seen at a
flat angle has its cells passed more often than hit."""
BLACK, GREY, WHITE = 0, 205, 254
"""map_server's grey levels of occupied, unknown and free cells."""


class Occupancy:
    """Beams counted on a raster that grows with what is seen.

    resolution: m per cell. longest: longer ranges are left out, m. step: by how much the raster
    grows, m.
    """

    def __init__(self, resolution: float, longest: float, step: float) -> None:
        self.resolution, self._longest, self._step = resolution, longest, step
        self._low = self._high = np.zeros(2)
        self._passed = self._hit = np.zeros((0, 0), np.int32)

    def add(self, scans: Iterable[tuple[Pose2D, Rays]], stands: float = 0.0) -> None:
        """Count the beams of scans at `map_from_base`, each with its rays in base.

        A beam that hit nothing says nothing. stands: radius of the base, m: the floor below it is
        free.
        """
        origins, ends, bases = self._beams(scans)
        self._cover(np.vstack([origins, ends, bases]))
        scale = 1.0 / self.resolution
        _cast(self._passed, self._hit, (origins - self._low) * scale, (ends - self._low) * scale)
        if stands:
            self._stand((bases - self._low) * scale, stands * scale)

    def forget(self) -> None:
        """Count from nothing again, on the same raster."""
        self._passed[:] = 0
        self._hit[:] = 0

    def grid(self) -> GridMap:
        """The floor plan so far; its cells do not change any more."""
        origin = (float(self._low[0]), float(self._low[1]))
        cells = np.full(self._hit.shape, UNKNOWN, np.uint8)
        cells[self._passed + self._hit > 0] = FREE
        cells[self._occupied()] = OCCUPIED
        return GridMap(frozen(cells), self.resolution, origin)

    def picture(self) -> MapPicture:
        """The floor plan as map_server has it.

        Raises:
            InputError: no beam hit anything.
        """
        if not self._hit.any():
            raise InputError(
                f"no beam hit anything within {self._longest:g} m: there is nothing to map"
            )
        grid = self.grid()
        levels = np.array([WHITE, BLACK, GREY], np.uint8)[grid.cells]
        return MapPicture(levels[::-1], self.resolution, grid.origin, brightest=255)

    def _occupied(self) -> NDArray[np.bool_]:
        return np.asarray(self._hit >= np.maximum(1, HIT_SHARE * (self._hit + self._passed)))

    def _beams(self, scans: Iterable[tuple[Pose2D, Rays]]) -> tuple[Array, Array, Array]:
        """Where beams begin and end, and where bases stand, (n, 2) each, in the map."""
        origins, ends, bases = ([np.empty((0, 2))] for _ in range(3))
        for pose, rays in scans:
            near = rays.hit & (rays.ranges <= self._longest)
            points = rays.origin + rays.directions[near] * rays.ranges[near, None]
            ends.append(pose.apply(points))
            origins.append(np.repeat(pose.apply(rays.origin[None]), len(points), axis=0))
            bases.append(np.array([[pose.x, pose.y]]))
        return np.vstack(origins), np.vstack(ends), np.vstack(bases)

    def _cover(self, points: Array) -> None:
        """Grow the raster so that points (n, 2) lie on it, with a border around them."""
        if not len(points):
            return
        low = np.floor((points.min(axis=0) - BORDER) / self._step) * self._step
        high = np.ceil((points.max(axis=0) + BORDER) / self._step) * self._step
        if self._hit.size:
            low, high = np.minimum(low, self._low), np.maximum(high, self._high)
            if (low == self._low).all() and (high == self._high).all():
                return
        columns, rows = np.rint((high - low) / self.resolution).astype(int)
        column, row = np.rint((self._low - low) / self.resolution).astype(int)
        old = self._passed, self._hit
        self._passed, self._hit = np.zeros((2, rows, columns), np.int32)
        if old[0].size:
            window = slice(row, row + old[0].shape[0]), slice(column, column + old[0].shape[1])
            self._passed[window], self._hit[window] = old
        self._low, self._high = low, high

    def _stand(self, bases: Array, radius: float) -> None:
        """Count the cells of discs as passed; cells as units."""
        reach = np.arange(-math.ceil(radius), math.ceil(radius) + 1)
        across, along = (part.ravel() for part in np.meshgrid(reach, reach))
        for x, y in np.floor(bases).astype(int):
            columns, rows = x + across, y + along
            below = np.hypot(across, along) <= radius
            self._passed[rows[below], columns[below]] += 1


def floor_plan(
    scans: Iterable[tuple[Pose2D, Rays]], resolution: float, longest: float, stands: float = 0.0
) -> MapPicture:
    """The map of scans at `map_from_base`, each with its rays in base; ranges up to `longest` m.

    A beam that hit nothing says nothing. stands: see `Occupancy.add`.

    Raises:
        InputError: no beam hit anything.
    """
    counts = Occupancy(resolution, longest, resolution)
    counts.add(scans, stands)
    return counts.picture()


@numba.njit(cache=True)
def _cast(passed: NDArray[np.int32], hit: NDArray[np.int32], origins: Array, ends: Array) -> None:
    """Count, cell by cell, the beams that end there and those that go on; cells as units.

    The walk from cell to cell is that of Amanatides and Woo (1987).
    """
    for i in range(origins.shape[0]):
        x, y = origins[i, 0], origins[i, 1]
        dx, dy = ends[i, 0] - x, ends[i, 1] - y
        column, row = math.floor(x), math.floor(y)
        last_column, last_row = math.floor(ends[i, 0]), math.floor(ends[i, 1])
        step_x = 1 if dx > 0 else -1
        step_y = 1 if dy > 0 else -1
        at_x = ((column + (step_x > 0)) - x) / dx if dx != 0.0 else math.inf
        at_y = ((row + (step_y > 0)) - y) / dy if dy != 0.0 else math.inf
        across_x = abs(1.0 / dx) if dx != 0.0 else math.inf
        across_y = abs(1.0 / dy) if dy != 0.0 else math.inf
        for _ in range(abs(last_column - column) + abs(last_row - row)):
            passed[row, column] += 1
            if at_x < at_y:
                at_x += across_x
                column += step_x
            else:
                at_y += across_y
                row += step_y
        hit[last_row, last_column] += 1
