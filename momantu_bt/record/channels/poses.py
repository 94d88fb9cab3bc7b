"""The believed poses of the robot and its links: `/tf` and `/pose`."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from momantu_bt.engine.executor import Executor
from momantu_bt.engine.skills.body import Body
from momantu_bt.frames import MAP, ODOM, Joint
from momantu_bt.geometry import Transform
from momantu_bt.messages import RobotState
from momantu_bt.record.channels.channel import Due, stamp_of, time_text
from momantu_bt.record.codec import dumps
from momantu_bt.record.mcap.file import McapFile
from momantu_bt.record.mcap.viewer_schemas import POSE_IN_FRAME, TRANSFORMS

BASE_RATE = 5.0
LINK_RATE = 2.0
STILL_RATE = 1.0
"""Rates in Hz of the world's clock: a moving base, the links below it, a base that stands."""
_TURNING = ("revolute", "continuous")
_MOVED = 1e-4
"""A link is written again once its joint has moved by this, rad or m."""


class Poses:
    """Writes the base at BASE_RATE and, at LINK_RATE, each link that has moved."""

    def __init__(self, file: McapFile, body: Body) -> None:
        self._transforms = file.channel("/tf", "foxglove.FrameTransforms", TRANSFORMS)
        self._pose = file.channel("/pose", "foxglove.PoseInFrame", POSE_IN_FRAME)
        self._base_due, self._link_due = Due(BASE_RATE), Due(LINK_RATE)
        self._still_due = Due(STILL_RATE)
        self._where: tuple[tuple[float, ...], ...] = ()
        self._base = dumps(body.actuators.robot.description.base_frame)
        self._links = [_Link(joint) for joint in body.frames.kinematics.joints()]

    def write(self, run: Executor, file: McapFile) -> None:
        """Write the base and the links that are due and have moved."""
        body, state, now = run.context.body, run.state, run.context.now
        if body is None or state is None or not self._base_due(now):
            return
        time = time_text(now)
        transforms = self._base_moved(body, state, now, time, file)
        if self._link_due(now):
            transforms.extend(self._moved(state, time))
        if transforms:
            text = f'{{"transforms":[{",".join(transforms)}]}}'
            file.add(self._transforms, stamp_of(now), text)

    def _base_moved(
        self, body: Body, state: RobotState, now: float, time: str, file: McapFile
    ) -> list[str]:
        """The transforms down to the base, with `/pose`; while the base stands, only each second.

        Viewers cannot read NaN.
        """
        odom_from_base, map_from_odom = state.odom_from_base, body.frames.map_from_odom
        where = (_numbers(odom_from_base), _numbers(map_from_odom))
        if where == self._where and not self._still_due(now):
            return []
        if not math.isfinite(sum(map(sum, where))):
            return []
        self._where = where
        frame, pose = ODOM, odom_from_base
        transforms = [_transform(time, f'"{ODOM}"', self._base, odom_from_base)]
        if map_from_odom is not None:
            transforms.append(_transform(time, f'"{MAP}"', f'"{ODOM}"', map_from_odom))
            frame, pose = MAP, map_from_odom @ pose
        text = f'{{"timestamp":{time},"frame_id":"{frame}","pose":{pose_text(pose)}}}'
        file.add(self._pose, stamp_of(now), text)
        return transforms

    def _moved(self, state: RobotState, time: str) -> list[str]:
        """Links that have moved; all links at the first call. Only measured joints can move."""
        positions = dict(zip(state.names, state.positions.tolist(), strict=True))
        texts = [link.text(time, positions.get(link.joint.name, 0.0)) for link in self._links]
        self._links = [link for link in self._links if link.joint.name in positions]
        return [text for text in texts if text is not None]


class _Link:
    """One joint's child in the frame of its parent."""

    def __init__(self, joint: Joint) -> None:
        self.joint = joint
        origin = joint.parent_from_joint
        self._position = tuple(origin.position.tolist())
        self._quaternion = tuple(origin.quaternion.tolist())
        length = math.sqrt(sum(part * part for part in joint.axis)) or 1.0
        self._axis = tuple(part / length for part in joint.axis)
        self._frames = (dumps(joint.parent), dumps(joint.child))
        self._written: float | None = None

    def text(self, time: str, position: float) -> str | None:
        """The transform as JSON; None if the joint has not moved since the last one."""
        if self._written is not None and abs(position - self._written) < _MOVED:
            return None
        if not math.isfinite(position):
            return None
        self._written = position
        x, y, z = self._position
        quaternion = self._quaternion
        if self.joint.kind in _TURNING:
            quaternion = _turned(quaternion, self._axis, position)
        elif self.joint.kind == "prismatic":
            way = np.array(self.joint.axis) * position
            x, y, z = self.joint.parent_from_joint.apply(way).tolist()
        parent, child = self._frames
        return (
            f'{{"timestamp":{time},"parent_frame_id":{parent},"child_frame_id":{child},'
            f'"translation":{{"x":{x:.5f},"y":{y:.5f},"z":{z:.5f}}},'
            f'"rotation":{_rotation_text(quaternion)}}}'
        )


def _turned(
    quaternion: tuple[float, ...], axis: tuple[float, ...], angle: float
) -> tuple[float, ...]:
    """The product with a turn about an axis (Hamilton's rule), without the cost of arrays."""
    w1, x1, y1, z1 = quaternion
    w2, s = math.cos(angle / 2), math.sin(angle / 2)
    x2, y2, z2 = (part * s for part in axis)
    return (
        w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2,
        w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2,
        w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2,
        w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2,
    )


def _numbers(transform: Transform | None) -> tuple[float, ...]:
    if transform is None:
        return ()
    return (*transform.position.tolist(), *transform.quaternion.tolist())


def _rotation_text(quaternion: Iterable[float]) -> str:
    w, x, y, z = quaternion
    return f'{{"x":{x:.6f},"y":{y:.6f},"z":{z:.6f},"w":{w:.6f}}}'


def _position_text(transform: Transform) -> str:
    x, y, z = transform.position.tolist()
    return f'{{"x":{x:.5f},"y":{y:.5f},"z":{z:.5f}}}'


def _transform(time: str, parent: str, child: str, parent_from_child: Transform) -> str:
    return (
        f'{{"timestamp":{time},"parent_frame_id":{parent},"child_frame_id":{child},'
        f'"translation":{_position_text(parent_from_child)},'
        f'"rotation":{_rotation_text(parent_from_child.quaternion.tolist())}}}'
    )


def pose_text(pose: Transform) -> str:
    """A pose as JSON in the form for viewers, rounded to 0.01 mm; a picture needs no more."""
    rotation = _rotation_text(pose.quaternion.tolist())
    return f'{{"position":{_position_text(pose)},"orientation":{rotation}}}'
