"""A laser with part of its lens covered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from momantu_bt.faults.robot.sensors import SensorLayer
from momantu_bt.messages import LaserScan, frozen
from momantu_bt.robot import LaserSensor


class Blocked(SensorLayer):
    """`laser.blocked`: the beams of a sector give the least range."""

    sensor = LaserSensor

    def altered(self, sensor: str, reading: LaserScan) -> LaserScan:
        """The scan with the sector blocked."""
        angles = reading.angle_min + reading.angle_increment * np.arange(len(reading.ranges))
        away = np.abs((angles - self.number("at") + np.pi) % (2.0 * np.pi) - np.pi)
        blocked = away <= self.number("width") / 2.0
        ranges = np.where(blocked, reading.range_min, reading.ranges)
        return replace(reading, ranges=np.asarray(frozen(ranges)))
