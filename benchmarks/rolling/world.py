"""A robot that rolls through a world file's geometry: true sensors of its surroundings, no physics.

It is many times faster than SAPIEN. Laser, lidar and odometry are the simulator's own, with their
errors. The base obeys within its limits, and stops where its outline would enter something. The
camera measures nothing.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from momantu_worlds.robots import fetch, kinova_jackal
from momantu_worlds.sapien.build.meshes import map_triangles
from momantu_worlds.sapien.config import SimulatorConfig
from momantu_worlds.sapien.drives.proprioception import Odometry
from momantu_worlds.sapien.sensors.laser import BandLaser, Laser
from momantu_worlds.sapien.sensors.lidar import Lidar
from momantu_worlds.sapien.sensors.rays import Triangles
from momantu_worlds.scenes.geometry.bodies import Episode
from momantu_worlds.scenes.geometry.plane import Passages, passages
from momantu_worlds.scenes.geometry.prisms import Prism, body_prism
from momantu_worlds.scenes.loading import draw_episode, load_world
from momantu_worlds.scenes.site.maps import with_maps

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import CameraImage, PointCloud, RobotState, WrenchReading
from momantu_bt.robot import (
    CameraSensor,
    LaserSensor,
    LidarSensor,
    RobotDescription,
    laser_band,
)
from momantu_bt.robot_parts import WristWrench
from momantu_bt.testing import ScriptedRobot, ScriptedWorld

ROBOTS = {"fetch": fetch, "kinova_jackal": kinova_jackal}
AIR = 0.05
"""Clearance of the base where it is set down, m."""


class RollingRobot(ScriptedRobot):
    """base: where it truly stands, map. touched: how often something stopped the base."""

    def __init__(
        self, description: RobotDescription, episode: Episode, start: Pose2D, seed: int
    ) -> None:
        home = description.named_poses.get("home", {})
        super().__init__(description, base=start, joints=home)
        self._config = SimulatorConfig()
        self._odometry = Odometry(start, seed, self._config.odometry)
        self._outline = shapely.Polygon(description.footprint)
        self._solid = solid_floor(episode, description.height)
        shapely.prepare(self._solid)
        self._rays = Triangles(map_triangles(list(episode.bodies)))
        self._tree = description.kinematics()
        self.touched = 0
        for name, sensor in description.sensors.items():
            if isinstance(sensor, CameraSensor):
                self.readings[name] = _blind(sensor)
            elif isinstance(sensor, LidarSensor):
                self.readings[name] = self._lidar(name, sensor, seed)
            elif isinstance(sensor, WristWrench):
                self.readings[name] = _weightless(sensor)
            elif isinstance(sensor, LaserSensor):
                self.readings[name] = self._laser(name, sensor, seed)

    def carry(self, map_from_base: Pose2D) -> None:
        """Set the base down elsewhere, at rest."""
        self.base = map_from_base
        self.linear = self.angular = 0.0
        self._odometry.carried(map_from_base)

    def state(self) -> RobotState:
        """Joints, and odometry with its errors."""
        state = super().state()
        linear, angular = self._odometry.speeds(state.linear, state.angular, self.time)
        odom = self._odometry.odom_from_base.transform()
        return replace(state, odom_from_base=odom, linear=linear, angular=angular)

    def advance(self, seconds: float) -> None:
        """Move; stay where the outline would enter something."""
        before = self.base
        super().advance(seconds)
        if self.base != before and self.inside(self.base) and not self.inside(before):
            self.base, self.linear, self.angular = before, 0.0, 0.0
            self.touched += 1
        self._odometry.update(self.base, self.time)

    def inside(self, pose: Pose2D) -> bool:
        """Whether the base's outline at a pose meets something."""
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        moved = shapely.affinity.affine_transform(self._outline, [c, -s, s, c, pose.x, pose.y])
        return bool(self._solid.intersects(moved))

    def _at(self, frame: str) -> Transform:
        return self.base.transform() @ self._tree.base_from_frame(frame, self.joints)

    def _laser(self, name: str, sensor: LaserSensor, seed: int) -> object:
        if sensor.source is None:
            errors = self._config.laser
            laser = Laser(
                lambda: self._at(sensor.frame), name, sensor, self._rays, [], seed, errors
            )
            return lambda robot: laser.read(robot.time)
        source = sensor.source
        frames = (self.description.sensors[source].frame, sensor.frame)
        lidar, own = (self._tree.base_from_frame(each, {}) for each in frames)

        def cloud(stamp: float) -> PointCloud:
            reading = self.read(source)
            assert isinstance(reading, PointCloud)
            return reading

        band = BandLaser(cloud, sensor, lidar, own)
        return lambda robot: band.read(robot.time)

    def _lidar(self, name: str, sensor: LidarSensor, seed: int) -> object:
        def at() -> Transform:
            return self._at(sensor.frame)

        errors = self._config.lidar
        lidar = Lidar(at, name, sensor, self._rays, [], NoBody(), seed, errors)  # type: ignore[arg-type]
        return lambda robot: lidar.at_once(robot.time)


