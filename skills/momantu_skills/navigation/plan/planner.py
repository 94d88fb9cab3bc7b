"""The global planner: cost to the goal from every cell, by fast marching (Sethian 1996)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.config import PlannerConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.fields import Field, sample
from momantu_skills.navigation.map.maps import GridMap

UNREACHED = np.float32(1e6)
STEP = 0.5
"""Step of the gradient descent to the goal, cells."""


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """Paths to one goal from everywhere.

    cost: (rows, columns) distance to the goal in metres, weighted by nearness to obstacles;
    `UNREACHED` where it was not computed. path: (n, 2) map coordinates from the start to the goal.
    goal: the goal pose. grid: the map that it was made on, whose raster `cost` has.
    """

    cost: Field
    path: Array
    goal: tuple[float, float]
    grid: GridMap

    @property
    def length(self) -> float:
        """Length of the path, m."""
        return float(np.hypot(*np.diff(self.path, axis=0).T).sum())

    def fits(self, grid: GridMap) -> bool:
        """Whether a map still has the plan's raster; one that grows may get another."""
        return grid is self.grid or (
            grid.origin == self.grid.origin and grid.cells.shape == self.grid.cells.shape
        )


def plan(
    costmap: Costmap,
    start: Pose2D,
    goal: Pose2D,
    radius: float,
    comfort: float,
    costs: PlannerConfig,
    *,
    known: bool = False,
    mapped: bool = False,
    weight: Field | None = None,
) -> Plan | None:
    """The cheapest path for a disc of `radius` m, or None if there is none.

    known: use map and zones only, to distinguish a blocked path from one that never existed.
    mapped: use the map alone, to tell what the zones close.
    weight: (rows, columns) factors on the cost of each metre, at least 1.
    """
    field = costmap.known_field if known else costmap.field
    field = costmap.mapped_field if mapped else field
    slowness = _slowness(field, radius, comfort, costs)
    if costmap.preferred is not None:
        slowness *= costmap.preferred
    if weight is not None:
        slowness *= weight
    row, column = costmap.grid.index(goal.x, goal.y)
    start_row, start_column = costmap.grid.index(start.x, start.y)
    if not (costmap.grid.contains(goal.x, goal.y) and costmap.grid.contains(start.x, start.y)):
        return None
    cost = _march(slowness, row, column, start_row, start_column, costmap.grid.resolution)
    if cost[start_row, start_column] >= UNREACHED:
        return None
    ends = (float(c) for c in (start.x, start.y, goal.x, goal.y))
    path = _descend(cost, costmap.frame, *ends)
    return Plan(cost, path, (goal.x, goal.y), costmap.grid)


def reach(
    costmap: Costmap, start: Pose2D, radius: float, comfort: float, costs: PlannerConfig
) -> Field:
    """Weighted metres from `start` to every cell on known floor: (rows, columns).

    `UNREACHED` where a disc of `radius` m cannot get. What the base stands in counts as passable,
    so that it can leave.
    """
    slowness = _slowness(costmap.field, radius, comfort, costs)
    row, column = costmap.grid.index(start.x, start.y)
    slowness[costmap.unknown] = np.inf
    if not costmap.grid.contains(start.x, start.y):
        return np.full(slowness.shape, UNREACHED, dtype=np.float32)
    around = math.ceil(radius / costmap.grid.resolution)
    here = slowness[
        max(0, row - around) : row + around + 1, max(0, column - around) : column + around + 1
    ]
    here[~np.isfinite(here)] = costs.tight
    return np.asarray(_march(slowness, row, column, -1, -1, costmap.grid.resolution))


def _slowness(field: Field, radius: float, comfort: float, costs: PlannerConfig) -> Field:
    spare = field - np.float32(radius)
    slow = 1.0 + costs.nearness * np.exp(-np.maximum(spare, 0.0) / comfort)
    slow = np.where(spare < 0.0, np.where(spare > -costs.tight_by, costs.tight, np.inf), slow)
    return np.ascontiguousarray(slow, dtype=np.float32)


