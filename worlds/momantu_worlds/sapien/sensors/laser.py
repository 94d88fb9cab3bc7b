"""The laser: rays against the still world, and a cut through whatever moves at its height."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import LaserScan, frozen
from momantu_bt.robot import LaserSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.config import LaserErrors
from momantu_worlds.sapien.sensors.rays import Triangles


class Laser:
    """A planar scanner that looks through its own robot's cover.

    still: all that never moves, in the map.
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
        """A scan of now."""
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
