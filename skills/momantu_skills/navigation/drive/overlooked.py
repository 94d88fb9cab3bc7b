"""What pictures showed and the laser looks over or under: points near the moving base, in odom."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from momantu_bt.geometry import Array, Pose2D

CELL = 0.05
"""Edge of the cells that points are gathered in, m."""
POINTS = 3
"""Fewest points that a cell needs: single ones lie between near and far edges."""
EXPLAINED = 0.12
"""Distance from a hit of the laser within which a point shows what the laser sees too, m."""
KEPT = 4.0
"""Distance from the base up to which points are kept, m."""


class Overlooked:
    """Points that the collision guard takes for hits, besides those of the newest scan.

    They are kept in odom, so a wrong estimate of the place on the map does not move them.
    """

    def __init__(self) -> None:
        """Know of nothing."""
        self._there = np.zeros((0, 2))

    def see(self, odom_from_base: Pose2D, obstacles: Array, floor: Array, hits: Array) -> None:
        """Enter a picture; where it shows floor, earlier points are forgotten.

        obstacles: points (n, 3); floor: points (m, 2) of free floor; hits: points (k, 2) of the
        newest scan; all in the base frame, m.
        """
        points = obstacles[:, :2]
        if len(points) and len(hits):
            off, _ = cKDTree(hits).query(points, distance_upper_bound=EXPLAINED)
            points = points[off > EXPLAINED]
        fresh, bare = (_gathered(odom_from_base.apply(own)) for own in (points, floor))
        seen = np.concatenate([_keys(fresh), _keys(bare)])
        there = np.vstack([self._there[~np.isin(_keys(self._there), seen)], fresh])
        far = np.hypot(*(there - (odom_from_base.x, odom_from_base.y)).T)
        self._there = there[far < KEPT]

    def near(self, odom_from_base: Pose2D, reach: float) -> Array:
        """Points (n, 2) within `reach` m of the base, base frame, m."""
        points = odom_from_base.inverse().apply(self._there)
        return np.asarray(points[np.hypot(points[:, 0], points[:, 1]) < reach])


def _gathered(points: Array) -> Array:
    """The mean (k, 2) of the points (n, 2) in each cell that has enough of them."""
    _, cell, count = np.unique(_keys(points), return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(cell, weights=part, minlength=len(count)) for part in points.T])
    return np.asarray((sums / count).T[count >= POINTS])


def _keys(points: Array) -> NDArray[np.int64]:
    """A number (n,) for the cell of each point (n, 2)."""
    cells = np.floor(points / CELL).astype(np.int64)
    return np.asarray(cells[:, 0] * 1_000_003 + cells[:, 1])
