"""Feeling in the motors' efforts that an arm pushes against something.

A motor that is stopped gives more and more, up to its limit, long before the arm lags behind much.
Where the arm goes slowly, because something may stand there, what it gives for weight changes
slowly and what it gives for acceleration is small; what counts is a rise. In fast motions joints
rise by half of their limits with nothing in their way, light ones in every third run and strong
ones in every thirtieth: there this tells nothing.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.messages import JointTrajectory
from momantu_skills.manipulation.config import PlanningConfig

SLOW = 1.5 * PlanningConfig.careful_speed
"""Speed up to which a motion is slow, rad/s or m/s: careful ones swing a little past theirs."""
SHARE = 0.3
"""Rise of an effort that counts, as a share of the joint's limit."""
RECENT = 10
"""Ticks whose median a rise is measured from: 0.5 s, in which weight and load hardly change."""
LASTING = 2
"""Ticks for which a rise must last: a start or stop jerks for one."""
LEAST = 10.0
"""Least rise that counts, Nm or N: several times a motor's friction and noise. So wrist joints,
which move only the hand, seldom tell."""


@dataclass(frozen=True, slots=True)
class Push:
    """The joint that pushes most, by its place, and how much more than before, Nm or N."""

    joint: int
    rise: float


def slow(trajectory: JointTrajectory) -> bool:
    """Whether an arm that follows the trajectory goes slowly enough to feel what it meets."""
    steps = np.abs(np.diff(trajectory.positions, axis=0)) / np.diff(trajectory.times)[:, None]
    return bool(steps.max(initial=0.0) <= SLOW)


class Strain:
    """Watches the efforts of one arm during one motion.

    limits: (n,) largest effort of each joint, Nm or N; infinite or 0 where it is not known: such a
    joint tells nothing.
    """

    def __init__(self, limits: Array) -> None:
        known = np.isfinite(limits) & (limits > 0.0)
        self._most = np.where(known, np.maximum(SHARE * limits, LEAST), np.inf)
        self._recent: deque[Array] = deque(maxlen=RECENT)
        self._lasting = np.zeros(len(limits), dtype=np.int64)

    def felt(self, efforts: Array) -> Push | None:
        """The push that the newest efforts (n,) show; NaN: not measured."""
        if len(self._recent) < LASTING:
            self._recent.append(efforts)
            return None
        rise = np.abs(efforts - np.median(self._recent, axis=0))
        over = rise > self._most
        self._lasting = np.where(over, self._lasting + 1, 0)
        self._recent.append(efforts)
        if not (self._lasting >= LASTING).any():
            return None
        worst = int(np.argmax(np.where(self._lasting >= LASTING, rise / self._most, 0.0)))
        return Push(worst, float(rise[worst]))
