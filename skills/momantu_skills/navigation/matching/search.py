"""The best pose of many points in a large window: branch and bound over a pyramid of grids.

Each level of the pyramid holds the largest values of blocks twice as large, as in Hess et al.,
Real-time loop closure in 2D lidar SLAM, ICRA 2016.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.navigation.matching.likelihood import Bytes, blocks, share

LEVELS = 5
"""Levels above the grid: blocks of 32 cells."""
_DEEP = 4 * LEVELS + 4
"""Most branches that wait at a time below one block."""


@numba.njit(cache=True)
def pyramid(grid: Bytes) -> Bytes:
    """(LEVELS + 1, rows, columns): at level k the largest value of the 2^k cells from each cell."""
    rows, columns = grid.shape
    levels = np.zeros((LEVELS + 1, rows, columns), dtype=np.uint8)
    levels[0] = grid
    for k in range(1, LEVELS + 1):
        half = 1 << (k - 1)
        for r in range(rows):
            above = min(r + half, rows - 1)
            for c in range(columns):
                aside = min(c + half, columns - 1)
                low = max(levels[k - 1, r, c], levels[k - 1, r, aside])
                high = max(levels[k - 1, above, c], levels[k - 1, above, aside])
                levels[k, r, c] = max(low, high)
    return levels


@numba.njit(cache=True)
def search(
    levels: Bytes,
    corner: Array,
    cell: float,
    points: Array,
    expected: Array,
    window: Array,
    turn_step: float,
    least: float,
) -> tuple[float, Array]:
    """The score 0..1 and the pose (3,) of points (n, 2); the score is -1 if none is above `least`.

    window: half widths (m, rad) around the expected pose (3,).
    """
    block = 1 << LEVELS
    turns = math.ceil(window[1] / turn_step)
    steps = math.ceil(window[0] / cell / block)
    edge = 2 * steps + 1
    cells, bounds = blocks(
        levels[LEVELS], corner, cell, points, expected, turns, turn_step, steps, block
    )
    best = least
    pose = expected.copy()
    for at in np.argsort(-bounds, kind="mergesort"):
        if bounds[at] <= best:
            break
        t, rest = at // (edge * edge), at % (edge * edge)
        start = np.array([(rest // edge - steps) * block, (rest % edge - steps) * block])
        score, right, up = _descend(levels, cells[t], start, bounds[at], best)
        if score > best:
            best = score
            pose[0] = expected[0] + right * cell
            pose[1] = expected[1] + up * cell
            pose[2] = expected[2] + (t - turns) * turn_step
    return (best if best > least else -1.0), pose


@numba.njit(cache=True)
def _descend(
    levels: Bytes,
    cells: NDArray[np.int64],
    start: NDArray[np.int64],
    bound: float,
    least: float,
) -> tuple[float, int, int]:
    """The best move (right, up) in cells within one block, if its score is above `least`."""
    waiting = np.empty((_DEEP, 3), dtype=np.int64)
    hopes = np.empty(_DEEP)
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = start[0], start[1], LEVELS
    hopes[0] = bound
    count = 1
    best, right, up = least, 0, 0
    children = np.empty(4)
    while count > 0:
        count -= 1
        u, v, level = waiting[count, 0], waiting[count, 1], waiting[count, 2]
        if hopes[count] <= best:
            continue
        if level == 0:
            best, right, up = hopes[count], u, v
            continue
        half = 1 << (level - 1)
        for k in range(4):
            children[k] = share(
                levels[level - 1], cells, u + half * (k // 2), v + half * (k % 2), half
            )
        for k in np.argsort(children, kind="mergesort"):
            if children[k] > best:
                waiting[count, 0] = u + half * (k // 2)
                waiting[count, 1] = v + half * (k % 2)
                waiting[count, 2] = level - 1
                hopes[count] = children[k]
                count += 1
    return best, right, up
