"""Where a frame was while a sensor measured: poses over time, and what lies between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from momantu_bt.geometry import Array, Transform

_SMALL = 1e-8
"""Sine of half a turn below which interpolation is linear."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Poses of one frame in another.

    times: (k,) s, rising. positions: (k, 3) m. quaternions: (k, 4).
    """

    times: Array
    positions: Array
    quaternions: Array

    @classmethod
    def of(cls, times: Sequence[float], poses: Sequence[Transform]) -> Self:
        """From poses at their times; at least one."""
        return cls(
            np.array(times, dtype=np.float64),
            np.array([pose.position for pose in poses]),
            np.array([pose.quaternion for pose in poses]),
        )

    def at(self, times: Array) -> tuple[Array, Array]:
        """Rotations (n, 3, 3) and positions (n, 3): linear and slerp; the end poses beyond them."""
        after = np.clip(np.searchsorted(self.times, times), 1, max(len(self.times) - 1, 1))
        before, after = after - 1, np.minimum(after, len(self.times) - 1)
        width = self.times[after] - self.times[before]
        share = np.clip((times - self.times[before]) / np.where(width > 0, width, 1.0), 0.0, 1.0)
        positions = (1.0 - share[:, None]) * self.positions[before]
        positions += share[:, None] * self.positions[after]
        turned = slerp(self.quaternions[before], self.quaternions[after], share)
        return rotations(turned), positions


def slerp(first: Array, second: Array, share: Array) -> Array:
    """Quaternions (n, 4) on the shorter way between two rows of quaternions (n, 4)."""
    cosine = (first * second).sum(axis=1)
    second = np.where(cosine[:, None] < 0, -second, second)
    angle = np.arccos(np.clip(abs(cosine), 0.0, 1.0))
    sine = np.sin(angle)
    small = sine < _SMALL
    safe = np.where(small, 1.0, sine)
    weight = np.where(small, 1 - share, np.sin((1 - share) * angle) / safe)
    other = np.where(small, share, np.sin(share * angle) / safe)
    return np.asarray(weight[:, None] * first + other[:, None] * second)


def rotations(quaternions: Array) -> Array:
    """Rotations (n, 3, 3) of unit quaternions (n, 4), w x y z."""
    w, x, y, z = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)
