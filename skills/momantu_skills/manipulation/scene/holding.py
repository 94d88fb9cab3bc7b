"""Whether the object that was grasped is still held, as the fingers say at every moment."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from momantu_bt.messages import RobotState
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.config import SceneConfig

RECENT = 5
"""Readings of the fingers that are averaged: 0.25 s, which leaves 0.45 N of noise."""
OPENED = 0.02
"""Opening beyond that of the grasp from which an object that was lost is not between the fingers
any more, m."""


@dataclass(frozen=True, slots=True)
class Fingers:
    """Opening, m, and closing force, N, of the gripper: means of the newest readings."""

    width: float
    effort: float


class Holding:
    """Assumes that an object is held while the fingers press on something.

    A grasp starts with `claim`. An object that turns or slips between the fingers changes their
    opening, and is held all the same: only fingers that press on nothing, or are shut, have lost
    it. After `doubt` successive updates of that kind it counts as lost, and the time counts as a
    contact, because the object has touched something. Where the same fingers press on something
    again before they have opened, the object counts as held again. So does one that they close on,
    whether or not the skill that closes them comes to its end.
    """

    def __init__(self, config: SceneConfig) -> None:
        self._config = config
        self._doubts = 0
        self._width = 0.0
        self._lost: HeldObject | None = None
        self._recent: deque[RobotState] = deque(maxlen=RECENT)
        self.held: HeldObject | None = None
        self.last_contact = -math.inf

    @property
    def fingers(self) -> Fingers:
        """What the fingers measured just now; NaN before the first update."""
        if not self._recent:
            return Fingers(math.nan, math.nan)
        rows = [(state.gripper_width, state.gripper_effort) for state in self._recent]
        width, effort = np.mean(rows, axis=0)
        return Fingers(float(width), float(effort))

    def claim(self, held: HeldObject, width: float, now: float) -> None:
        """Report a grasp at an opening of `width` m."""
        self.held, self._width, self._doubts, self._lost = held, width, 0, None
        self.last_contact = now

    def expect(self, held: HeldObject, width: float) -> None:
        """Report that the fingers begin to close on an object, from an opening of `width` m."""
        self.held, self._width, self._doubts, self._lost = None, width, 0, held

    def touched(self, now: float) -> None:
        """Report that the hand has touched or released something."""
        self.last_contact = now

    def release(self, now: float) -> None:
        """Forget the held object, which was released."""
        self.held, self._lost, self.last_contact = None, None, now

    def judge(self, state: RobotState) -> None:
        """Compare the newest state with what a held object would cause."""
        if not self._recent or state.stamp > self._recent[-1].stamp:
            self._recent.append(state)
        config = self._config
        open_ = state.gripper_width >= config.closed_width
        presses = open_ and state.gripper_effort >= config.least_effort
        if self._lost is not None and state.gripper_width > self._width + OPENED:
            self._lost = None
        believed = self.held is not None
        if not believed and self._lost is None:
            return
        self._doubts = self._doubts + 1 if presses is not believed else 0
        if self._doubts >= config.doubt:
            self.held, self._lost = self._lost, self.held
            self._doubts, self.last_contact = 0, state.stamp
