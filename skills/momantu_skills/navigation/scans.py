"""Laser scans as rays on the floor plan, seen from the base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import LaserScan

SPREAD = 0.12
"""m between hits that count as independent: beyond the noise of one, below any wall's length."""


@dataclass(frozen=True, slots=True, eq=False)
class Rays:
    """One scan in the base frame, projected onto the floor.

    origin: (2,) where the beams start, m. directions: (n, 2) unit vectors. ranges: (n,) m.
    hit: (n,) bool, which beams met something within the sensor's range.
    """

    origin: Array
    directions: Array
    ranges: Array
    hit: NDArray[np.bool_]

    @classmethod
    def from_scan(cls, scan: LaserScan, base_from_laser: Transform) -> Rays:
        """The scan of a laser whose beams lie in a horizontal plane, upside down or not."""
        angles = scan.angle_min + scan.angle_increment * np.arange(scan.ranges.size)
        flat = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
        directions = (flat @ base_from_laser.rotation.T)[:, :2]
        lengths = np.sqrt((directions**2).sum(axis=1, keepdims=True))
        good = (scan.ranges >= scan.range_min) & (scan.ranges < scan.range_max)
        return cls(
            base_from_laser.position[:2].copy(),
            np.ascontiguousarray(directions / lengths),
            np.array(scan.ranges, dtype=np.float64),
            np.asarray(good & np.isfinite(scan.ranges)),
        )

    def points(self) -> Array:
        """Where the hits are: (k, 2) in the base frame, m."""
        return np.asarray(self.origin + self.directions[self.hit] * self.ranges[self.hit, None])

    def thinned(self, count: int) -> Array:
        """About `count` hits, evenly spread over what was hit: (k, 2) in the base frame, m.

        One hit per cell of `SPREAD` comes first: a table right before the robot fills half of the
        view, and is not worth more than the wall behind it.
        """
        points = self.points()
        cells = np.floor(points / SPREAD).astype(np.int64)
        _, first = np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)
        points = points[np.sort(first)]
        step = max(1, len(points) // count)
        return np.ascontiguousarray(points[step // 2 :: step])
