"""The driver of a parallel gripper: an opening to go to, with a limited force."""

from __future__ import annotations

from typing import Any

from momantu_bt.messages import GripperCommand
from momantu_bt.robot import EndEffector
from momantu_worlds.sapien.config import STEP, Physics


class GripperDrive:
    """Two coupled fingers, each pressing with at most the force that was asked for.

    The opening between the pads is twice one finger's travel.
    """

    def __init__(
        self, fingers: list[Any], effector: EndEffector, speed: float, physics: Physics
    ) -> None:
        self._fingers = fingers
        self._effector = effector
        self._speed = speed
        self._physics = physics
        self._goal = effector.max_width / 2
        self._target = self._goal
        self._force = effector.max_force
        self._set_force(self._force)

    @property
    def travel(self) -> float:
        """Where each finger is sent now, m."""
        return self._target

    def place(self, width: float) -> None:
        """Start with an opening, m."""
        self._goal = self._target = width / 2
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
        self._goal = goal.width / 2
        if goal.max_force != self._force:
            self._set_force(goal.max_force)

    def apply(self) -> None:
        """Move the target on by one physics step, at the fingers' speed."""
        if self._target != self._goal:
            step = self._speed * STEP
            self._target += min(max(self._goal - self._target, -step), step)
            self._send()

    def effort(self, travels: tuple[float, float]) -> float:
        """Closing force of the drives at finger travels (m), N: positive when pressing inwards."""
        push = sum(travels) / 2 - self._target
        return min(max(self._physics.finger_stiffness * push, -self._force), self._force)

    def _send(self) -> None:
        for finger in self._fingers:
            finger.set_drive_target(self._target)

    def _set_force(self, force: float) -> None:
        self._force = force
        for finger in self._fingers:
            finger.set_drive_property(
                self._physics.finger_stiffness, self._physics.finger_damping, force
            )