class NoBody:
    """A robot whose own links hide nothing."""

    def poses(self, map_from_frame: Transform) -> Array:
        """None."""
        return np.zeros((0, 7))

    def triangles(self, poses: Array) -> Array:
        """None."""
        return np.zeros((0, 3, 3))


def _blind(sensor: CameraSensor) -> object:
    size = (sensor.height // 8, sensor.width // 8)
    focus = 0.5 * size[1] / math.tan(0.5 * sensor.horizontal_fov)
    k = np.array([[focus, 0, size[1] / 2], [0, focus, size[0] / 2], [0, 0, 1]])
    color, depth = np.zeros((*size, 3), np.uint8), np.zeros(size, np.float32)
    return lambda robot: CameraImage(robot.time, sensor.frame, color, depth, k)


def _weightless(sensor: WristWrench) -> object:
    force = np.array([0.0, 0.0, 0.0])
    return lambda robot: WrenchReading(robot.time, sensor.frame, force, force)


def open_rolling(world: str, robot: str, seed: int) -> tuple[ScriptedWorld, Episode]:
    """The episode of a seed of a world, by name or file, with a robot that rolls in it."""
    description, named = ROBOTS[robot](), Path(world) if world.endswith(".yaml") else world
    file, episode = load_world(named), draw_episode(named, seed)
    site = with_maps(episode.site, file, laser_band(description), description.height)
    episode = replace(episode, site=site)
    rolling = RollingRobot(description, episode, episode.start, seed)
    return ScriptedWorld(rolling, site), episode


def prisms_below(episode: Episode, height: float) -> list[Prism]:
    """The room of all bodies that reach below a height, m."""
    found = (body_prism(body, body.map_from_body) for body in episode.bodies)
    return [prism for prism in found if prism is not None and prism.bottom < height]


def solid_floor(episode: Episode, height: float) -> shapely.Geometry:
    """What a base of that height cannot enter, on the floor plan."""
    bases = [shapely.Polygon(prism.base.corners()) for prism in prisms_below(episode, height)]
    return shapely.union_all(bases)


def free_floor(episode: Episode, description: RobotDescription) -> Passages:
    """Where the base has room whatever way it looks, within the walls."""
    radius = max(math.hypot(x, y) for x, y in description.footprint) + AIR
    walls = [body_prism(b, b.map_from_body) for b in episode.bodies if b.category == "wall"]
    corners = np.concatenate([prism.base.corners() for prism in walls if prism is not None])
    low, high = corners.min(axis=0), corners.max(axis=0)
    center, size = (low + high) / 2, high - low
    bases = [prism.base for prism in prisms_below(episode, description.height)]
    return passages(
        bases, (float(center[0]), float(center[1])), (float(size[0]), float(size[1])), radius
    )


def somewhere(
    episode: Episode, description: RobotDescription, random: np.random.Generator
) -> Pose2D:
    """A pose at random on the floor that the robot can reach from its start."""
    floor = free_floor(episode, description)
    start = floor.nearest_free((episode.start.x, episode.start.y))
    rows, columns = np.nonzero(floor.reachable(start))
    pick = int(random.integers(len(rows)))
    shift = random.uniform(-0.5, 0.5, 2) * floor.cell
    return Pose2D(
        float(floor.origin[0] + columns[pick] * floor.cell + shift[0]),
        float(floor.origin[1] + rows[pick] * floor.cell + shift[1]),
        float(random.uniform(-math.pi, math.pi)),
    )
