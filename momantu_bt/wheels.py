"""Wheels that are other than a base's driver believes, and a base whose driver is told so."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.messages import ActuatorGoal, BaseVelocity, RobotState
from momantu_bt.robot import Robot, RobotDescription, SensorReading, WheelCorrection


@dataclass(frozen=True, slots=True)
class Wheels:
    """What each wheel of a differential drive is over what it is believed to be, minus one.

    left, right: radii. track: between the wheels. between: their distance as believed, m. A base
    of another kind takes the mean of the radii for both.
    """

    left: float
    right: float
    track: float
    between: float

    @classmethod
    def of(cls, correction: WheelCorrection) -> Self:
        """From what a calibration found."""
        half = 0.5 * correction.left_to_right
        radius = correction.radius
        return cls(radius - half, radius + half, correction.track, correction.between)

    def correction(self) -> WheelCorrection:
        """As a robot file holds it: the inverse of `of`."""
        return WheelCorrection(
            radius=0.5 * (self.left + self.right),
            track=self.track,
            left_to_right=self.right - self.left,
            between=self.between,
        )

    def then(self, more: Wheels) -> Wheels:
        """These wheels, where a base that was corrected by them turns out to be off by `more`."""
        return Wheels(
            (1 + self.left) * (1 + more.left) - 1,
            (1 + self.right) * (1 + more.right) - 1,
            (1 + self.track) * (1 + more.track) - 1,
            self.between,
        )

    def true(self, linear: float, angular: float) -> tuple[float, float]:
        """How far the base drives, m, and turns, rad, where its driver counts these; or speeds."""
        half = 0.5 * self.between * angular
        left, right = (1 + self.left) * (linear - half), (1 + self.right) * (linear + half)
        return 0.5 * (left + right), (right - left) / (self.between * (1 + self.track))

    def told(self, linear: float, angular: float) -> tuple[float, float]:
        """What the driver counts where the base does this: the inverse of `true`."""
        half = 0.5 * self.between * (1 + self.track) * angular
        left, right = (linear - half) / (1 + self.left), (linear + half) / (1 + self.right)
        return 0.5 * (left + right), (right - left) / self.between

    def true_step(self, told: Pose2D) -> Pose2D:
        """The true motion of a step that the driver counts, driven at constant speeds."""
        along, aside = _arc(told)
        way, turn = self.true(along, told.yaw)
        return _chord(way, aside * (1 + 0.5 * (self.left + self.right)), turn)

    def told_step(self, true: Pose2D) -> Pose2D:
        """What the driver counts for a step of the base: the inverse of `true_step`."""
        along, aside = _arc(true)
        way, turn = self.told(along, true.yaw)
        return _chord(way, aside / (1 + 0.5 * (self.left + self.right)), turn)


def between_wheels(robot: RobotDescription) -> float:
    """Distance of the outermost wheels, m; if the URDF has none, the base's width.

    A wheel turns about the base's y without end, or is a joint that is called so.
    """
    commanded = {name for each in robot.actuators.values() for name in each.joints}
    tree, sides = robot.kinematics(), []
    for joint in tree.joints():
        if joint.name in commanded:
            continue
        pose = tree.base_from_frame(joint.child, {})
        across = abs(float((pose.rotation @ np.array(joint.axis))[1])) > 0.99
        if (joint.kind == "continuous" and across) or "wheel" in joint.name:
            sides.append(float(pose.position[1]))
    if sides and max(sides) - min(sides) > 0.05:
        return max(sides) - min(sides)
    width = [y for _, y in robot.footprint]
    return max(width) - min(width)


def within_limits(robot: RobotDescription, goal: BaseVelocity, asked: BaseVelocity) -> BaseVelocity:
    """A goal within the base's limits, or within what was asked for if that is beyond them."""
    fast = max(robot.base.linear, abs(asked.linear))
    quick = max(robot.base.angular, abs(asked.angular))
    linear, angular = _clipped(goal.linear, fast), _clipped(goal.angular, quick)
    return BaseVelocity(linear, angular, asked.lateral)


class CorrectedBase:
    """A robot whose odometry and speeds are those of its true wheels. Implements `Robot`."""

    def __init__(self, inner: Robot, correction: WheelCorrection) -> None:
        """Begin at the pose of the robot's own odometry."""
        self.inner = inner
        self._wheels = Wheels.of(correction)
        self._before = inner.state()
        self._now = self._corrected(
            self._before, Pose2D.from_transform(self._before.odom_from_base)
        )

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        return self.inner.description

    def state(self) -> RobotState:
        """The current joints, and odometry of the true wheels."""
        now = self.inner.state()
        if now.stamp != self._before.stamp:
            here = Pose2D.from_transform(now.odom_from_base)
            step = Pose2D.from_transform(self._before.odom_from_base).inverse() @ here
            pose = Pose2D.from_transform(self._now.odom_from_base) @ self._wheels.true_step(step)
            self._before, self._now = now, self._corrected(now, pose)
        return self._now

    def read(self, sensor: str) -> SensorReading:
        """The newest reading."""
        return self.inner.read(sensor)

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal; a base gets what its true wheels need."""
        if isinstance(goal, BaseVelocity):
            linear, angular = self._wheels.told(goal.linear, goal.angular)
            goal = within_limits(self.description, BaseVelocity(linear, angular), goal)
        self.inner.command(actuator, goal)

    def stop(self, actuator: str) -> None:
        """Brake."""
        self.inner.stop(actuator)

    def _corrected(self, now: RobotState, pose: Pose2D) -> RobotState:
        linear, angular = self._wheels.true(now.linear, now.angular)
        return replace(now, odom_from_base=pose.transform(), linear=linear, angular=angular)


def corrected_base(robot: Robot) -> Robot:
    """The robot, its wheels corrected if its description says so."""
    wheels = robot.description.wheels
    return robot if wheels is None else CorrectedBase(robot, wheels)


def _arc(step: Pose2D) -> tuple[float, float]:
    """How far along and aside, m, a base drives at constant speeds that ends at a pose."""
    half, scale = 0.5 * step.yaw, 1.0 / _sinc(0.5 * step.yaw)
    c, s = math.cos(half), math.sin(half)
    return scale * (c * step.x + s * step.y), scale * (c * step.y - s * step.x)


def _chord(along: float, aside: float, turn: float) -> Pose2D:
    """Where such a motion ends: the inverse of `_arc`."""
    half, shrink = 0.5 * turn, _sinc(0.5 * turn)
    c, s = math.cos(half), math.sin(half)
    return Pose2D(
        shrink * (c * along - s * aside), shrink * (s * along + c * aside), wrap_angle(turn)
    )


def _sinc(angle: float) -> float:
    return math.sin(angle) / angle if abs(angle) > 1e-9 else 1.0


def _clipped(value: float, most: float) -> float:
    return max(-most, min(most, value))
