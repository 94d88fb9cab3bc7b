"""The samples of an IMU in a bag, cleaned, and in which direction its mount has up."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.formats.names import counted
from momantu_bt.geometry import Array, Transform, rotation_between
from momantu_bt.messages import GRAVITY
from momantu_skills.mapping.logs import ros
from momantu_skills.mapping.logs.cleaning import backwards
from momantu_skills.mapping.logs.clouds.log import Samples
from momantu_skills.mapping.logs.log import LogError
from momantu_skills.mapping.logs.transforms import Transforms, plain

IN_G = (0.8, 1.2)
"""Mean length of specific forces that are written in g instead of m/s2."""
REST = 0.5
"""Time at the beginning over which specific forces tell what is up, s."""
OTHERWISE = math.radians(45.0)
"""Angle between up and the z axis from which on an IMU is mounted another way than was assumed."""


class ImuMessages:
    """Gathers the messages of an IMU; see `samples`."""

    def __init__(self, topic: str) -> None:
        """Begin without one."""
        self.topic, self.frame = topic, ""
        self._rows: list[tuple[float, ...]] = []

    def add(self, message: Any) -> None:
        """Enter one message."""
        self.frame = self.frame or plain(message.header.frame_id)
        rate, force = message.angular_velocity, message.linear_acceleration
        self._rows.append(
            (ros.stamp_of(message), rate.x, rate.y, rate.z, force.x, force.y, force.z)
        )

    def samples(
        self, path: Path, frames: Transforms, base: str, first: float
    ) -> tuple[Samples | None, list[str]]:
        """The samples, and what was assumed or left out; None: there are none.

        frames: tell where the IMU sits on the base, if anything does. first: stamp of the first
        turn, s.

        Raises:
            LogError: the messages have no times, or their clock runs back.
        """
        rows = np.array(self._rows).reshape(-1, 7)
        whole = np.isfinite(rows).all(axis=1)
        rows, notes = rows[whole], []
        if not len(rows):
            return None, [f"{self.topic} holds no sample that is numbers; the IMU is left out"]
        if not whole.all():
            broken = counted(int((~whole).sum()), "sample")
            notes.append(f"{self.topic}: left out {broken} that are no numbers")
        if len(rows) > 1 and rows[:, 0].max() == rows[:, 0].min():
            raise LogError(
                f"{path}: the messages of {self.topic} have no times: all are stamped "
                f"{rows[0, 0]:g} s; expected a rising stamp in each header. --imu none maps "
                "without the IMU"
            )
        notes += [
            f"{self.topic}: {said}"
            for said in backwards(
                rows[:, 0].tolist(),
                lambda _, said, cure: LogError(f"{path}: {self.topic}: {said}\n  {cure}"),
                "sample",
            )
        ]
        _, unique = np.unique(rows[:, 0], return_index=True)
        rows = rows[unique]
        forces = rows[:, 4:]
        if IN_G[0] < float(np.linalg.norm(forces, axis=1).mean()) < IN_G[1]:
            forces = forces * GRAVITY
            notes.append(f"{self.topic} tells specific forces in g; taken times {GRAVITY}")
        mount, assumed = self._mount(frames, base, rows[:, 0], forces, first)
        return Samples(mount, rows[:, 0], rows[:, 1:4], forces), notes + assumed

    def _mount(
        self, frames: Transforms, base: str, times: Array, forces: Array, first: float
    ) -> tuple[Transform, list[str]]:
        """`base_from_imu`, and what was assumed for it."""
        if base in frames.above(self.frame):
            return frames.mounted(base, self.frame, first), []
        said = f"nothing tells where the IMU's frame {self.frame!r} sits on {base!r}; taken to "
        up = forces[times <= times[0] + REST].mean(axis=0)
        length = float(np.linalg.norm(up))
        if length > 0.0 and up[2] < length * math.cos(OTHERWISE):
            return Transform.from_rotation(_upright(up / length)), [f"{said}have up as its z"]
        return Transform(), [f"{said}have its axes"]


def _upright(up: Array) -> Array:
    """A rotation (3, 3) that turns a unit vector (3,) up."""
    over = np.diag([1.0, -1.0, -1.0]) if up[2] < 0.0 else np.eye(3)
    return np.asarray(rotation_between(over @ up, np.array([0.0, 0.0, 1.0])) @ over)
