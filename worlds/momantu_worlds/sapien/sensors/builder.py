"""A robot's sensors in SAPIEN, from its description."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import PointCloud
from momantu_bt.robot import (
    CameraSensor,
    ImuSensor,
    LaserSensor,
    LidarSensor,
    RobotDescription,
    Sensor,
)
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.build.robot_model import RobotModel
from momantu_worlds.sapien.config import SimulatorConfig
from momantu_worlds.sapien.poses import transform_of
from momantu_worlds.sapien.robot import Sensor as Readable
from momantu_worlds.sapien.sensors.camera import Camera
from momantu_worlds.sapien.sensors.imu import Imu, moving_link
from momantu_worlds.sapien.sensors.laser import BandLaser, Laser
from momantu_worlds.sapien.sensors.lidar import Lidar
from momantu_worlds.sapien.sensors.own_body import OwnBody, housing
from momantu_worlds.sapien.sensors.rays import Triangles
from momantu_worlds.sapien.sensors.wrench import Wrench


@dataclass
class SensorBuilder:
    """Makes the sensors of one robot in one scene.

    still: triangles (k, 3, 3) of all static bodies, in the map. moving: the current list of loose
    bodies, which may change.
    """

    scene: Any
    description: RobotDescription
    model: RobotModel
    still: Array
    moving: list[MovingBody]
    seed: int
    config: SimulatorConfig
    _built: dict[str, Readable] = field(default_factory=dict)

    def build(self, *, render: bool) -> dict[str, Readable]:
        """All sensors by name; without `render` there are no cameras."""
        for name, spec in self.description.sensors.items():
            if render or not isinstance(spec, CameraSensor):
                self._built[name] = self._sensor(name, spec)
        return self._built

    def _sensor(self, name: str, spec: Sensor) -> Readable:
        link, seed, config = self.model.links[spec.frame], self.seed, self.config
        if isinstance(spec, CameraSensor):
            links = list(self.model.links.values())
            return Camera(self.scene, link, name, spec, seed, config.camera, links)
        if isinstance(spec, LidarSensor):
            around = housing(link)
            own = OwnBody(each for each in self.model.links.values() if each is not around)
            at = _pose_source(link)
            return Lidar(at, name, spec, self._rays, self.moving, own, seed, config.lidar)
        if isinstance(spec, ImuSensor):
            return Imu(moving_link(link), name, spec, seed, config.imu)
        if isinstance(spec, LaserSensor):
            if spec.source is not None:
                return self._made_from(spec.source, spec)
            return Laser(
                _pose_source(link), name, spec, self._rays, self.moving, seed, config.laser
            )
        bearing = self.model.links[self._bearing(spec.frame)]
        return Wrench(self.model.articulation, bearing, link, name, spec, seed, config.wrench)

    def _bearing(self, frame: str) -> str:
        """The link whose joint bears the hand and a sensor's frame, which may only hang beside."""
        above = {joint.child: joint.parent for joint in self.description.kinematics().joints()}
        hand = self.description.end_effector
        chain = [frame if hand is None else hand.frame]
        while chain[-1] in above:
            chain.append(above[chain[-1]])
        while frame not in chain:
            frame = above[frame]
        return frame

    @cached_property
    def _rays(self) -> Triangles:
        return Triangles(self.still)

    def _made_from(self, source: str, spec: LaserSensor) -> BandLaser:
        tree = self.description.kinematics()
        frames = (self.description.sensors[source].frame, spec.frame)
        base_from_lidar, base_from_laser = (tree.base_from_frame(each, {}) for each in frames)

        def cloud(stamp: float) -> PointCloud:
            lidar = self._built[source]
            assert isinstance(lidar, Lidar)
            return lidar.at_once(stamp)

        return BandLaser(cloud, spec, base_from_lidar, base_from_laser)


def _pose_source(link: Any) -> Callable[[], Transform]:
    return lambda: transform_of(link.entity_pose)
