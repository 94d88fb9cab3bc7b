"""A floor plan of scans at their poses: which cells beams passed, and in which they ended."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.errors import InputError
from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.mapping.poses import moved
from momantu_skills.navigation.map.sensing import Rays

BORDER = 1.0
"""Unknown floor around all that was seen, m."""
HIT_SHARE = 0.3
"""Share of beams in a cell that ended there, from which on it is occupied: a wall that is seen at a
flat angle has its cells passed more often than hit."""
BLACK, GREY, WHITE = 0, 205, 254
"""map_server's grey levels of occupied, unknown and free cells."""


def floor_plan(
    scans: Iterable[tuple[Pose2D, Rays]], resolution: float, longest: float
) -> MapPicture:
    """The map of scans at `map_from_base`, each with its rays in base; ranges up to `longest` m.

    A beam that hit nothing says nothing.

    Raises:
        InputError: no beam hit anything.
    """
    origins, ends = _beams(scans, longest)
    if not len(ends):
        raise InputError(f"no beam hit anything within {longest:g} m: there is nothing to map")
    low = np.floor((np.vstack([origins, ends]).min(axis=0) - BORDER) / resolution) * resolution
    high = np.vstack([origins, ends]).max(axis=0) + BORDER
    columns, rows = (math.ceil(size) for size in (high - low) / resolution)
    passed, hit = np.zeros((rows, columns), np.int32), np.zeros((rows, columns), np.int32)
    _cast(passed, hit, (origins - low) / resolution, (ends - low) / resolution)
    occupied = hit >= np.maximum(1, HIT_SHARE * (hit + passed))
    levels = np.where(occupied, BLACK, np.where(passed + hit > 0, WHITE, GREY))
    return MapPicture(
        levels.astype(np.uint8)[::-1], resolution, (float(low[0]), float(low[1])), brightest=255
    )


def _beams(scans: Iterable[tuple[Pose2D, Rays]], longest: float) -> tuple[Array, Array]:
    """Where beams begin and end, (n, 2) each, in the map."""
    origins, ends = [np.empty((0, 2))], [np.empty((0, 2))]
    for pose, rays in scans:
        near = rays.hit & (rays.ranges <= longest)
        points = rays.origin + rays.directions[near] * rays.ranges[near, None]
        ends.append(moved(points, pose))
        origins.append(np.repeat(moved(rays.origin[None], pose), len(points), axis=0))
    return np.vstack(origins), np.vstack(ends)


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
