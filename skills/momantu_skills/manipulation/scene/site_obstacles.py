"""Obstacles from the site's data: distances to walls and furniture, boxes over surfaces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np

from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.frames import MAP, ODOM, FrameBuffer
from momantu_bt.geometry import Array, Transform
from momantu_bt.world import Site, Surface
from momantu_skills.manipulation.model.collision import Obstacle
from momantu_skills.navigation.map.believed import believed_maps
from momantu_skills.navigation.map.fields import clearance

BESIDE = 0.04
"""Margin to all sides, m, for errors of the site's data and of localization."""
HIGHER = 0.02
"""Margin up and down, m."""


FAR = 10.0
"""Distance that is returned far from all obstacles, or without a map, m."""


@dataclass(frozen=True, eq=False)
class Overhead:
    """A box that hangs over a surface: `odom_from_box`, and half its edges (3,), m."""

    odom_from_box: Transform
    half: Array

    def obstacle(self, base_from_odom: Transform, name: str) -> Obstacle:
        """The solid, in base, enlarged by the margins."""
        half = self.half + np.array((BESIDE, BESIDE, HIGHER))
        corners = np.array(list(product((-1.0, 1.0), repeat=3))) * half
        return Obstacle(name, (base_from_odom @ self.odom_from_box).apply(corners))

    def distance(self, point: Array) -> float:
        """Distance along the floor from a point (3,) in odom, m; 0 below the box."""
        aside = np.abs(self.odom_from_box.inverse().apply(point)[:2]) - self.half[:2]
        return float(np.linalg.norm(np.maximum(aside, 0.0)))

    def between(self, start: Array, end: Array) -> bool:
        """Whether the straight line between two points (3,) in odom passes through the box.

        Slab method: the line's intervals between each pair of faces must overlap (Kay and Kajiya
        1986).
        """
        first, last = self.odom_from_box.inverse().apply(np.vstack([start, end]))
        way = last - first
        way = np.where(np.abs(way) < 1e-9, 1e-9, way)
        shares = np.sort(np.array([-self.half - first, self.half - first]) / way, axis=0)
        return bool(max(0.0, shares[0].max()) <= min(1.0, shares[1].min()))


def overhead_of(surface: Surface, odom_from_map: Transform) -> tuple[Overhead, ...]:
    """The boxes over a surface, according to the site."""
    found = []
    for one in surface.over:
        middle = one.map_from_overhang.transform((one.bottom + one.top) / 2)
        half = np.array([*one.size, one.top - one.bottom]) / 2
        found.append(Overhead(odom_from_map @ middle, half))
    return tuple(found)


def hanging(solids: Iterable[Overhead], base_from_odom: Transform, near: float) -> list[Obstacle]:
    """The boxes at most `near` m from the base, as solids for the arm."""
    base = base_from_odom.inverse().position
    return [
        solid.obstacle(base_from_odom, f"over {i}")
        for i, solid in enumerate(solids)
        if solid.distance(base) < near
    ]


class FloorPlan:
    """Distances to the obstacles on a site's maps: walls, furniture and overhanging parts."""

    def __init__(self, site: Site, frames: FrameBuffer) -> None:
        self._frames = frames
        grids = believed_maps(site)
        self._layers = [(g, clearance(g.cells == OCCUPIED, g.resolution)) for g in grids]

    def distance(self, points: Array) -> Array:
        """Distances (n,) along the floor from points (n, 3) in odom, m; FAR if not localized."""
        least = np.full(len(points), FAR)
        try:
            map_from_odom = self._frames.lookup(MAP, ODOM)
        except Failure as failure:
            if failure.code != FRAME_UNKNOWN:
                raise
            return least
        there = map_from_odom.apply(points)[:, :2]
        for grid, field in self._layers:
            cells = np.floor((there - np.array(grid.origin)) / grid.resolution).astype(np.int64)
            rows, columns = field.shape
            on = (cells >= 0).all(axis=1) & (cells[:, 0] < columns) & (cells[:, 1] < rows)
            least[on] = np.minimum(least[on], field[cells[on, 1], cells[on, 0]])
        return least
