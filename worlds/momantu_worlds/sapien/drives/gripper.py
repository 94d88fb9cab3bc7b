"""The driver of a gripper: a target opening and a limited force."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from momantu_bt.geometry import Array
from momantu_bt.messages import GripperCommand
from momantu_bt.robot import EndEffector
from momantu_worlds.sapien.config import STEP
from momantu_worlds.sapien.drives.fingers import Finger, Hanging, Tips, sides, torques


class GripperDrive:
    """Coupled fingers that close with at most the commanded force.

    The force is that of each side: half of the sum of the fingers' forces. speeds: largest speed of
    each finger joint, rad/s or m/s.
    """

    def __init__(
        self,
        fingers: Mapping[str, Finger],
        tips: Tips,
        hanging: Hanging,
        effector: EndEffector,
        speeds: Mapping[str, float],
    ) -> None:
        self._tips, self._hanging = tips, hanging
        self._fingers = {name: each for name, each in fingers.items() if each.knuckle is None}
        self._effector = effector
        self._speed = _closing_speed(effector, speeds)
        self._goal = self._target = effector.max_width
        self._targets = effector.positions(self._target)
        self._force = effector.max_force
        self._set_force(self._force)

    def place(self, width: float) -> None:
        """Start with an opening, m."""
        self._goal = self._target = width
        self._send()

    def command(self, goal: object) -> None:
        """Set a target opening and a force.

        Raises:
            ValueError: not a GripperCommand, or outside what the gripper can do.
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

    def apply(self, positions: Array) -> None:
        """Move the target by one physics step; positions: of all joints now (dof,)."""
        if self._target != self._goal:
            step = self._speed * STEP
            self._target += min(max(self._goal - self._target, -step), step)
            self._send()
        self._tips.follow(self._targets, positions)
        self._hanging.follow(positions)

    def effort(self, positions: Mapping[str, float]) -> float:
        """Closing force of each side at these finger positions, N: positive presses inwards."""
        push = 0.0
        for name, finger in self._fingers.items():
            way = finger.closing * (self._targets[name] - positions[name])
            push += sides(self._fingers) * finger.gains.stiffness * way / finger.lever
        return min(max(push / len(self._fingers), -self._force), self._force)

    def _send(self) -> None:
        self._targets = self._effector.positions(self._target)
        for name, finger in self._fingers.items():
            finger.joint.set_drive_target(self._targets[name])

    def _set_force(self, force: float) -> None:
        self._force = force
        needed = torques(self._fingers, force)
        for name, finger in self._fingers.items():
            finger.gains.give(finger.joint, needed[name])
        self._tips.press(needed)


def _closing_speed(effector: EndEffector, speeds: Mapping[str, float]) -> float:
    """The fastest change of the opening at which no finger joint exceeds its speed, m/s."""
    return min(
        speeds[joint] * (wider - width) / abs(further - position)
        for joint, rows in effector.opening.items()
        for (width, position), (wider, further) in pairwise(rows)
    )
