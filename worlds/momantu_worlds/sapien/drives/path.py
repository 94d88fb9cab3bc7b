"""Following a joint trajectory at variable pace: cubic Hermite interpolation and braking."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory

BLEND = 0.3
"""Time over which a difference between the start and the commanded joints is faded out, s."""
LEAST_SHARE = 0.25
"""Share of the acceleration limit that braking may always use, even on curved parts of the path."""
FASTEST_BRAKE = 20.0
"""Largest decrease of the pace per second, 1/s, where the joints hardly move and the limits allow
any."""


class Path:
    """A trajectory with its own time, which advances at a pace of 0..1.

    columns: indices of the drive's joints in the trajectory. start: the joints' commanded positions
    and velocities (n,) now; if the trajectory starts elsewhere, the difference is faded out over
    BLEND. offset (n,): measured minus true angles; trajectories are in measured angles, the targets
    are true ones.
    """

    def __init__(
        self,
        trajectory: JointTrajectory,
        columns: list[int],
        start: tuple[Array, Array],
        offset: Array,
        acceleration: Array,
    ) -> None:
        self.trajectory = trajectory
        self._times = np.asarray(trajectory.times, dtype=np.float64)
        self._positions = np.asarray(trajectory.positions, dtype=np.float64)[:, columns] - offset
        self._velocities = np.asarray(trajectory.velocities, dtype=np.float64)[:, columns]
        self._position_error = start[0] - self._positions[0]
        self._velocity_error = start[1] - self._velocities[0]
        self._acceleration = acceleration
        self.time = 0.0
        self.pace = 1.0
        self.pace_goal = 1.0

    @property
    def finished(self) -> bool:
        """Whether the end is reached."""
        return bool(self.time >= self._times[-1])

    @property
    def resting(self) -> bool:
        """Whether nothing moves: at the end, or after braking to a stop."""
        return self.finished or (self.pace == 0.0 and self.pace_goal == 0.0)

    def advance(self, step: float, count: int) -> tuple[Array, Array]:
        """Targets of the next `count` physics steps: positions and velocities (count, n)."""
        slope = self._brake() * step * (1.0 if self.pace_goal > self.pace else -1.0)
        paces = self.pace + slope * np.arange(1, count + 1)
        low, high = sorted((self.pace, self.pace_goal))
        paces = np.clip(paces, low, high)
        times = np.minimum(self.time + np.cumsum(paces) * step, self._times[-1])
        self.time, self.pace = float(times[-1]), float(paces[-1])
        positions, velocities, _ = self.sample(times)
        moving = (times < self._times[-1])[:, None] * paces[:, None]
        return positions, velocities * moving

    def sample(self, times: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (k, n) at path times (k,), at full pace."""
        if len(self._times) == 1:
            still = np.zeros((len(times), self._positions.shape[1]))
            return np.repeat(self._positions, len(times), axis=0), still, still
        i = np.clip(np.searchsorted(self._times, times, side="right") - 1, 0, len(self._times) - 2)
        h = (self._times[i + 1] - self._times[i])[:, None]
        u = (times - self._times[i])[:, None] / h
        a, b = self._positions[i], self._positions[i + 1]
        va, vb = self._velocities[i] * h, self._velocities[i + 1] * h
        # p(u) = a + u va + u^2 c + u^3 d meets both ends in position and slope
        c = 3.0 * (b - a) - 2.0 * va - vb
        d = 2.0 * (a - b) + va + vb
        position = a + u * (va + u * (c + u * d))
        velocity = (va + u * (2.0 * c + 3.0 * u * d)) / h
        acceleration = (2.0 * c + 6.0 * u * d) / (h * h)
        if float(times[0]) < BLEND:
            fade, slope = self._fade(times[:, None] / BLEND)
            position, velocity = position + fade, velocity + slope
        return position, velocity, acceleration

    def _fade(self, u: Array) -> tuple[Array, Array]:
        """The start's difference at shares `u` (k, 1) of BLEND, and its rate: both are 0 at 1."""
        u = np.minimum(u, 1.0)
        e, v = self._position_error, self._velocity_error * BLEND
        fade = (1.0 - u) ** 2 * ((1.0 + 2.0 * u) * e + u * v)
        slope = (1.0 - u) * ((1.0 - 3.0 * u) * v - 6.0 * u * e) / BLEND
        return fade, slope

    def _brake(self) -> float:
        """Decrease of the pace per second within all joints' acceleration limits, 1/s."""
        _, velocity, acceleration = self.sample(np.array([self.time]))
        used = np.abs(acceleration[0]) * self.pace**2
        free = np.maximum(self._acceleration - used, LEAST_SHARE * self._acceleration)
        speed = np.abs(velocity[0])
        return float(np.min(free / np.maximum(speed, self._acceleration / FASTEST_BRAKE)))
