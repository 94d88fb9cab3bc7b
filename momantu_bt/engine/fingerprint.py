"""The fingerprint of a run: a SHA-256 over every tick."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterable
from typing import Any

from momantu_bt.engine.encode import encode
from momantu_bt.engine.skills.actuators import Issued
from momantu_bt.messages import ActuatorGoal, RobotState


class Fingerprint:
    """Call `add` for each tick, and `hexdigest` at the end.

    The hash covers the robot's state, each command and stop in order, each change of a node's
    status, and each write to a cell. It does not cover names of files.
    state: bytes of the robot's state in the newest tick, with all bits of each float.
    """

    def __init__(self) -> None:
        self.state = b""
        self._hash = hashlib.sha256()
        self._goals: dict[str, tuple[ActuatorGoal, bytes]] = {}
        self._statuses: dict[tuple[int, str], bytes] = {}

    def add(
        self,
        state: RobotState | None,
        issued: Iterable[Issued],
        statuses: Iterable[tuple[int, str]],
        written: Iterable[tuple[str, Any]],
    ) -> None:
        """Add one tick. statuses: (node index, status name). written: (cell name, value)."""
        update = self._hash.update
        if state is not None:
            self.state = _state_bytes(state)
            update(self.state)
        for command in issued:
            update(b"c" + command.actuator.encode())
            update(b"stop" if command.goal is None else self._goal_bytes(command))
        update(b"".join(map(self._status_bytes, statuses)))
        update(b"".join([b"w" + name.encode() + encode(value) for name, value in written]))
        update(b"|")

    def hexdigest(self) -> str:
        """The fingerprint of all ticks so far, 64 hexadecimal digits."""
        return self._hash.hexdigest()

    def _status_bytes(self, change: tuple[int, str]) -> bytes:
        """The bytes of a status change; cached, as the same ones recur often."""
        known = self._statuses.get(change)
        if known is None:
            index, status = change
            known = self._statuses[change] = f"n{index}{status}".encode()
        return known

    def _goal_bytes(self, command: Issued) -> bytes:
        """The bytes of a command; cached for a trajectory that is commanded again."""
        goal = command.goal
        assert goal is not None
        known = self._goals.get(command.actuator)
        if known is None or known[0] is not goal:
            known = (goal, encode(goal))
            self._goals[command.actuator] = known
        return known[1]


def _state_bytes(state: RobotState) -> bytes:
    pose = state.odom_from_base
    return b"".join(
        (
            struct.pack(
                "<5d",
                state.stamp,
                state.linear,
                state.angular,
                state.gripper_width,
                state.gripper_effort,
            ),
            state.positions.tobytes(),
            state.velocities.tobytes(),
            state.efforts.tobytes(),
            pose.position.tobytes(),
            pose.quaternion.tobytes(),
            struct.pack("<d", state.lateral) if state.lateral else b"",
        )
    )
