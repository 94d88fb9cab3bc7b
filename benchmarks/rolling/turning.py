"""A base that rolls from place to place with a lidar of many rings and an IMU, without physics.

Its sensors are the simulator's own, with their errors, sampled at every step of the simulator's
physics. It may sway: a suspension that gives way as it drives.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from momantu_worlds.sapien.build.meshes import map_triangles
from momantu_worlds.sapien.config import STEP, SUB_STEPS, SimulatorConfig
from momantu_worlds.sapien.drives.proprioception import Odometry
from momantu_worlds.sapien.sensors.imu import Imu, Moving
from momantu_worlds.sapien.sensors.lidar import Lidar
from momantu_worlds.sapien.sensors.rays import Triangles
from momantu_worlds.scenes.geometry.bodies import Episode

from momantu_bt.geometry import Array, Pose2D, Transform, quaternion_from_rpy, wrap_angle
from momantu_bt.messages import ImuReading, PointCloud
from momantu_bt.robot import RobotDescription
from momantu_bt.world import TICK

from .world import NoBody

AHEAD = 0.5
"""Distance of the point on the way that the base steers for, m."""
SLOW = 0.9
"""Share of its greatest speed at which it drives."""
SWAYS = (1.1, 0.7)
"""Frequencies of its roll and pitch, Hz."""


@dataclass(frozen=True, slots=True)
class Tick:
    """What its driver would tell at one tick. truth: map_from_base."""

    stamp: float
    odom_from_base: Transform
    imu: ImuReading
    truth: Transform


class Turning:
    """Drives along ways; `turn()` reads the lidar when a turn has ended. sway: rad."""

    def __init__(
        self, description: RobotDescription, episode: Episode, seed: int, sway: float = 0.0
    ) -> None:
        self._limits, config = description.base, SimulatorConfig()
        self._tree, home = description.kinematics(), description.named_poses.get("home", {})
        (lidar, lidar_spec), (imu, imu_spec) = description.lidar(), description.imu()
        self.base_from_lidar = self._tree.base_from_frame(lidar_spec.frame, home)
        self.base_from_imu = self._tree.base_from_frame(imu_spec.frame, home)
        rays = Triangles(map_triangles(list(episode.bodies)))
        self._lidar = Lidar(
            lambda: self.base @ self.base_from_lidar,
            lidar,
            lidar_spec,
            rays,
            [],
            NoBody(),  # type: ignore[arg-type]
            seed,
            config.lidar,
        )
        self._imu = Imu(self._moving, imu, imu_spec, seed, config.imu)
        self._odometry = Odometry(episode.start, seed, config.odometry)
        self._pose, self._sway, self.time, self.way = episode.start, sway, 0.0, 0.0
        self._speed = self._turning = 0.0
        self._steps = 0
        self.base = self._before = self._stands()
        self._lidar.read(0.0)
        self._imu.read(0.0)

    def along(self, route: Sequence[tuple[float, float]]) -> Iterator[Tick]:
        """Drive to the end of a route of points, tick by tick."""
        points = np.array(route)
        reached = 0
        while reached < len(points) - 1 or math.dist(points[-1], self._at) > 0.1:
            while reached < len(points) - 1 and math.dist(points[reached], self._at) < AHEAD:
                reached += 1
            yield self._tick(points[reached])
        while abs(self._speed) + abs(self._turning) > 1e-6:
            yield self._tick(None)

    def rest(self, seconds: float) -> Iterator[Tick]:
        """Stand still."""
        for _ in range(round(seconds / TICK)):
            yield self._tick(None)

    def turn(self) -> PointCloud:
        """The lidar's newest turn."""
        return self._lidar.read(self.time)

    @property
    def _at(self) -> tuple[float, float]:
        return self._pose.x, self._pose.y

    def _tick(self, goal: Array | None) -> Tick:
        for _ in range(SUB_STEPS):
            self._step(goal)
        self.time = round(self._steps * STEP, 9)
        self._odometry.update(self._pose, self.time)
        odometry = self._odometry.odom_from_base.transform()
        return Tick(self.time, odometry, self._imu.read(self.time), self.base)

    def _step(self, goal: Array | None) -> None:
        speed = turning = 0.0
        limits = self._limits
        if goal is not None:
            off = wrap_angle(
                math.atan2(goal[1] - self._pose.y, goal[0] - self._pose.x) - self._pose.yaw
            )
            turning = max(-limits.angular, min(limits.angular, 2.5 * off))
            speed = SLOW * limits.linear * max(0.0, 1.0 - abs(off) / 0.8)
        self._speed += _bounded(speed - self._speed, limits.linear_acceleration * STEP)
        self._turning += _bounded(turning - self._turning, limits.angular_acceleration * STEP)
        self._pose = self._pose @ Pose2D(self._speed * STEP, 0.0, self._turning * STEP)
        self.way += abs(self._speed) * STEP
        self._steps += 1
        self._before, self.base = self.base, self._stands()
        now = self._steps * STEP
        self._lidar.collect(now)
        self._imu.collect(now)

    def _stands(self) -> Transform:
        """map_from_base, swaying about the base's middle as fast as it drives."""
        size = self._sway * min(1.0, abs(self._speed) + abs(self._turning))
        now = self._steps * STEP
        roll, pitch = (size * math.sin(2 * math.pi * each * now) for each in SWAYS)
        tilted = Transform((0.0, 0.0, 0.0), quaternion_from_rpy(roll, pitch, 0.0))
        return self._pose.transform() @ tilted

    def _moving(self) -> Moving:
        """How the IMU's frame moves, from its last two poses."""
        before, now = self._before @ self.base_from_imu, self.base @ self.base_from_imu
        between = before.inverse() @ now
        w, *axis = between.quaternion
        turning = now.rotation @ (2.0 * np.array(axis) * math.copysign(1.0, w)) / STEP
        return Moving(now.rotation, (now.position - before.position) / STEP, turning)


def _bounded(value: float, most: float) -> float:
    return max(-most, min(most, value))
