"""How well one scan fits the map, ignoring furniture that is not in the map."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.map.fields import Field, sample
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

HIT = 0.15
"""A beam that ends within this distance of a mapped surface is explained, m: three times its usual
spread."""
SHORT_COUNTS = 0.4
"""Weight of a beam that ends early in free space: weak evidence against a pose, as people move
furniture."""
BEAMS = 120
"""Number of beams that are used: one in five or six of a usual scan."""


def scan_fit(grid: GridMap, field: Field, pose: Pose2D, rays: Rays) -> float:
    """0..1: explained beams divided by explained, contradicting and (with less weight) early ones.

    A beam contradicts the pose if it passed through an occupied cell of the map. A scan without any
    hit gives 0, as it says nothing about the pose.
    """
    step = max(1, rays.ranges.size // BEAMS)
    chosen = np.zeros(rays.ranges.size, dtype=np.bool_)
    chosen[step // 2 :: step] = True
    chosen &= rays.hit
    kept = Rays(rays.origin, rays.directions[chosen], rays.ranges[chosen], chosen[chosen])
    hits, early, through = beam_counts(grid, field, pose, kept)
    weight = hits + through + SHORT_COUNTS * early
    return float(hits / weight) if weight > 0 else 0.0


def beam_counts(grid: GridMap, field: Field, pose: Pose2D, rays: Rays) -> tuple[int, int, int]:
    """How many beams, all of them hits, are explained, end early, and contradict the pose."""
    counts: tuple[int, int, int] = _count(
        grid.cells,
        field,
        np.array([*grid.origin, grid.resolution]),
        np.array([pose.x, pose.y, pose.yaw]),
        rays.origin,
        rays.directions,
        rays.ranges,
    )
    return counts


@numba.njit(cache=True)
def _count(
    cells: NDArray[np.uint8],
    field: Field,
    frame: Array,
    pose: Array,
    origin: Array,
    directions: Array,
    ranges: Array,
) -> tuple[int, int, int]:
    rows, columns = cells.shape
    resolution = frame[2]
    c = math.cos(pose[2])
    s = math.sin(pose[2])
    x = (pose[0] + c * origin[0] - s * origin[1] - frame[0]) / resolution
    y = (pose[1] + s * origin[0] + c * origin[1] - frame[1]) / resolution
    hits = early = through = 0
    for i in range(ranges.shape[0]):
        dx = c * directions[i, 0] - s * directions[i, 1]
        dy = s * directions[i, 0] + c * directions[i, 1]
        length = ranges[i] / resolution
        d = sample(field, x + dx * length - 0.5, y + dy * length - 0.5, 1e9)
        if d < HIT:
            hits += 1
            continue
        blocked = d > 1e8
        walked = 0.0
        while walked < length and not blocked:
            column = math.floor(x + dx * walked)
            row = math.floor(y + dy * walked)
            inside = 0 <= row < rows and 0 <= column < columns
            blocked = (not inside) or cells[row, column] == OCCUPIED
            walked += 1.0
        if blocked:
            through += 1
        else:
            early += 1
    return hits, early, through
