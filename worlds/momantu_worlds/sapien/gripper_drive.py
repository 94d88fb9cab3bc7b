"""The driver of a gripper: an opening to go to, with a limited force."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from momantu_bt.messages import GripperCommand
from momantu_bt.robot import EndEffector
from momantu_worlds.sapien.config import STEP, Physics


class GripperDrive:
    """Coupled fingers, each pressing with at most the force that was asked for.

    fingers: SAPIEN's joints by name. speeds: their greatest, rad/s or m/s.
    """

    def __init__(
        self,
        fingers: Mapping[str, Any],
        effector: EndEffector,
        speeds: Mapping[str, float],
        physics: Physics,
    ) -> None:
        self._fingers = fingers
        self._effector = effector
        self._speed = _closing_speed(effector, speeds)
        self._physics = physics
        self._goal = self._target = effector.max_width
        self._force = effector.max_force
        self._set_force(self._force)

    def place(self, width: float) -> None:
        """Start with an opening, m."""
        self._goal = self._target = width
        self._send()

    def command(self, goal: object) -> None:
        """Take an opening and a force.

        Raises:
            ValueError: no GripperCommand, or outside what the gripper can do.
        """
        if not isinstance(goal, GripperCommand):
            raise ValueError(f"a gripper takes GripperCommand, not {type(goal).__name__}")
        widest, strongest = self._effector.max_width, self._effector.max_force
        if not 0.0 <= goal.width <= widest + 1e-9:
            raise ValueError(f"an opening of {goal.width} m; the gripper opens 0 to {widest} m")
        if not 0.0 < goal.max_force <= strongest + 1e-9:
            raise ValueError(f"a force of {goal.max_force} N; the gripper has up to {strongest} N")
        self._goal = goal.width
        if goal.max_force != self._force:
            self._set_force(goal.max_force)

    def apply(self) -> None:
        """Move the target on by one physics step, at the fingers' speed."""
        if self._target != self._goal:
            step = self._speed * STEP
            self._target += min(max(self._goal - self._target, -step), step)
            self._send()

    def effort(self, width: float) -> float:
        """Closing force of each finger at an opening (m), N: positive when pressing inwards."""
        push = (width - self._target) / len(self._fingers)
        return min(max(self._physics.finger_stiffness * push, -self._force), self._force)

    def _send(self) -> None:
        for name, position in self._effector.positions(self._target).items():
            self._fingers[name].set_drive_target(position)

    def _set_force(self, force: float) -> None:
        self._force = force
        for finger in self._fingers.values():
            finger.set_drive_property(
                self._physics.finger_stiffness, self._physics.finger_damping, force
            )


def _closing_speed(effector: EndEffector, speeds: Mapping[str, float]) -> float:
    """The fastest change of the opening that no finger joint is too slow for, m/s."""
    return min(
        speeds[joint] * (wider - width) / abs(further - position)
        for joint, rows in effector.opening.items()
        for (width, position), (wider, further) in pairwise(rows)
    )
