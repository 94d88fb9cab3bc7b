"""A lidar of several rings: rays at static bodies, moving bodies, and the robot itself."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import PointCloud, frozen
from momantu_bt.robot import LidarSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.config import LidarErrors
from momantu_worlds.sapien.sensors.own_body import OwnBody
from momantu_worlds.sapien.sensors.rays import Triangles

MOVED = 1e-4
"""Motion of a link, m or quaternion units, below which it hides the same rays as before."""


class Lidar:
    """A scanner that takes a full turn at one instant.

    still: triangles (k, 3, 3) of all static bodies, in the map. Rays that hit the robot's own body
    return nothing, as if a driver had filtered them.
    """

    def __init__(
        self,
        map_from_lidar: Callable[[], Transform],
        name: str,
        sensor: LidarSensor,
        still: Triangles,
        moving: list[MovingBody],
        own: OwnBody,
        seed: int,
        errors: LidarErrors,
    ) -> None:
        self._map_from_lidar = map_from_lidar
        self._name, self._sensor = name, sensor
        self._still, self._moving, self._own = still, moving, own
        self._seed, self._errors = seed, errors
        self._beams = _beams(sensor)
        self._posture: Array | None = None
        self._hidden = np.full(len(self._beams), np.inf)

    def read(self, stamp: float) -> PointCloud:
        """Take the points now."""
        sensor, errors = self._sensor, self._errors
        random = seeded(self._seed, self._name, stamp)
        ranges = self.exact()
        ranges = ranges + errors.range_noise * random.standard_normal(len(ranges))
        lost = random.random(len(ranges)) < errors.drop_out
        kept = (ranges >= sensor.range_min) & (ranges <= sensor.range_max) & ~lost
        points = (self._beams[kept] * ranges[kept, None]).astype(np.float32)
        return PointCloud(stamp, sensor.frame, frozen(points))

    def exact(self) -> Array:
        """Distances (columns x rings,) without errors, m; infinite without a return."""
        pose = self._map_from_lidar()
        directions = self._beams @ pose.rotation.T
        ranges = self._still.distances(pose.position, directions)
        ranges = np.minimum(ranges, _to_floor(pose.position, directions))
        triangles, towards = self._in_the_way(pose.position, directions)
        if len(triangles):
            met = Triangles(triangles).distances(pose.position, directions[towards])
            ranges[towards] = np.minimum(ranges[towards], met)
        ranges[self._own_ranges(pose) < ranges] = np.inf
        return ranges

    def _in_the_way(self, origin: Array, directions: Array) -> tuple[Array, Array]:
        """Triangles (k, 3, 3) of moving bodies that rays can hit, and which rays (n,) bool."""
        steepest = math.sin(max(abs(each) for each in self._sensor.elevations))
        triangles, towards = [], np.zeros(len(directions), dtype=bool)
        for body in self._moving:
            centre, radius = body.ball()
            offset = centre - origin
            distance = float(np.linalg.norm(offset))
            if distance - radius > self._sensor.range_max:
                continue
            if abs(offset[2]) - radius > distance * steepest + radius:
                continue
            triangles.append(body.triangles())
            if distance <= radius:
                towards[:] = True
            else:
                wide = math.sqrt(1.0 - (radius / distance) ** 2)
                towards |= directions @ (offset / distance) >= wide
        return (np.concatenate(triangles) if triangles else np.zeros((0, 3, 3))), towards

    def _own_ranges(self, pose: Transform) -> Array:
        """Distance of each beam to the robot's own body, m; computed again when joints move."""
        posture = self._own.poses(pose)
        if self._posture is None or bool(np.any(np.abs(posture - self._posture) > MOVED)):
            self._posture = posture
            triangles = self._own.triangles(posture)
            if len(triangles):
                self._hidden = Triangles(triangles).distances(np.zeros(3), self._beams)
        return self._hidden


def _to_floor(origin: Array, directions: Array) -> Array:
    """Distance (n,) to the plane z = 0, m; infinite for rays that do not point down."""
    down = -directions[:, 2]
    with np.errstate(divide="ignore"):
        return np.where(down > 0.0, origin[2] / np.maximum(down, 0.0), np.inf)


def _beams(sensor: LidarSensor) -> Array:
    """Unit vectors (columns x rings, 3) in the lidar's frame, column by column."""
    azimuths = np.arange(sensor.columns) * (2.0 * math.pi / sensor.columns)
    turn, rise = np.meshgrid(azimuths, np.array(sensor.elevations), indexing="ij")
    flat = np.cos(rise)
    beams = np.stack([flat * np.cos(turn), flat * np.sin(turn), np.sin(rise)], axis=-1)
    return np.asarray(beams.reshape(-1, 3))
