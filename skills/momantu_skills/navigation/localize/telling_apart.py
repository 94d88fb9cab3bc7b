"""Where to look next, to tell places that look alike from one another.

Of each place the map says what the laser would see from somewhere else; where that differs most,
a look decides. After Fox, Burgard, Thrun, Active Markov localization for mobile robots, Robotics
and Autonomous Systems 25 (1998) 195.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.map.maps import GridMap

BEAMS = 48
"""Directions in which the map is looked at."""
REACH = 10.0
"""Longest range of such a look, m."""
DIFFERS = 0.4
"""Difference of ranges that a laser tells from noise and shifted furniture, m."""
COMPARED = 5
"""Places that are compared with the likeliest one."""


def disagreement(grid: GridMap, places: Sequence[Pose2D], spots: Array) -> Array:
    """How differently places would look from spots: 0..1 for each of spots (n, 2), base frame, m.

    The mean over the other places of the share of beams whose ranges differ from those of the first
    place. -1 where the first place has no free floor.
    """
    found = np.empty(len(spots))
    frame = np.array([*grid.origin, grid.resolution])
    for i, (x, y) in enumerate(spots):
        there = [place @ Pose2D(float(x), float(y), 0.0) for place in places[: COMPARED + 1]]
        if not _free(grid, there[0]):
            found[i] = -1.0
            continue
        looks = [_look(grid.cells, frame, p.x, p.y, p.yaw) for p in there]
        shares = [float((np.abs(look - looks[0]) > DIFFERS).mean()) for look in looks[1:]]
        found[i] = sum(shares) / len(shares) if shares else 0.0
    return found


def _free(grid: GridMap, pose: Pose2D) -> bool:
    return grid.contains(pose.x, pose.y) and grid.cells[grid.index(pose.x, pose.y)] == FREE


@numba.njit(cache=True)
def _look(cells: NDArray[np.uint8], frame: Array, x: float, y: float, yaw: float) -> Array:
    """Ranges (BEAMS,) around a pose of the map until something occupied, m; `REACH` beyond."""
    rows, columns = cells.shape
    ranges = np.full(BEAMS, REACH)
    for i in range(BEAMS):
        angle = yaw + 2.0 * math.pi * i / BEAMS
        dx, dy = math.cos(angle), math.sin(angle)
        way = 0.0
        while way < REACH:
            column = math.floor((x + dx * way - frame[0]) / frame[2])
            row = math.floor((y + dy * way - frame[1]) / frame[2])
            outside = not (0 <= row < rows and 0 <= column < columns)
            if outside or cells[row, column] == OCCUPIED:
                ranges[i] = way
                break
            way += frame[2]
    return ranges
