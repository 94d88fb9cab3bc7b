"""A grid of how likely a beam ends in each cell, and the best pose of a scan in it.

The search is Olson's (Real-time correlative scan matching, ICRA 2009): a grid of largest values
bounds the score of whole blocks of poses, so that most of them are never looked at.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

Bytes = NDArray[np.uint8]
BLOCK = 4
"""Edge of a block of poses, cells."""
FULL = 255.0
"""The value of a cell in which a beam surely ends."""
SURPRISE = 0.02
"""What a pose loses of its score for each squared standard deviation from the expected one."""


def stencil(spread: float, resolution: float) -> Bytes:
    """The values around an end point, (2k + 1, 2k + 1). spread: standard deviation, m."""
    k = math.ceil(2.5 * spread / resolution)
    steps = np.arange(-k, k + 1) * resolution
    squared = steps[:, None] ** 2 + steps[None, :] ** 2
    return np.asarray((FULL * np.exp(-squared / (2 * spread**2))).astype(np.uint8))


@numba.njit(cache=True)
def add_ends(
    grid: Bytes, bound: Bytes, corner: Array, cell: float, ends: Array, stamp: Bytes
) -> None:
    """Enter end points (n, 2) into a grid, and into the bounds of its blocks.

    corner: (2,) of the grid, m. bound: the largest value of the block that begins at each cell.
    """
    k = stamp.shape[0] // 2
    rows, columns = grid.shape
    for i in range(ends.shape[0]):
        c = math.floor((ends[i, 0] - corner[0]) / cell)
        r = math.floor((ends[i, 1] - corner[1]) / cell)
        edge = k + BLOCK
        if (
            c < edge
            or r < edge
            or c >= columns - edge
            or r >= rows - edge
            or grid[r, c] == stamp[k, k]
        ):
            continue
        for a in range(-k, k + 1):
            for b in range(-k, k + 1):
                value = stamp[a + k, b + k]
                if value <= grid[r + a, c + b]:
                    continue
                grid[r + a, c + b] = value
                for e in range(BLOCK):
                    for f in range(BLOCK):
                        if bound[r + a - e, c + b - f] < value:
                            bound[r + a - e, c + b - f] = value


@numba.njit(cache=True)
def cells_at(points: Array, pose: Array, corner: Array, cell: float) -> NDArray[np.int64]:
    """The (column, row) of points (n, 2) with the scan at a pose (3,): (n, 2)."""
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    found = np.empty(points.shape, dtype=np.int64)
    for i in range(points.shape[0]):
        x = pose[0] + c * points[i, 0] - s * points[i, 1]
        y = pose[1] + s * points[i, 0] + c * points[i, 1]
        found[i, 0] = math.floor((x - corner[0]) / cell)
        found[i, 1] = math.floor((y - corner[1]) / cell)
    return found


@numba.njit(cache=True)
def share(grid: Bytes, cells: NDArray[np.int64], right: int, up: int, block: int) -> float:
    """Mean value 0..1 of cells (n, 2) moved by whole cells. block: edge of what a value bounds."""
    rows, columns = grid.shape
    total = 0
    for i in range(cells.shape[0]):
        c = cells[i, 0] + right
        r = cells[i, 1] + up
        if c <= -block or r <= -block or c >= columns or r >= rows:
            continue
        total += grid[max(r, 0), max(c, 0)]
    mean: float = total / (FULL * cells.shape[0])
    return mean


@numba.njit(cache=True)
def blocks(
    bound: Bytes,
    corner: Array,
    cell: float,
    points: Array,
    expected: Array,
    turns: int,
    turn_step: float,
    steps: int,
    block: int,
) -> tuple[NDArray[np.int64], Array]:
    """The largest scores of blocks of poses around an expected one (3,).

    turns, steps: how many steps of yaw and blocks to each side. Returns the cells of points (n, 2)
    at each yaw, (2 turns + 1, n, 2), and the bounds, by yaw, column and row of the block.
    """
    edge = 2 * steps + 1
    cells = np.empty((2 * turns + 1, points.shape[0], 2), dtype=np.int64)
    bounds = np.empty((2 * turns + 1) * edge * edge)
    for t in range(2 * turns + 1):
        yaw = expected[2] + (t - turns) * turn_step
        cells[t] = cells_at(points, np.array([expected[0], expected[1], yaw]), corner, cell)
        for u in range(edge):
            for v in range(edge):
                right, up = (u - steps) * block, (v - steps) * block
                bounds[(t * edge + u) * edge + v] = share(bound, cells[t], right, up, block)
    return cells, bounds


@numba.njit(cache=True)
def best_pose(
    grid: Bytes,
    bound: Bytes,
    corner: Array,
    cell: float,
    points: Array,
    expected: Array,
    window: Array,
    turn_step: float,
    deviation: Array,
) -> tuple[float, Array]:
    """The score 0..1 and the pose (3,) of points (n, 2) within a window around the expected pose.

    window: half widths (m, rad). deviation: standard deviations (m, rad) of the expected pose.
    """
    turns = math.ceil(window[1] / turn_step)
    steps = math.ceil(window[0] / cell / BLOCK)
    edge = 2 * steps + 1
    cells, bounds = blocks(bound, corner, cell, points, expected, turns, turn_step, steps, BLOCK)
    best = -1e9
    pose = expected.copy()
    for at in np.argsort(-bounds, kind="mergesort"):
        if bounds[at] <= best:
            break
        t, rest = at // (edge * edge), at % (edge * edge)
        turn = (t - turns) * turn_step
        for e in range(BLOCK):
            for f in range(BLOCK):
                right = (rest // edge - steps) * BLOCK + e
                up = (rest % edge - steps) * BLOCK + f
                score = share(grid, cells[t], right, up, 1)
                far = (right * right + up * up) * (cell / deviation[0]) ** 2
                score -= SURPRISE * (far + (turn / deviation[1]) ** 2)
                if score > best:
                    best = score
                    pose[0] = expected[0] + right * cell
                    pose[1] = expected[1] + up * cell
                    pose[2] = expected[2] + turn
    return best, pose
