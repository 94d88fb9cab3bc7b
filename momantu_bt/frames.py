"""Poses of all frames at each recent moment, from joints, odometry and localization."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from momantu_bt.failure import FRAME_UNKNOWN, Failure
from momantu_bt.formats import urdf
from momantu_bt.geometry import (
    Array,
    Transform,
    matrix_from_quaternion,
    quaternion_from_axis_angle,
)
from momantu_bt.messages import RobotState

MAP = "map"
ODOM = "odom"
HISTORY = 10.0
"""How long a buffer keeps joints and odometry, s: longer than any sensor's delay."""
AHEAD = 1e-6
"""A stamp this much later than the newest state, s, is still answered with the newest state."""


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint of a URDF file. `parent_from_joint` is its origin; kind is URDF's type."""

    name: str
    kind: str
    parent: str
    child: str
    parent_from_joint: Transform
    axis: tuple[float, float, float]
    mimic: urdf.Mimic | None = None
    """The joint that it follows, if there is one."""

    @classmethod
    def of_urdf(cls, joint: urdf.Joint) -> Joint:
        """Make a joint from a joint of a URDF file."""
        parent_from_joint = Transform.from_rpy(joint.xyz, joint.rpy)
        return cls(
            joint.name,
            joint.kind,
            joint.parent,
            joint.child,
            parent_from_joint,
            joint.axis,
            joint.mimic,
        )

    def position(self, positions: Mapping[str, float]) -> float:
        """Its position among those of joints: its own, its leader's as it follows it, or 0."""
        if self.name in positions or self.mimic is None:
            return positions.get(self.name, 0.0)
        return self.mimic.multiplier * positions.get(self.mimic.leader, 0.0) + self.mimic.offset

    def transform(self, position: float) -> Array:
        """`parent_from_child` as a matrix (4, 4) at `position`, rad or m."""
        matrix = self.parent_from_joint.matrix
        if self.kind in ("revolute", "continuous"):
            turn = np.eye(4)
            turn[:3, :3] = matrix_from_quaternion(quaternion_from_axis_angle(self.axis, position))
            return np.asarray(matrix @ turn)
        if self.kind == "prismatic":
            matrix[:3, 3] += matrix[:3, :3] @ (np.array(self.axis) * position)
        return matrix


class KinematicTree:
    """Forward kinematics of a URDF file, below the link that serves as the base."""

    def __init__(self, joints: Iterable[Joint], base_frame: str) -> None:
        self.base_frame = base_frame
        self._joint_above = {joint.child: joint for joint in joints}

    @classmethod
    def from_urdf(cls, path: Path, base_frame: str) -> KinematicTree:
        """Read joints from a URDF file.

        Raises:
            FileNotFoundError: there is no such file.
            UrdfError: the file is not a URDF file, or has no link `base_frame`.
        """
        robot = urdf.read_urdf(path)
        links = [link.name for link in robot.links]
        if base_frame not in links:
            raise urdf.UrdfError(f"{path} has no link {base_frame!r}; links: {', '.join(links)}")
        return cls.of_urdf(robot, base_frame)

    @classmethod
    def of_urdf(cls, robot: urdf.Urdf, base_frame: str) -> KinematicTree:
        """The joints of a URDF that has the link `base_frame`.

        Raises:
            UrdfError: a number of a joint cannot be read.
        """
        return cls([Joint.of_urdf(joint) for joint in robot.joints], base_frame)

    def frames(self) -> tuple[str, ...]:
        """The base and every frame below it."""
        below = [name for name in self._joint_above if self._chain(name)]
        return (self.base_frame, *below)

    def joints(self) -> tuple[Joint, ...]:
        """Every joint below the base."""
        return tuple(joint for name, joint in self._joint_above.items() if self._chain(name))

    def base_from_frame(self, frame: str, positions: Mapping[str, float]) -> Transform:
        """Pose of a link in the base frame; joints that are not in `positions` are at 0.

        Raises:
            Failure: FRAME_UNKNOWN, there is no such frame; the message lists the known ones.
        """
        matrix = np.eye(4)
        for joint in self.chain(frame):
            matrix = matrix @ joint.transform(joint.position(positions))
        return Transform.from_matrix(matrix)

    def chain(self, frame: str) -> tuple[Joint, ...]:
        """The joints from the base to a frame, fixed ones included.

        Raises:
            Failure: FRAME_UNKNOWN, there is no such frame; the message lists the known ones.
        """
        chain = self._chain(frame)
        if chain is None:
            raise Failure(
                FRAME_UNKNOWN,
                f"the robot has no frame {frame!r}; frames: {', '.join(self.frames())}",
                frame=frame,
            )
        return tuple(chain)

    def _chain(self, frame: str) -> list[Joint] | None:
        chain: list[Joint] = []
        while frame != self.base_frame:
            joint = self._joint_above.get(frame)
            if joint is None:
                return None
            chain.append(joint)
            frame = joint.parent
        chain.reverse()
        return chain


