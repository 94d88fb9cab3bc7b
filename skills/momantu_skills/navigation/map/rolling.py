"""A costmap where no map is known: free until something is seen."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from momantu_bt.formats.maps import FREE
from momantu_bt.messages import frozen
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap

RESOLUTION = 0.05
"""Edge of a cell, m."""
DETOUR = 12.0
"""How far beyond the places it drives between a way may lead, m."""
FARTHEST = 100.0
"""Longest edge, m: beyond it a plan takes seconds."""
REACH = 12.0
"""Range up to which laser hits enter such a costmap, m: no map shows what is farther."""


def unmapped(around: Iterable[tuple[float, float]], config: NavigationConfig) -> Costmap:
    """An empty costmap around points (x, y), m; beyond its border nothing is free.

    The first of the points is in its middle if it would be too large otherwise.
    """
    points = np.array(list(around), dtype=np.float64)
    low, high = points.min(axis=0) - DETOUR, points.max(axis=0) + DETOUR
    low = np.maximum(low, points[0] - 0.5 * FARTHEST)
    high = np.minimum(high, points[0] + 0.5 * FARTHEST)
    columns, rows = (max(1, math.ceil(each / RESOLUTION)) for each in high - low)
    cells = frozen(np.full((rows, columns), FREE, dtype=np.uint8))
    farther = config.model_copy(update={"laser_reach": max(config.laser_reach, REACH)})
    return Costmap(GridMap(cells, RESOLUTION, (float(low[0]), float(low[1]))), None, farther)
