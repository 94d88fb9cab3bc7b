"""Coverage: which outlines on the map the camera was turned to, and from where it sees the rest.

Whatever stands on the floor leaves an outline in the laser's plane: the legs of a table, the front
of a cabinet. Who has turned the camera to every outline from near has seen what is on and above it.
Gonzalez-Banos and Latombe: A randomized art-gallery algorithm for sensor placement (SCG 2001).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Array, Pose2D, wrap_angle
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.planner import UNREACHED

SIGHT = 3.2
"""How far a look counts, m: a top 0.4 m below the camera is seen at 7 degrees there."""
RAYS = 360
DEPTH = 0.15
"""How far behind the first hit an outline counts as the same, m: a wall is thicker."""
APART = 0.4
"""Distance between places to look from that are compared, m."""
LEAST_GAIN = 0.6
"""Outline in sight that is worth a look, m: three legs of a table, each with what `thick` adds."""
TURN_UP = 2.5
"""Way that every place costs beside its own, m: to stop, and to look around."""
AHEAD = math.radians(100.0)
"""How far to either side a place counts that the base faces in one direction, rad."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class View:
    """A place to look from. pose: of the base, map, facing what it shows. gain: outline, m."""

    pose: Pose2D
    gain: float


def left(grid: GridMap, looks: Sequence[Pose2D], fov: float) -> Mask:
    """(rows, columns): the outlines of a map that no look has shown.

    An outline is what is occupied beside what is free. looks: camera over the floor and its
    direction, map. fov: the angle that a look shows, rad.
    """
    shown = np.zeros(grid.cells.shape, dtype=np.bool_)
    for look in looks:
        row, column = grid.index(look.x, look.y)
        _show(grid.cells, row, column, *_reach(grid), look.yaw - fov / 2, look.yaw + fov / 2, shown)
    return outlines(grid) & ~shown


def outlines(grid: GridMap) -> Mask:
    """(rows, columns): what is occupied beside what is free."""
    return np.asarray((grid.cells == OCCUPIED) & grid.beside(FREE))


def best_view(
    grid: GridMap, remaining: Mask, cost: Field, stands: Mask, done: Sequence[Pose2D]
) -> View | None:
    """The place with the most outline in sight over the way to it; None if none is worth it.

    cost: (rows, columns) weighted metres from the base. stands: where it has room for any heading.
    done: places that are left out, with what is near them.
    """
    edge = max(1, round(APART / grid.resolution))
    rows, columns = np.nonzero((cost < UNREACHED) & stands)
    _, first = np.unique(
        (rows // edge) * (grid.cells.shape[1] // edge + 1) + columns // edge, return_index=True
    )
    best, found = 0.0, None
    for row, column in zip(rows[first], columns[first], strict=True):
        x, y = grid.centre(row, column)
        if any(math.hypot(x - place.x, y - place.y) < APART for place in done):
            continue
        around = in_sight(grid, remaining, x, y)
        yaw, gain = _facing(around, AHEAD)
        score = gain / (float(cost[row, column]) + TURN_UP)
        if gain >= LEAST_GAIN and score > best:
            best, found = score, View(Pose2D(x, y, yaw), gain)
    return found


def in_sight(grid: GridMap, remaining: Mask, x: float, y: float) -> Array:
    """(RAYS,) metres of outline across each ray from a point, counter-clockwise from x."""
    row, column = grid.index(x, y)
    return _in_sight(grid.cells, remaining, row, column, *_reach(grid)) * grid.resolution


def directions(around: Array, fov: float) -> list[float]:
    """The directions to look in, rad, so that looks of this angle show all that is worth one.

    around: as of `in_sight`. From right to left as seen from the middle of a gap.
    """
    rest = around.copy()
    chosen: list[float] = []
    while True:
        yaw, gain = _facing(rest, fov / 2)
        if gain < LEAST_GAIN or len(chosen) == RAYS:
            return chosen
        chosen.append(yaw)
        rest[_within(yaw, fov / 2)] = 0.0


def _facing(around: Array, half: float) -> tuple[float, float]:
    """The direction with the most within `half` rad of it, rad, and how much that is."""
    wide = max(1, round(half / (2 * math.pi / RAYS)))
    ring = np.concatenate([around[-wide:], around, around[:wide]])
    sums = np.convolve(ring, np.ones(2 * wide + 1), mode="valid")
    best = float(sums.max())
    # of a run of equally good directions the middle one: what is seen lies well inside the picture
    ties = np.flatnonzero(sums >= best - 1e-9)
    run = ties[: int(np.argmax(np.diff(ties, append=RAYS + 2) > 1)) + 1]
    return wrap_angle(2 * math.pi * float(run.mean()) / RAYS), best


def _within(yaw: float, half: float) -> Mask:
    angles = 2 * np.pi * np.arange(RAYS) / RAYS - yaw
    return np.asarray(np.abs(np.arctan2(np.sin(angles), np.cos(angles))) <= half)


def _reach(grid: GridMap) -> tuple[float, float]:
    return SIGHT / grid.resolution, DEPTH / grid.resolution


@numba.njit(cache=True)
def _show(
    cells: NDArray[np.uint8],
    row: int,
    column: int,
    sight: float,
    depth: float,
    first: float,
    last: float,
    shown: Mask,
) -> None:
    """Mark the outlines that rays between two angles meet first."""
    rows, columns = cells.shape
    count = max(2, math.ceil((last - first) * RAYS / math.pi))
    for k in range(count):
        angle = first + (last - first) * k / (count - 1)
        dy = math.sin(angle)
        dx = math.cos(angle)
        away = 1.0
        end = sight
        while away < end:
            i = math.floor(row + 0.5 + dy * away)
            j = math.floor(column + 0.5 + dx * away)
            if not (0 <= i < rows and 0 <= j < columns):
                break
            if cells[i, j] == OCCUPIED:
                end = min(end, away + depth)
                shown[i, j] = True
            away += 0.5


@numba.njit(cache=True)
def _in_sight(
    cells: NDArray[np.uint8], remaining: Mask, row: int, column: int, sight: float, depth: float
) -> Array:
    """Cells of remaining outline across each ray."""
    rows, columns = cells.shape
    around = np.zeros(RAYS)
    for k in range(RAYS):
        angle = 2.0 * math.pi * k / RAYS
        dy = math.sin(angle)
        dx = math.cos(angle)
        away = 1.0
        while away < sight:
            i = math.floor(row + 0.5 + dy * away)
            j = math.floor(column + 0.5 + dx * away)
            if not (0 <= i < rows and 0 <= j < columns):
                break
            if cells[i, j] == OCCUPIED:
                if remaining[i, j]:
                    around[k] = away * 2.0 * math.pi / RAYS
                break
            away += 1.0
    return around
