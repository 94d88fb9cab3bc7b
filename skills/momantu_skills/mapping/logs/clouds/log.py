"""A log for a map in three dimensions: turns of a lidar, an IMU, and how the base moved."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from momantu_bt.formats.names import counted
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import ImuReading, PointCloud


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """All samples of an IMU, oldest first, in its own frame; see `ImuReading`.

    base_from_imu: where it sits.
    """

    base_from_imu: Transform
    times: Array
    rates: Array
    forces: Array

    def between(self, after: float, until: float) -> ImuReading | None:
        """The samples later than `after`, s, and not later than `until`; None: there are none."""
        first, last = np.searchsorted(self.times, (after, until), side="right")
        if last <= first:
            return None
        part = slice(first, last)
        times = self.times[part]
        return ImuReading(float(times[-1]), "", times, self.rates[part], self.forces[part])


@dataclass(slots=True)
class LeftOut:
    """Turns that could not be used: how many, and why the first one could not."""

    count: int = 0
    why: str = ""

    def add(self, why: str) -> None:
        """Count one more."""
        self.count += 1
        self.why = self.why or why

    @property
    def note(self) -> str:
        """What to tell of it; "" if there is nothing."""
        clouds = counted(self.count, "cloud")
        return f"left out {clouds}, the first because {self.why}" if self.count else ""


@dataclass(frozen=True, slots=True, eq=False)
class CloudLog:
    """A log. count: of its turns.

    turns: reads them, oldest first, in the lidar's frame. base_from_lidar: where that sits. wheels:
    `odom_from_base` at a time, s, or None where it is not known then; None: there is no odometry.
    base: the name of its frame. notes: what was assumed or left out, in sentences. left_out: turns
    that were, as far as they have been read.
    """

    count: int
    turns: Callable[[], Iterator[PointCloud]]
    base: str
    base_from_lidar: Transform
    imu: Samples | None
    wheels: Callable[[float], Transform | None] | None
    notes: tuple[str, ...] = ()
    left_out: LeftOut = field(default_factory=LeftOut)
