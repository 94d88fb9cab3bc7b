"""The floor on which people walk: free cells among all bodies, and short ways over them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from momantu_bt.geometry import Array
from momantu_worlds.people.walker import RADIUS, Point
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.plane import Passages, passages
from momantu_worlds.scenes.geometry.prisms import body_prism

AIR = 0.05
"""Clearance that people keep from things, m."""
BORDER = 0.6
"""Floor beyond a stop, m."""
TALL = 1.8
"""What begins above this, m, is over everybody's head."""
ROUND = 0.75
"""Distance at which people who look for a way pass others, m: robots too."""
FROM_START = 1.5
"""Least distance of a person from the robot at first, m."""
NEAR = 0.5
"""A stop may be moved by so much to where there is room, m."""


class PeopleFloor:
    """Implements `Floor`, among the static bodies of an episode."""

    def __init__(self, bodies: Iterable[Body], stops: Sequence[Point] = ()) -> None:
        """bodies: all of an episode; loose ones lie on furniture. stops: where people want to be.

        The floor ends at the outermost walls, or beyond the outermost stops.
        """
        found = [(body, body_prism(body, body.map_from_body)) for body in bodies if body.static]
        solid = [(body, prism) for body, prism in found if prism is not None and prism.top > 0.02]
        base = [prism.base for _, prism in solid if prism.bottom < TALL]
        walls = [prism.base for body, prism in solid if body.category == "wall"]
        wanted = np.array(stops).reshape(-1, 2)
        corners = np.concatenate(
            [*(each.corners() for each in walls or base), wanted - BORDER, wanted + BORDER]
        )
        low, high = corners.min(axis=0), corners.max(axis=0)
        middle, size = (low + high) / 2, high - low
        self._cells = passages(
            base,
            (float(middle[0]), float(middle[1])),
            (float(size[0]), float(size[1])),
            RADIUS + AIR,
        )

    def free(self, point: Point) -> bool:
        """Whether a person can be there."""
        return _free(self._cells, point)

    def stop(self, point: Point) -> Point | None:
        """The free point nearest to a wanted one; None if there is none near enough."""
        if self.free(point):
            return point
        if not self._cells.free.any():
            return None
        near = self._cells.nearest_free(point)
        return near if math.dist(near, point) <= NEAR else None

    def way(self, start: Point, end: Point, around: Sequence[Point] = ()) -> Array:
        """Corners (n, 2) of a short way, without the start; (0, 2) if there is none."""
        cells = self._cells
        rows, columns = cells.free.shape
        if around:
            free = cells.free.copy()
            y, x = np.mgrid[0:rows, 0:columns]
            x, y = cells.origin[0] + cells.cell * x, cells.origin[1] + cells.cell * y
            for other in around:
                free &= np.hypot(x - other[0], y - other[1]) > ROUND
            cells = Passages(cells.origin, cells.cell, free)
        if not cells.free.any():
            return np.zeros((0, 2))
        begin, last = cells.nearest_free(start), cells.nearest_free(end)
        if math.dist(begin, start) > ROUND + NEAR or math.dist(last, end) > NEAR:
            return np.zeros((0, 2))
        route = cells.route(begin, last)
        return _pulled(cells, route) if len(route) else route


def _free(cells: Passages, point: Point) -> bool:
    row, column = cells.index(point)
    rows, columns = cells.free.shape
    return bool(0 <= row < rows and 0 <= column < columns and cells.free[row, column])


def _pulled(cells: Passages, route: Array) -> Array:
    """The corners of a route by cells, pulled tight like a string."""
    corners, at, step = [route[0]], 0, 64
    while at < len(route) - 1:
        farthest = at + 1
        reach = min(len(route) - 1, at + step)
        for ahead in range(reach, at + 1, -1):
            if _sees(cells, route[at], route[ahead]):
                farthest = ahead
                break
        at = farthest
        corners.append(route[at])
    return np.array(corners)


def _sees(cells: Passages, a: Array, b: Array) -> bool:
    """Whether the straight line between two points passes free cells only."""
    count = max(2, math.ceil(float(np.hypot(*(b - a))) / (0.5 * cells.cell)))
    points = np.linspace(a, b, count)
    index = np.rint((points - np.array(cells.origin)) / cells.cell).astype(int)
    return bool(cells.free[index[:, 1], index[:, 0]].all())
