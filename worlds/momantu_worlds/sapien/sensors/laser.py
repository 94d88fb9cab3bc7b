"""Planar laser scans: from rays, or from the points of a lidar.

Rays are cast at the static bodies, and at a horizontal cut through each moving body.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import LaserScan, PointCloud, frozen
from momantu_bt.robot import LaserSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.config import LaserErrors
from momantu_worlds.sapien.sensors.rays import Triangles


class Laser:
    """A planar scanner; its rays pass through the robot's own body.

    still: all static bodies, in the map.
    """

    def __init__(
        self,
        map_from_laser: Callable[[], Transform],
        name: str,
        sensor: LaserSensor,
        still: Triangles,
        moving: list[MovingBody],
        seed: int,
        errors: LaserErrors,
    ) -> None:
        self._map_from_laser = map_from_laser
        self._name, self._sensor = name, sensor
        self._moving, self._seed, self._errors = moving, seed, errors
        self._still = still
        angles = np.linspace(sensor.angle_min, sensor.angle_max, sensor.beams)
        self._beams = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)

    def read(self, stamp: float) -> LaserScan:
        """Take a scan now."""
        sensor, errors = self._sensor, self._errors
        ranges = self.exact()
        random = seeded(self._seed, self._name, stamp)
        ranges = ranges + errors.range_noise * random.standard_normal(sensor.beams)
        lost = random.random(sensor.beams) < errors.drop_out
        ranges[lost | (ranges > sensor.range_max)] = sensor.range_max
        ranges = np.maximum(ranges, sensor.range_min)
        return scan_of(sensor, stamp, ranges)

    def exact(self) -> Array:
        """Distances (beams,) without errors, m; infinite where nothing is hit."""
        pose = self._map_from_laser()
        directions = self._beams @ pose.rotation.T
        ranges = self._still.distances(pose.position, directions)
        for body in self._moving:
            segments = body.cut(pose.position, self._sensor.range_max)
            if len(segments):
                ranges = np.minimum(ranges, _to_segments(pose.position, directions, segments))
        return ranges


def scan_of(sensor: LaserSensor, stamp: float, ranges: Array) -> LaserScan:
    """The message of a scanner's distances (beams,), m."""
    return LaserScan(
        stamp,
        sensor.frame,
        sensor.angle_min,
        angle_step(sensor),
        sensor.range_min,
        sensor.range_max,
        np.asarray(frozen(ranges)),
    )


def angle_step(sensor: LaserSensor) -> float:
    """Angle between two neighbouring beams, rad."""
    return (sensor.angle_max - sensor.angle_min) / (sensor.beams - 1)


def _to_segments(origin: Array, directions: Array, segments: Array) -> Array:
    """Distance (n,) along flat rays to the nearest of segments (m, 2, 2); infinite if none."""
    a = segments[:, 0] - origin[:2]
    edge = segments[:, 1] - segments[:, 0]
    dx, dy = directions[:, 0, None], directions[:, 1, None]
    across = dx * edge[:, 1] - dy * edge[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (a[:, 0] * edge[:, 1] - a[:, 1] * edge[:, 0]) / across
        share = (a[:, 0] * dy - a[:, 1] * dx) / across
    ok = (along > 0.0) & (share >= 0.0) & (share <= 1.0)
    return np.asarray(np.where(ok, along, np.inf).min(axis=1))


class BandLaser:
    """Uses the points within a band of heights above the floor.

    cloud: returns the lidar's points of a stamp, as if all were of that instant. base_from_lidar,
    base_from_laser: from the description, not the true ones, as in a robot's driver.
    """

    def __init__(
        self,
        cloud: Callable[[float], PointCloud],
        sensor: LaserSensor,
        base_from_lidar: Transform,
        base_from_laser: Transform,
    ) -> None:
        assert sensor.band is not None
        self._cloud, self._sensor, self._band = cloud, sensor, sensor.band
        self._base_from_lidar = base_from_lidar
        self._laser_from_base = base_from_laser.inverse()

    def read(self, stamp: float) -> LaserScan:
        """Take a scan now."""
        return scan_of(self._sensor, stamp, self._nearest(self._cloud(stamp).points))

    def _nearest(self, points: NDArray[np.float32]) -> Array:
        """Distance (beams,) to the nearest point of each sector, m; range_max if there is none."""
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
