"""The base's motion between two matches: turning by the gyroscopes, way by the wheels."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from momantu_bt.geometry import (
    Array,
    Transform,
    matrix_from_quaternion,
    quaternion_from_axis_angle,
    quaternion_product,
)
from momantu_bt.messages import GRAVITY, ImuReading
from momantu_bt.motion import Motion

KEPT = 1.0
"""Age of the oldest pose that is remembered, s: more than a turn of any lidar."""
RESTING = 1e-4
"""Motion of the wheels between two readings below which the base stands, m and rad."""
MOST_RESTING = 2000
"""Samples at rest whose mean is the gyroscopes' bias; later ones count as one of so many."""
TILTED = 0.5
"""Specific force, m/s2, by which its length may differ from gravity's: more is a bump."""
_SPAN = 0.2
"""Time over which specific forces are averaged, s: a few samples of the wheels."""


class Reckoning:
    """Follows odometry and IMU; its own frame, `start`, lies where the base was at first."""

    def __init__(self, base_from_imu: Transform, *, measured: bool = True) -> None:
        """Begin without a pose. measured: odometry is, so that it tells when the base rests."""
        self._measured = measured
        self._turn, self._lever = base_from_imu.rotation, base_from_imu.position
        self._poses: deque[tuple[float, Transform]] = deque()
        self._forces: deque[tuple[float, Array]] = deque()
        self._odometry: Transform | None = None
        self._sampled = -math.inf
        self._resting = 0
        self._bias = np.zeros(3)

    def add(self, stamp: float, odom_from_base: Transform, imu: ImuReading | None) -> None:
        """Go on to `stamp`, with the pose that odometry has then and the IMU's newest samples.

        Without new samples, odometry tells how the base turned.
        """
        times, rates = self._sensed(imu)
        before, self._odometry = self._odometry, odom_from_base
        if before is None:
            self._poses.append((stamp, Transform()))
            return
        step = before.inverse() @ odom_from_base
        moved = float(np.linalg.norm(step.position)) + before.angle_to(odom_from_base)
        if self._measured and moved < RESTING:
            self._rest(rates)
        self._go(stamp, times, rates - self._bias, step)
        while self._poses[0][0] < stamp - KEPT:
            self._poses.popleft()
        while self._forces and self._forces[0][0] < stamp - _SPAN:
            self._forces.popleft()

    def _sensed(self, imu: ImuReading | None) -> tuple[Array, Array]:
        """Times (k,) and rates (k, 3) of the new samples, in base; keeps their forces."""
        if imu is None:
            return np.zeros(0), np.zeros((0, 3))
        new = imu.times > self._sampled
        self._sampled = float(imu.times[-1])
        for time, force in zip(imu.times[new], imu.forces[new] @ self._turn.T, strict=True):
            self._forces.append((float(time), force))
        return imu.times[new], imu.rates[new] @ self._turn.T

    def _rest(self, rates: Array) -> None:
        for rate in rates:
            self._resting = min(self._resting + 1, MOST_RESTING)
            self._bias = self._bias + (rate - self._bias) / self._resting

    def _go(self, stamp: float, times: Array, rates: Array, step: Transform) -> None:
        """Turn from sample to sample, evenly along the way; without samples as the step does."""
        begin, last = self._poses[-1]
        if stamp <= begin:
            return
        if not len(rates):
            self._poses.append((stamp, last @ step))
            return
        way = last.rotation @ step.position
        turned, at = last.quaternion, begin
        ends = [*(float(time) for time in times if time < stamp), stamp]
        for number, end in enumerate(ends):
            rate = rates[min(number, len(rates) - 1)]
            turned = quaternion_product(turned, _turned(rate * (end - at)))
            at = end
            share = (end - begin) / (stamp - begin)
            self._poses.append((end, Transform(last.position + share * way, turned)))

    @property
    def newest(self) -> Transform:
        """`start_from_base` now."""
        return self._poses[-1][1]

    @property
    def motion(self) -> Motion:
        """`start_from_base` during the last second."""
        return Motion.of(*zip(*self._poses, strict=True))

    @property
    def up(self) -> Array | None:
        """Direction (3,) away from the earth's middle, in base; None where a bump hides it.

        The mean specific force of the last samples, less how the wheels say that the base sped up.
        """
        if not self._forces or len(self._poses) < 3:
            return None
        force = np.mean([each for _, each in self._forces], axis=0) - self._sped_up()
        length = float(np.linalg.norm(force))
        return None if abs(length - GRAVITY) > TILTED else np.asarray(force / length)

    def _sped_up(self) -> Array:
        """Mean acceleration (3,) over the time of the forces, in base; that of the base's way."""
        times = np.array([time for time, _ in self._poses])
        now, begin = float(times[-1]), float(max(times[-1] - _SPAN, times[0]))
        middle = 0.5 * (begin + now)
        if middle - begin < 1e-3:
            return np.zeros(3)
        _, places = self.motion.at(np.array([begin, middle, now]))
        change = (places[2] - 2.0 * places[1] + places[0]) / (middle - begin) ** 2
        return np.asarray(matrix_from_quaternion(self.newest.quaternion).T @ change)


def _turned(vector: Array) -> Array:
    """The quaternion of a rotation vector (3,), rad."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.array([1.0, 0.0, 0.0, 0.0])
    return quaternion_from_axis_angle(vector, angle)


def straightened(
    points: Array, times: Array, stamp: float, base_from_lidar: Transform, motion: Motion
) -> Array:
    """Points (n, 3) of a turn as if all were measured at `stamp`, in the base of then.

    times: (n,) s after the stamp. motion: of the base, in any frame that stands still.
    """
    turns, places = motion.at(stamp + times)
    still = np.einsum("nij,nj->ni", turns, base_from_lidar.apply(points)) + places
    turn, place = motion.at(np.array([stamp]))
    return np.asarray((still - place[0]) @ turn[0])
