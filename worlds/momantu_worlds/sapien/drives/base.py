"""The driver of a base: velocity within its limits; only an omnidirectional one drives sideways."""

from __future__ import annotations

import math
from typing import Any

from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import WATCHDOG, BaseLimits
from momantu_worlds.sapien.config import STEP

TOLERANCE = 1e-6
"""How far a commanded speed may exceed its limit, m/s and rad/s: rounding."""


class BaseDrive:
    """Converts speed commands to targets of the virtual joints x, y and yaw."""

    def __init__(self, x_joint: Any, y_joint: Any, yaw_joint: Any, limits: BaseLimits) -> None:
        self._x, self._y, self._yaw = x_joint, y_joint, yaw_joint
        self._limits = limits
        self._goal = (0.0, 0.0, 0.0)
        self._last_command = -math.inf
        self.linear = 0.0
        self.angular = 0.0
        self.lateral = 0.0

    def command(self, goal: object, now: float) -> None:
        """Set a new speed.

        Raises:
            ValueError: not a BaseVelocity, not finite, or faster than the base can drive.
        """
        if not isinstance(goal, BaseVelocity):
            raise ValueError(f"a base takes BaseVelocity, not {type(goal).__name__}")
        limits = self._limits
        if not abs(goal.linear) <= limits.linear + TOLERANCE:
            raise ValueError(f"linear speed {goal.linear} m/s; the limit is {limits.linear} m/s")
        if not abs(goal.angular) <= limits.angular + TOLERANCE:
            raise ValueError(f"turning at {goal.angular} rad/s; the limit is {limits.angular}")
        if not abs(goal.lateral) <= limits.sideways + (TOLERANCE if limits.sideways else 0.0):
            raise ValueError(f"sideways at {goal.lateral} m/s; the limit is {limits.sideways} m/s")
        self._goal = (goal.linear, goal.angular, goal.lateral)
        self._last_command = now

    def stop(self) -> None:
        """Brake at the acceleration limits."""
        self._goal = (0.0, 0.0, 0.0)

    def place(self) -> None:
        """Stop at once; the last command then continues from rest."""
        self.linear = self.angular = self.lateral = 0.0

    def begin_tick(self, now: float) -> None:
        """Stop if no command has come for too long."""
        if now - self._last_command > WATCHDOG:
            self.stop()

    def apply(self, yaw: float) -> None:
        """Set the targets for one physics step; `yaw` is the base's current heading, rad."""
        self.linear = _ramp(self.linear, self._goal[0], self._limits.linear_acceleration * STEP)
        self.angular = _ramp(self.angular, self._goal[1], self._limits.angular_acceleration * STEP)
        self.lateral = _ramp(self.lateral, self._goal[2], self._limits.linear_acceleration * STEP)
        c, s = math.cos(yaw), math.sin(yaw)
        self._x.set_drive_velocity_target(self.linear * c - self.lateral * s)
        self._y.set_drive_velocity_target(self.linear * s + self.lateral * c)
        self._yaw.set_drive_velocity_target(self.angular)


def _ramp(value: float, goal: float, step: float) -> float:
    return value + min(max(goal - value, -step), step)
