"""A lidar of several rings: rays at static bodies, moving bodies, and the robot itself."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import PointCloud, frozen
from momantu_bt.motion import Motion
from momantu_bt.robot import LidarSensor
from momantu_bt.world import seeded
from momantu_worlds.sapien.build.moving import MovingBody
from momantu_worlds.sapien.config import LidarErrors
from momantu_worlds.sapien.sensors.own_body import OwnBody
from momantu_worlds.sapien.sensors.rays import Triangles

MOVED = 1e-4
"""Motion of a link, m or quaternion units, below which it hides the same rays as before."""


class Lidar:
    """A scanner of a full turn: at one instant, or, with `turn`, while it moves on.

    still: triangles (k, 3, 3) of all static bodies, in the map. Rays that hit the robot's own body
    return nothing, as if a driver had filtered them. asked: whether it was read, so that `collect`
    is wanted after each physics step; before that it is taken to have stood where it was then.
    Other bodies and the robot's own are met where they are at the end of a turn.
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
        self._way: deque[tuple[float, Transform]] = deque()
        self.asked = False

    def read(self, stamp: float) -> PointCloud:
        """The points of the turn that ends now."""
        turn = self._sensor.turn
        if turn is None:
            return self.at_once(stamp)
        if not self.asked:
            self.asked = True
            self._way.append((stamp, self._map_from_lidar()))
        times, order = self._turned(stamp, turn)
        random = seeded(self._seed, self._name, "turn", stamp)
        kept, points = self._measured(self._over(stamp + times), random)
        return PointCloud(
            stamp,
            self._sensor.frame,
            frozen(points[order][kept[order]]),
            frozen(times[order][kept[order]].astype(np.float32)),
        )

    def at_once(self, stamp: float) -> PointCloud:
        """All points as seen from where the lidar is now."""
        kept, points = self._measured(self.exact(), seeded(self._seed, self._name, stamp))
        return PointCloud(stamp, self._sensor.frame, frozen(points[kept]))

    def collect(self, now: float) -> None:
        """Remember where the lidar is at `now`, the end of a physics step."""
        self._way.append((now, self._map_from_lidar()))
        begin = now - (self._sensor.turn or 0.0)
        while len(self._way) > 1 and self._way[1][0] <= begin:
            self._way.popleft()

    def _measured(
        self, ranges: Array, random: np.random.Generator
    ) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """Which beams (n,) return something, and all points (n, 3), from exact distances (n,)."""
        sensor, errors = self._sensor, self._errors
        ranges = ranges + errors.range_noise * random.standard_normal(len(ranges))
        lost = random.random(len(ranges)) < errors.drop_out
        kept = (ranges >= sensor.range_min) & (ranges <= sensor.range_max) & ~lost
        return kept, (self._beams * np.where(kept, ranges, 0.0)[:, None]).astype(np.float32)

    def _turned(self, stamp: float, turn: float) -> tuple[Array, NDArray[np.int64]]:
        """When each beam (n,) of the turn until `stamp` was measured, s after it; their order.

        The head turns evenly, and looked along x at time 0.
        """
        columns, rings = self._sensor.columns, len(self._sensor.elevations)
        newest = round(stamp / turn * columns)
        steps = (np.arange(columns) - newest) % columns - columns
        times = np.repeat((steps + 1) * (turn / columns), rings)
        return times, np.argsort(times, kind="stable")

    def exact(self) -> Array:
        """Distances (columns x rings,) without errors, m; infinite without a return."""
        pose = self._map_from_lidar()
        return self._met(pose, pose.position, self._beams @ pose.rotation.T)

    def _over(self, times: Array) -> Array:
        """The same of beams that are measured one after the other, at `times` (n,)."""
        rotations, origins = Motion.of(*zip(*self._way, strict=True)).at(times)
        directions = np.einsum("nij,nj->ni", rotations, self._beams)
        return self._met(self._map_from_lidar(), origins, directions)

    def _met(self, pose: Transform, origins: Array, directions: Array) -> Array:
        """Distances (n,) along unit rays (n, 3) from one point (3,) or from points (n, 3), m.

        pose: map_from_lidar now.
        """
        ranges = self._still.distances(origins, directions)
        ranges = np.minimum(ranges, _to_floor(origins, directions))
        moved = float(np.abs(origins - pose.position).sum(axis=-1).max())
        triangles, towards = self._in_the_way(pose.position, directions, moved)
        if len(triangles):
            begin = origins if origins.ndim == 1 else origins[towards]
            met = Triangles(triangles).distances(begin, directions[towards])
            ranges[towards] = np.minimum(ranges[towards], met)
        ranges[self._own_ranges(pose) < ranges] = np.inf
        return ranges

    def _in_the_way(
        self, origin: Array, directions: Array, moved: float
    ) -> tuple[Array, NDArray[np.bool_]]:
        """Triangles (k, 3, 3) of moving bodies that rays can hit, and which rays (n,).

        moved: how far from `origin` rays begin at most, m.
        """
        steepest = math.sin(max(abs(each) for each in self._sensor.elevations))
        triangles, towards = [], np.zeros(len(directions), dtype=bool)
        for body in self._moving:
            centre, radius = body.ball()
            radius += moved
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
    """Distance (n,) to the plane z = 0, m; infinite for rays that do not point down.

    origin: one (3,) or one for each ray (n, 3).
    """
    down = -directions[:, 2]
    with np.errstate(divide="ignore"):
        return np.where(down > 0.0, origin[..., 2] / np.maximum(down, 0.0), np.inf)


def _beams(sensor: LidarSensor) -> Array:
    """Unit vectors (columns x rings, 3) in the lidar's frame, column by column."""
    azimuths = np.arange(sensor.columns) * (2.0 * math.pi / sensor.columns)
    turn, rise = np.meshgrid(azimuths, np.array(sensor.elevations), indexing="ij")
    flat = np.cos(rise)
    beams = np.stack([flat * np.cos(turn), flat * np.sin(turn), np.sin(rise)], axis=-1)
    return np.asarray(beams.reshape(-1, 3))
