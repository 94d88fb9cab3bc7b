"""Noticing sensors that answer with unreliable readings.

A real reading is never the same twice: it has noise, and a robot that moves sees something else.
A driver that goes on giving its last reading under new stamps looks healthy to everyone else. So
does a laser with dirt on its lens, which gives the least range over a whole sector: what stands
there would stand in the robot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.failure import SENSOR_DEAD, Failure
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage, LaserScan, RobotState
from momantu_bt.robot import CameraSensor, RobotDescription, SensorReading

SHIFT = 0.04
"""m the base must have moved since the reading was new."""
TURN = 0.04
"""rad that the base, or a joint that carries the camera, must have turned since."""


COVERED = 0.15
"""Neighbouring beams at the least range over this angle, rad, mean that the lens is covered."""
AT_LENS = 0.01
"""m beyond the least range that still count as it."""


@dataclass(slots=True)
class _Seen:
    reading: SensorReading
    odom_from_base: Transform
    carrier: Array


class SensorCheck:
    """Remembers each sensor's last new reading and the robot's pose at its time."""

    def __init__(self, description: RobotDescription) -> None:
        self._description = description
        self._seen: dict[str, _Seen] = {}

    def check(self, sensor: str, reading: SensorReading, state: RobotState) -> None:
        """Check a new reading.

        Raises:
            Failure: SENSOR_DEAD, when it repeats an older one though the robot has moved since, or
                a laser's lens is covered.
        """
        if isinstance(reading, LaserScan):
            _check_lens(sensor, reading)
        last = self._seen.get(sensor)
        if last is not None and reading is last.reading:
            return
        here, carrier = state.odom_from_base, self._carrier(sensor, state)
        if last is None or reading.stamp <= last.reading.stamp or not same(reading, last.reading):
            self._seen[sensor] = _Seen(reading, here, carrier)
            return
        shift = float(np.linalg.norm(here.position - last.odom_from_base.position))
        turn = max(here.angle_to(last.odom_from_base), _largest(carrier - last.carrier))
        if shift > SHIFT or turn > TURN:
            age = reading.stamp - last.reading.stamp
            raise Failure(
                SENSOR_DEAD,
                f"{sensor} has repeated the same reading for {age:.2f} s while the robot moved",
                sensor=sensor,
                age=age,
                shift=shift,
                turn=turn,
            )

    def _carrier(self, sensor: str, state: RobotState) -> Array:
        """Positions of the joints that carry a camera; of other sensors the base alone counts."""
        spec = self._description.sensors.get(sensor)
        if not isinstance(spec, CameraSensor) or spec.carrier is None:
            return np.zeros(0)
        joints = self._description.actuators[spec.carrier].joints
        return np.array([state.position(name) for name in joints if name in state.names])


def _check_lens(sensor: str, scan: LaserScan) -> None:
    at_lens = np.concatenate(([0], scan.ranges <= scan.range_min + AT_LENS, [0]))
    ends = np.flatnonzero(np.diff(at_lens.astype(np.int8)))
    if not len(ends):
        return
    first, beyond = ends[::2], ends[1::2]
    widest = int(np.argmax(beyond - first))
    width = int(beyond[widest] - first[widest]) * scan.angle_increment
    if width > COVERED:
        middle = scan.angle_min + 0.5 * (first[widest] + beyond[widest] - 1) * scan.angle_increment
        raise Failure(
            SENSOR_DEAD,
            f"{sensor} gives its least range over {math.degrees(width):.0f} degrees around "
            f"{math.degrees(middle):.0f}: something covers its lens",
            sensor=sensor,
            width=width,
            middle=float(middle),
        )


def same(one: SensorReading, other: SensorReading) -> bool:
    """Whether two readings say the same, and say anything at all."""
    if isinstance(one, LaserScan) and isinstance(other, LaserScan):
        return np.array_equal(one.ranges, other.ranges) and bool((one.ranges < one.range_max).any())
    if isinstance(one, CameraImage) and isinstance(other, CameraImage):
        return (
            np.array_equal(one.depth, other.depth)
            and np.array_equal(one.color, other.color)
            and (bool(one.depth.any()) or bool(one.color.any()))
        )
    return False


def _largest(change: Array) -> float:
    return float(np.abs(change).max()) if len(change) else 0.0
