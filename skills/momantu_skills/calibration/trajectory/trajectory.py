"""One frame's pose over time, and its pose between two samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_bt.motion import slerp
from momantu_skills.calibration.poses import Mask, Poses, rotations_of_quaternions

NEAR = 1e-3
"""s: a sample this near in time is taken as it is, however far the next one is."""


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """N samples in ascending time.

    name: in messages. times: (N,) in s. positions: (N, 3) in m. quaternions: (N, 4), unit, w x y z.
    lines: (N,) of the file that the samples come from, from 1.
    """

    name: str
    times: Array
    positions: Array
    quaternions: Array
    lines: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, chosen: Any) -> Trajectory:
        """The chosen samples: an index array, a mask or a slice."""
        return replace(
            self,
            times=self.times[chosen],
            positions=self.positions[chosen],
            quaternions=self.quaternions[chosen],
            lines=self.lines[chosen],
        )

    @property
    def poses(self) -> Poses:
        """The samples as transforms."""
        return _poses(self.positions, self.quaternions)

    @property
    def step(self) -> float:
        """The usual time between two samples, s; 0 for a single one."""
        return float(np.median(np.diff(self.times))) if len(self) > 1 else 0.0

    def inverse(self) -> Trajectory:
        """The inverse transform over time."""
        turned = self.poses.inverse()
        return replace(
            self, positions=turned.positions, quaternions=self.quaternions * [1, -1, -1, -1]
        )

    def at(self, times: Array, gap: float) -> tuple[Poses, Mask]:
        """The poses at given times (M,), linear and slerp; and which of them (M,) are known.

        gap: samples further apart than this, s, are not interpolated between.
        """
        after = np.clip(np.searchsorted(self.times, times), 1, max(len(self) - 1, 1))
        before, after = after - 1, np.minimum(after, len(self) - 1)
        width = self.times[after] - self.times[before]
        share = np.clip((times - self.times[before]) / np.where(width > 0, width, 1.0), 0.0, 1.0)
        away = np.minimum(abs(times - self.times[before]), abs(times - self.times[after]))
        between = (times >= self.times[before]) & (times <= self.times[after]) & (width <= gap)
        share = np.where(between, share, share.round())
        positions = (1 - share[:, None]) * self.positions[before] + share[:, None] * (
            self.positions[after]
        )
        turned = slerp(self.quaternions[before], self.quaternions[after], share)
        return _poses(positions, turned), between | (away <= NEAR)


def _poses(positions: Array, quaternions: Array) -> Poses:
    return Poses(rotations_of_quaternions(quaternions), positions)
