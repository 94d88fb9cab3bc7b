"""A costmap where no map is known: free until something is seen."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.formats.maps import FREE
from momantu_bt.messages import frozen
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap

RESOLUTION = 0.05
"""Edge of a cell, m."""


def unmapped(
    low: tuple[float, float], high: tuple[float, float], config: NavigationConfig
) -> Costmap:
    """An empty costmap from a lower left to an upper right corner, m; beyond it nothing is free."""
    columns, rows = (
        max(1, math.ceil((b - a) / RESOLUTION)) for a, b in zip(low, high, strict=True)
    )
    cells = frozen(np.full((rows, columns), FREE, dtype=np.uint8))
    return Costmap(GridMap(cells, RESOLUTION, low), None, config)
