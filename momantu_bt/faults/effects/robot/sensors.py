"""Faulty sensors: they do not answer, repeat their last reading, or are partly covered."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.layer import Layer
from momantu_bt.messages import LaserScan, frozen
from momantu_bt.robot import CameraSensor, LaserSensor, Robot, SensorReading


class SensorLayer(Layer):
    """A layer around all sensors of one kind; raises KeyError if the robot has none."""

    sensor: ClassVar[type[Any]]

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        sensors = inner.description.sensors
        self.names = tuple(n for n, about in sensors.items() if isinstance(about, self.sensor))
        if not self.names:
            having = ", ".join(sensors) or "none"
            raise KeyError(f"the robot has no {fault.component}; its sensors: {having}")
        self._newest: dict[str, tuple[SensorReading, SensorReading]] = {}

    def read(self, sensor: str) -> SensorReading:
        """The altered reading; two reads at the same instant give the same reading."""
        if not self.active or sensor not in self.names:
            return self.inner.read(sensor)
        reading = self.inner.read(sensor)
        known = self._newest.get(sensor)
        if known is None or known[0] is not reading:
            known = self._newest[sensor] = (reading, self.altered(sensor, reading))
        return known[1]

    def altered(self, sensor: str, reading: Any) -> SensorReading:
        """The reading that replaces the real one."""
        raise NotImplementedError(f"{type(self).__name__} has no altered()")


class _Dead(SensorLayer):
    def read(self, sensor: str) -> SensorReading:
        """Give no reading.

        Raises:
            Failure: SENSOR_DEAD.
        """
        if self.active and sensor in self.names:
            raise Failure(SENSOR_DEAD, f"{sensor} does not answer", sensor=sensor)
        return self.inner.read(sensor)


class _Repeating(SensorLayer):
    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self._held: dict[str, SensorReading] = {}

    def begin(self) -> None:
        """Keep what each sensor sees now; one that is dead stays dead."""
        super().begin()
        for name in self.names:
            try:
                self._held[name] = self.inner.read(name)
            except Failure:
                self._held.pop(name, None)

    def read(self, sensor: str) -> SensorReading:
        """The reading from the beginning of the fault, with the current stamp."""
        held = self._held.get(sensor)
        if not self.active or held is None:
            return self.inner.read(sensor)
        stamp = self.inner.state().stamp
        if held.stamp != stamp:
            held = self._held[sensor] = replace(held, stamp=stamp)
        return held


class DeadCamera(_Dead):
    """`camera.dead`."""

    sensor = CameraSensor


class FrozenCamera(_Repeating):
    """`camera.frozen`."""

    sensor = CameraSensor


class DeadLaser(_Dead):
    """`laser.dead`."""

    sensor = LaserSensor


class StuckLaser(_Repeating):
    """`laser.stuck`."""

    sensor = LaserSensor


class BlockedLaser(SensorLayer):
    """`laser.blocked`: the beams of a sector report the least range."""

    sensor = LaserSensor

    def altered(self, sensor: str, reading: LaserScan) -> LaserScan:
        """The scan with the sector blocked."""
        angles = reading.angle_min + reading.angle_increment * np.arange(len(reading.ranges))
        away = np.abs((angles - self.number("at") + np.pi) % (2.0 * np.pi) - np.pi)
        blocked = away <= self.number("width") / 2.0
        ranges = np.where(blocked, reading.range_min, reading.ranges)
        return replace(reading, ranges=np.asarray(frozen(ranges)))
