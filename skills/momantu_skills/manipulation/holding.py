"""Judging from the gripper alone whether something is held."""

from __future__ import annotations

import math

from momantu_bt.messages import RobotState
from momantu_bt.service import HeldObject
from momantu_skills.manipulation.config import SceneConfig


class Holding:
    """Believes in a grasp while opening and effort agree with it.

    A grasp is claimed with `claim`; after `doubt` updates in a row that speak against it, it is
    given up for good, and the instant counts as a contact: what was held has touched something.
    """

    def __init__(self, config: SceneConfig) -> None:
        self._config = config
        self._width = 0.0
        self._doubts = 0
        self.held: HeldObject | None = None
        self.last_contact = -math.inf

    def claim(self, held: HeldObject, width: float, now: float) -> None:
        """Something has been closed on, at an opening of `width` m."""
        self.held, self._width, self._doubts = held, width, 0
        self.last_contact = now

    def touched(self, now: float) -> None:
        """The hand has touched or let go of something."""
        self.last_contact = now

    def release(self, now: float) -> None:
        """What was held has been let go."""
        self.held, self.last_contact = None, now

    def judge(self, state: RobotState) -> None:
        """Compare the newest state with what a held object would show."""
        if self.held is None:
            return
        config = self._config
        moved = abs(state.gripper_width - self._width) > config.width_tolerance
        weak = state.gripper_effort < config.least_effort
        self._doubts = self._doubts + 1 if moved or weak else 0
        if self._doubts >= config.doubt:
            self.held = None
            self.last_contact = state.stamp