@numba.njit(cache=True)
def _march(
    slowness: Field, row: int, column: int, start_row: int, start_column: int, resolution: float
) -> Field:
    """Arrival time from (row, column), until a little past (start_row, start_column)."""
    rows, columns = slowness.shape
    time = np.full((rows, columns), UNREACHED, dtype=np.float32)
    done = np.zeros((rows, columns), dtype=np.bool_)
    capacity = 8 * rows * columns // 4 + 64
    keys = np.empty(capacity, dtype=np.float32)
    cells = np.empty(capacity, dtype=np.int64)
    size = 0
    if not np.isfinite(slowness[row, column]):
        return time
    time[row, column] = 0.0
    size = _push(keys, cells, size, np.float32(0.0), row * columns + column)
    limit = np.float32(3e38)
    while size > 0:
        key = keys[0]
        cell = cells[0]
        size = _pop(keys, cells, size)
        r = cell // columns
        c = cell % columns
        if done[r, c]:
            continue
        if key > limit:
            break
        done[r, c] = True
        if r == start_row and c == start_column:
            limit = key + np.float32(3.0)
        for k in range(4):
            rr = r + (1 if k == 0 else -1 if k == 1 else 0)
            cc = c + (1 if k == 2 else -1 if k == 3 else 0)
            if rr < 0 or cc < 0 or rr >= rows or cc >= columns or done[rr, cc]:
                continue
            slow = slowness[rr, cc]
            if not np.isfinite(slow):
                continue
            new = _arrival(time, done, rr, cc, slow * resolution)
            if new < time[rr, cc] and size < capacity:
                time[rr, cc] = new
                size = _push(keys, cells, size, new, rr * columns + cc)
    for r in range(rows):
        for c in range(columns):
            if not done[r, c]:
                time[r, c] = UNREACHED
    return time


@numba.njit(cache=True)
def _arrival(time: Field, done: NDArray[np.bool_], r: int, c: int, h: float) -> np.float32:
    """Upwind solution of |grad T| = slowness at one cell; h is slowness times cell size."""
    rows, columns = time.shape
    a = 1e9
    b = 1e9
    if r > 0 and done[r - 1, c]:
        a = min(a, float(time[r - 1, c]))
    if r + 1 < rows and done[r + 1, c]:
        a = min(a, float(time[r + 1, c]))
    if c > 0 and done[r, c - 1]:
        b = min(b, float(time[r, c - 1]))
    if c + 1 < columns and done[r, c + 1]:
        b = min(b, float(time[r, c + 1]))
    if abs(a - b) >= h:
        return np.float32(min(a, b) + h)
    return np.float32(0.5 * (a + b + math.sqrt(2.0 * h * h - (a - b) * (a - b))))


@numba.njit(cache=True)
def _push(keys: Field, cells: NDArray[np.int64], size: int, key: np.float32, cell: int) -> int:
    i = size
    while i > 0:
        parent = (i - 1) >> 1
        if keys[parent] <= key:
            break
        keys[i] = keys[parent]
        cells[i] = cells[parent]
        i = parent
    keys[i] = key
    cells[i] = cell
    return size + 1


@numba.njit(cache=True)
def _pop(keys: Field, cells: NDArray[np.int64], size: int) -> int:
    size -= 1
    key = keys[size]
    cell = cells[size]
    i = 0
    while True:
        child = 2 * i + 1
        if child >= size:
            break
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[i] = keys[child]
        cells[i] = cells[child]
        i = child
    keys[i] = key
    cells[i] = cell
    return size


@numba.njit(cache=True)
def _descend(cost: Field, frame: Array, x: float, y: float, gx: float, gy: float) -> Array:
    """Descend the cost from (x, y) to the goal: the best of 16 directions at each half cell."""
    most = 20_000
    path = np.empty((most, 2))
    count = 0
    reach = 1.5 * frame[2]
    while count < most - 1:
        path[count, 0] = x
        path[count, 1] = y
        count += 1
        if (gx - x) ** 2 + (gy - y) ** 2 < reach * reach:
            break
        here = sample(cost, (x - frame[0]) / frame[2] - 0.5, (y - frame[1]) / frame[2] - 0.5, 1e9)
        best = 1e9
        best_x = x
        best_y = y
        for k in range(16):
            nx = x + math.cos(k * math.pi / 8) * frame[2]
            ny = y + math.sin(k * math.pi / 8) * frame[2]
            value = sample(
                cost, (nx - frame[0]) / frame[2] - 0.5, (ny - frame[1]) / frame[2] - 0.5, 1e9
            )
            if value < best:
                best = value
                best_x = nx
                best_y = ny
        if best >= here and here < 1e5:
            break
        x += STEP * (best_x - x)
        y += STEP * (best_y - y)
    path[count, 0] = gx
    path[count, 1] = gy
    return path[: count + 1]
