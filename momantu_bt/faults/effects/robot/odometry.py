"""Faulty odometry: it counts motion that the base does not make.

Odometry never jumps: an error from the time of the fault stays in it.
"""

from __future__ import annotations

from dataclasses import replace

from momantu_bt.fault import Fault
from momantu_bt.faults.effects.robot.layer import Layer
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.messages import RobotState
from momantu_bt.robot import Robot

STANDING = 1e-6
"""The base stands if it moves less than this between two states, m or rad."""


class OdometryLayer(Layer):
    """A layer that reports other motion than the robot's odometry does."""

    def __init__(self, inner: Robot, fault: Fault, seed: int) -> None:
        super().__init__(inner, fault, seed)
        self._told_from_odom: Pose2D | None = None
        self._inner: RobotState | None = None
        self._told: RobotState | None = None

    def begin(self) -> None:
        """Start to count wrongly."""
        self.state()
        super().begin()

    def end(self) -> None:
        """Count rightly again, from the pose reported last."""
        self.state()
        super().end()

    def state(self) -> RobotState:
        """The state with the odometry that is reported."""
        now = self.inner.state()
        if self._inner is None or self._told is None or now.stamp != self._inner.stamp:
            self._told = self._told_of(now)
            self._inner = now
        return self._told

    def _told_of(self, now: RobotState) -> RobotState:
        if not self.active or self._inner is None or self._told is None:
            if self._told_from_odom is None:
                return now
            pose = self._told_from_odom @ Pose2D.from_transform(now.odom_from_base)
            return replace(now, odom_from_base=pose.transform())
        here = Pose2D.from_transform(now.odom_from_base)
        moved = Pose2D.from_transform(self._inner.odom_from_base).inverse() @ here
        seconds = now.stamp - self._inner.stamp
        moving = max(abs(moved.x), abs(moved.y), abs(moved.yaw)) > STANDING
        told = Pose2D.from_transform(self._told.odom_from_base) @ self.moved(moved, seconds, moving)
        self._told_from_odom = told @ here.inverse()
        linear, angular, lateral = self.speeds(now, moving)
        odom = told.transform()
        return replace(now, odom_from_base=odom, linear=linear, angular=angular, lateral=lateral)

    def moved(self, moved: Pose2D, seconds: float, moving: bool) -> Pose2D:
        """The motion to report for a true one between two states, in the base's frame before it."""
        raise NotImplementedError(f"{type(self).__name__} has no moved()")

    def speeds(self, now: RobotState, moving: bool) -> tuple[float, float, float]:
        """The speeds to report with that motion: m/s ahead, rad/s, m/s sideways."""
        raise NotImplementedError(f"{type(self).__name__} has no speeds()")


class Slip(OdometryLayer):
    """`odometry.slip`: the wheels turn more, or less, than the base moves."""

    def moved(self, moved: Pose2D, seconds: float, moving: bool) -> Pose2D:
        """Scaled."""
        scale = self.number("scale")
        return Pose2D(moved.x * scale, moved.y * scale, wrap_angle(moved.yaw * scale))

    def speeds(self, now: RobotState, moving: bool) -> tuple[float, float, float]:
        """Scaled."""
        scale = self.number("scale")
        return now.linear * scale, now.angular * scale, now.lateral * scale


class Bias(OdometryLayer):
    """`odometry.bias`: while the base moves, a turn is counted that does not happen."""

    def moved(self, moved: Pose2D, seconds: float, moving: bool) -> Pose2D:
        """Turned by the rate."""
        turn = self.number("rate") * seconds if moving else 0.0
        return Pose2D(moved.x, moved.y, wrap_angle(moved.yaw + turn))

    def speeds(self, now: RobotState, moving: bool) -> tuple[float, float, float]:
        """The rate on top."""
        turning = self.number("rate") if moving else 0.0
        return now.linear, now.angular + turning, now.lateral