class FrameBuffer:
    """Answers `lookup(target, source, stamp)` from recent joints, odometry and localization.

    Frames are `map`, `odom`, the robot's base and every link below it.
    """

    def __init__(self, kinematics: KinematicTree) -> None:
        self.kinematics = kinematics
        self._states: deque[RobotState] = deque()
        self._map_from_odom: deque[tuple[float, Transform]] = deque()

    def add_state(self, state: RobotState) -> None:
        """Add a state; ValueError when its stamp is older than the newest one's."""
        if self._states and state.stamp < self._states[-1].stamp:
            raise ValueError(f"state of {state.stamp} s after one of {self._states[-1].stamp} s")
        self._states.append(state)
        while self._states[0].stamp < state.stamp - HISTORY - AHEAD:
            self._states.popleft()

    def set_map_from_odom(self, transform: Transform, stamp: float) -> None:
        """Set localization's estimate, valid from `stamp` on."""
        self._map_from_odom.append((stamp, transform))
        while len(self._map_from_odom) > 1 and self._map_from_odom[1][0] < stamp - HISTORY:
            self._map_from_odom.popleft()

    @property
    def map_from_odom(self) -> Transform | None:
        """The current estimate of localization; None before the first one."""
        return self._map_from_odom[-1][1] if self._map_from_odom else None

    @property
    def newest(self) -> float:
        """Stamp of the newest state, s.

        Raises:
            Failure: FRAME_UNKNOWN, no state was added yet.
        """
        if not self._states:
            raise Failure(FRAME_UNKNOWN, "the robot has not reported a state yet")
        return self._states[-1].stamp

    def lookup(self, target: str, source: str, stamp: float | None = None) -> Transform:
        """`target_from_source` at `stamp`; None: at the newest state. It never waits.

        Raises:
            Failure: FRAME_UNKNOWN, there is no such frame, the stamp is outside the buffer, or
                `map` has no estimate of localization yet.
        """
        if target == source:
            return Transform()
        at = self.newest if stamp is None else stamp
        return self._odom_from(target, at).inverse() @ self._odom_from(source, at)

    def _odom_from(self, frame: str, stamp: float) -> Transform:
        if frame == ODOM:
            return Transform()
        if frame == MAP:
            return self._map_at(stamp).inverse()
        positions, odom_from_base = self._state_at(stamp)
        return odom_from_base @ self.kinematics.base_from_frame(frame, positions)

    def _map_at(self, stamp: float) -> Transform:
        known = [transform for at, transform in self._map_from_odom if at <= stamp + AHEAD]
        if not known:
            raise Failure(
                FRAME_UNKNOWN,
                f"nobody has said where odom lies in the map at {stamp:.3f} s: "
                "is a localization service running?",
                stamp=stamp,
            )
        return known[-1]

    def _state_at(self, stamp: float) -> tuple[dict[str, float], Transform]:
        newest, oldest = self.newest, self._states[0].stamp
        if not oldest - AHEAD <= stamp <= newest + AHEAD:
            raise Failure(
                FRAME_UNKNOWN,
                f"{stamp:.3f} s lies outside the remembered {oldest:.3f} to {newest:.3f} s",
                stamp=stamp,
            )
        after = bisect_right(self._states, stamp, key=lambda state: state.stamp)
        if after == len(self._states) or after == 0:
            state = self._states[min(after, len(self._states) - 1)]
            return state.joints(), state.odom_from_base
        return _between(self._states[after - 1], self._states[after], stamp)


def _between(
    before: RobotState, after: RobotState, stamp: float
) -> tuple[dict[str, float], Transform]:
    share = (stamp - before.stamp) / (after.stamp - before.stamp)
    if share == 0.0:
        return before.joints(), before.odom_from_base
    positions = before.positions + share * (after.positions - before.positions)
    a, b = before.odom_from_base, after.odom_from_base
    sign = math.copysign(1.0, float(a.quaternion @ b.quaternion))
    blended = Transform(
        a.position + share * (b.position - a.position),
        a.quaternion + share * (sign * b.quaternion - a.quaternion),
    )
    return dict(zip(before.names, (float(p) for p in positions), strict=True)), blended
