"""A planar scan that is made from a lidar's points: the nearest in each direction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import LaserScan, PointCloud
from momantu_bt.robot import LaserSensor
from momantu_worlds.sapien.sensors.laser import angle_step, scan_of


class BandLaser:
    """Takes the points within a band of heights above the floor.

    cloud: gives the lidar's points of now. base_from_lidar, base_from_laser: as described, for
    this is what a robot's driver computes, not what is true.
    """

    def __init__(
        self,
        cloud: Callable[[], PointCloud],
        sensor: LaserSensor,
        base_from_lidar: Transform,
        base_from_laser: Transform,
    ) -> None:
        assert sensor.band is not None
        self._cloud, self._sensor, self._band = cloud, sensor, sensor.band
        self._base_from_lidar = base_from_lidar
        self._laser_from_base = base_from_laser.inverse()

    def read(self, stamp: float) -> LaserScan:
        """A scan of now."""
        return scan_of(self._sensor, stamp, self._nearest(self._cloud().points))

    def _nearest(self, points: NDArray[np.float32]) -> Array:
        """Distance (beams,) to the nearest point of each sector, m; range_max where none is."""
        sensor = self._sensor
        in_base = self._base_from_lidar.apply(points)
        low, high = self._band
        in_base = in_base[(in_base[:, 2] >= low) & (in_base[:, 2] <= high)]
        x, y, _ = self._laser_from_base.apply(in_base).T
        distances = np.hypot(x, y)
        sectors = np.rint((np.arctan2(y, x) - sensor.angle_min) / angle_step(sensor))
        sectors = sectors.astype(np.int64)
        seen = (sectors >= 0) & (sectors < sensor.beams)
        seen &= (distances >= sensor.range_min) & (distances <= sensor.range_max)
        ranges = np.full(sensor.beams, sensor.range_max)
        np.minimum.at(ranges, sectors[seen], distances[seen])
        return ranges
