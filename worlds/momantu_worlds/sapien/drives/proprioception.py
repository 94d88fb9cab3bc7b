"""Joint encoders, motor currents, the gripper's width sensor, wheel odometry: with errors."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.geometry import Array, Pose2D, wrap_angle
from momantu_bt.robot import RobotDescription
from momantu_bt.world import seeded
from momantu_worlds.sapien.config import JointErrors, OdometryErrors


class Encoders:
    """Adds constant offsets and noise to true joint values.

    offsets (n,): measured minus true, in the order of `names`.
    """

    def __init__(
        self, names: tuple[str, ...], prismatic: Array, seed: int, errors: JointErrors
    ) -> None:
        self._seed, self._errors = seed, errors
        random = seeded(seed, "joint offsets")
        scale = np.where(prismatic, errors.offset_prismatic, errors.offset)
        self.offsets = scale * random.standard_normal(len(names))
        self._width_bias = errors.width_bias * float(random.standard_normal())

    def joints(
        self, positions: Array, velocities: Array, efforts: Array, stamp: float
    ) -> tuple[Array, Array, Array]:
        """Measured positions, velocities and efforts, each (n,)."""
        noise = seeded(self._seed, "joints", stamp).standard_normal((3, len(positions)))
        e = self._errors
        return (
            positions + self.offsets + e.noise * noise[0],
            velocities + e.velocity_noise * noise[1],
            efforts + e.effort_noise * noise[2],
        )

    def gripper(self, width: float, effort: float, stamp: float) -> tuple[float, float]:
        """Measured opening (m, never below 0) and closing force (N)."""
        noise = seeded(self._seed, "gripper", stamp).standard_normal(2)
        e = self._errors
        measured = width + self._width_bias + e.width_noise * float(noise[0])
        return max(0.0, measured), effort + e.grip_noise * float(noise[1])


def prismatic_joints(description: RobotDescription, names: tuple[str, ...]) -> Array:
    """Which of the named joints slide, (n,) bool."""
    kinds = {joint.name: joint.kind for joint in read_urdf(description.urdf).joints}
    return np.array([kinds.get(name) == "prismatic" for name in names])


class Odometry:
    """Integrates the base's true motion with scale errors and a random walk."""

    def __init__(self, start: Pose2D, seed: int, errors: OdometryErrors) -> None:
        self._seed, self._errors = seed, errors
        random = seeded(seed, "odometry scale")
        self._linear_scale = 1.0 + errors.linear_scale * float(random.standard_normal())
        self._angular_scale = 1.0 + errors.angular_scale * float(random.standard_normal())
        self._true = start
        self.odom_from_base = Pose2D(0.0, 0.0, 0.0)

    def update(self, map_from_base: Pose2D, stamp: float) -> None:
        """Add the motion to the base's new true pose."""
        moved = self._true.inverse() @ map_from_base
        self._true = map_from_base
        distance, turn = math.hypot(moved.x, moved.y), abs(moved.yaw)
        if distance < 1e-7 and turn < 1e-7:
            return
        e, noise = self._errors, seeded(self._seed, "odometry", stamp).standard_normal(2)
        along = moved.x * self._linear_scale + float(noise[0]) * e.slip * math.sqrt(distance)
        across = moved.y * self._linear_scale
        yaw_sigma = math.hypot(
            e.yaw_per_metre * math.sqrt(distance), e.yaw_per_turn * math.sqrt(turn)
        )
        yaw = wrap_angle(moved.yaw * self._angular_scale + float(noise[1]) * yaw_sigma)
        self.odom_from_base = self.odom_from_base @ Pose2D(along, across, yaw)

    def carried(self, map_from_base: Pose2D) -> None:
        """Accept a new true pose after the base was lifted: the wheels did not turn."""
        self._true = map_from_base

    def sideways(self, lateral: float, stamp: float) -> float:
        """Speed to the left as the wheels of an omnidirectional base report it, m/s."""
        noise = float(seeded(self._seed, "odometry sideways", stamp).standard_normal())
        return lateral * self._linear_scale + self._errors.speed_noise * noise

    def speeds(self, linear: float, angular: float, stamp: float) -> tuple[float, float]:
        """Speeds as the wheels report them, m/s and rad/s."""
        noise = seeded(self._seed, "odometry speed", stamp).standard_normal(2)
        sigma = self._errors.speed_noise
        return (
            linear * self._linear_scale + sigma * float(noise[0]),
            angular * self._angular_scale + sigma * float(noise[1]),
        )
