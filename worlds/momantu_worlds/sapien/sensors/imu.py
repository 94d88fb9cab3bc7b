"""An IMU: how its frame turns, and the specific force on it, sampled between physics steps."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, matrix_from_quaternion
from momantu_bt.messages import GRAVITY, ImuReading, frozen
from momantu_bt.robot import ImuSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.config import ImuErrors

AT_REST = np.array([0.0, 0.0, GRAVITY])
"""Specific force at rest, m/s2, in the map."""
KEPT = 0.25
"""Age of the oldest sample of a reading, s: who reads at 4 Hz misses none."""
_SLACK = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Moving:
    """How a frame moves: map_from_frame as a rotation (3, 3), velocity and turning (3,) in map."""

    rotation: Array
    velocity: Array
    turning: Array


class Imu:
    """Samples from its first reading on; until then nothing is computed.

    moving: how the sensor's frame moves now. asked: whether it was read, so that `collect` is
    wanted after each physics step.
    """

    def __init__(
        self,
        moving: Callable[[], Moving],
        name: str,
        sensor: ImuSensor,
        seed: int,
        errors: ImuErrors,
    ) -> None:
        self._moving, self._name, self._sensor = moving, name, sensor
        self._seed, self._errors = seed, errors
        random = seeded(seed, name, "bias")
        self._rate_bias = errors.rate_bias * random.standard_normal(3)
        self._force_bias = errors.force_bias * random.standard_normal(3)
        self._samples: deque[tuple[float, Array, Array]] = deque()
        self._before: tuple[float, Array] | None = None
        self.asked = False

    def read(self, stamp: float) -> ImuReading:
        """The samples of the last quarter of a second; the first reading has one sample."""
        if not self.asked:
            self.asked = True
            self._sample(stamp)
        times, rates, forces = (np.array(each) for each in zip(*self._samples, strict=True))
        last = float(times[-1])
        return ImuReading(last, self._sensor.frame, frozen(times), frozen(rates), frozen(forces))

    def collect(self, now: float) -> None:
        """Take a sample if one is due at `now`, the end of a physics step."""
        assert self._before is not None
        period = 1.0 / self._sensor.rate
        if math.floor(now / period + _SLACK) > math.floor(self._before[0] / period + _SLACK):
            self._sample(now)

    def _sample(self, now: float) -> None:
        """What the frame's motion since the last sample makes of a sample now."""
        moving, before = self._moving(), self._before
        span = 1.0 / self._sensor.rate if before is None else now - before[0]
        change = np.zeros(3) if before is None else (moving.velocity - before[1]) / span
        self._before = now, moving.velocity
        random, errors = seeded(self._seed, self._name, now), self._errors
        spread = 1.0 / math.sqrt(span)  # of white noise of density 1 over the span
        rate = moving.rotation.T @ moving.turning + self._rate_bias
        rate = rate + errors.rate_noise * spread * random.standard_normal(3)
        force = moving.rotation.T @ (change + AT_REST) + self._force_bias
        force = force + errors.force_noise * spread * random.standard_normal(3)
        self._samples.append((now, rate, force))
        while self._samples[0][0] < now - KEPT:
            self._samples.popleft()


def moving_link(link: Any) -> Callable[[], Moving]:
    """How a link of an articulation moves at its own origin; PhysX tells its centre of mass."""

    def now() -> Moving:
        pose = link.entity_pose
        rotation = matrix_from_quaternion(pose.q)
        turning = np.asarray(link.get_angular_velocity(), dtype=np.float64)
        lever = rotation @ np.asarray(link.cmass_local_pose.p, dtype=np.float64)
        velocity = np.asarray(link.get_linear_velocity(), dtype=np.float64)
        return Moving(rotation, velocity - np.cross(turning, lever), turning)

    return now
