"""Whether the robot stands still, from what it measures of itself."""

from __future__ import annotations

from collections import deque

import numpy as np

from momantu_bt.engine.skills.session import CLOCK_SLACK
from momantu_bt.geometry import Array
from momantu_bt.messages import RobotState

WINDOW = 0.5
"""Time over which positions are compared, s: long enough that creep exceeds measurement noise."""
MOTION = 5e-3
"""Largest change of a joint or of the base within the window that counts as standing still, rad or
m: 0.01 rad/s or m/s, and fifty times the noise of an encoder."""
FINGERS = 2.5e-3
"""The same for the gripper's opening, m: its sensor has a noise of 0.3 mm."""


class Standstill:
    """Compares the robot's states of the last WINDOW seconds.

    Positions are compared, and not speeds: a blocked joint may report a speed although it does not
    move, and a creeping one none.
    """

    def __init__(self) -> None:
        self._seen: deque[tuple[float, Array]] = deque()
        self._names: tuple[str, ...] = ()

    def add(self, state: RobotState) -> None:
        """Add the newest state; states that are older than the window are forgotten."""
        if self._seen and state.stamp <= self._seen[-1][0]:
            return
        self._names = state.names
        base = state.odom_from_base.matrix[:3].ravel() / MOTION
        row = [*(state.positions / MOTION), state.gripper_width / FINGERS, *base]
        self._seen.append((state.stamp, np.array(row)))
        while state.stamp - self._seen[0][0] > WINDOW + CLOCK_SLACK:
            self._seen.popleft()

    @property
    def still(self) -> bool:
        """Whether nothing has moved for the whole window; False before it is filled."""
        filled = bool(self._seen) and self._seen[-1][0] - self._seen[0][0] >= WINDOW - CLOCK_SLACK
        return filled and self.moving is None

    @property
    def moving(self) -> str | None:
        """What has moved most within the window, by name; None if nothing has."""
        changes = np.ptp([row for _, row in self._seen], axis=0)
        most = int(np.argmax(changes))
        if changes[most] <= 1.0:
            return None
        return [*self._names, "the gripper", *["the base"] * len(changes)][most]
