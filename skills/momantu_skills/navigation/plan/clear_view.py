"""Whether walls and furniture on a map stand between a place and the point that it faces."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.maps import FREE
from momantu_bt.geometry import Pose2D
from momantu_bt.redrawing import DRAWN
from momantu_bt.world import Surface
from momantu_skills.navigation.map.believed import raster
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.goals import Stand

Mask = NDArray[np.bool_]


def beside(surface: Surface, cells: Mask, grid: GridMap) -> Mask:
    """Those of the cells (rows, columns) of a map that do not show the surface itself."""
    return np.asarray(cells & ~raster(grid).on(surface, DRAWN))


def is_hidden(grid: GridMap, hiding: Mask, pose: Pose2D, point: tuple[float, float]) -> bool:
    """Whether a cell that is `hiding` lies between a pose and a point (x, y), or one is off it."""
    steps = max(2, math.ceil(math.dist((pose.x, pose.y), point) / grid.resolution) + 1)
    for x, y in np.linspace((pose.x, pose.y), point, steps):
        if not grid.contains(x, y) or hiding[grid.index(x, y)]:
            return True
    return False


def in_view(
    stands: list[Stand], point: tuple[float, float], surface: Surface, grid: GridMap
) -> list[Stand]:
    """The stands from which known, free floor leads to a surface that has the point (x, y).

    A place behind a wall is as near to it as one before it. All stands if there is no such floor:
    something low may stand before the surface, or nobody has been there.
    """
    hiding = beside(surface, grid.cells != FREE, grid)
    found = [stand for stand in stands if not is_hidden(grid, hiding, stand.pose, point)]
    return found or stands
