"""A survey in three dimensions: what the sensors tell, tick by tick, and the map that it makes."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Transform
from momantu_bt.messages import ImuReading, PointCloud
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.mapper import CloudMapper
from momantu_skills.mapping.three_d.reckoning import Reckoning, straightened


class CloudSurvey:
    """Straightens turns by the base's motion, and gives them to a mapper.

    start: `map_from_base` at the first turn. measured: there is odometry; if not, `move` is told
    what is expected.
    """

    def __init__(
        self,
        base_from_imu: Transform,
        start: Transform,
        config: CloudConfig | None = None,
        *,
        measured: bool = True,
    ) -> None:
        self.mapper = CloudMapper(config, start)
        self.base_from_lidar = Transform()
        self._reckoning = Reckoning(base_from_imu, measured=measured)
        self._last: Transform | None = None

    def move(self, stamp: float, odom_from_base: Transform, imu: ImuReading | None) -> None:
        """Follow the base to `stamp`; see `Reckoning.add`."""
        self._reckoning.add(stamp, odom_from_base, imu)

    def add(self, turn: PointCloud, base_from_lidar: Transform) -> None:
        """Map a turn that ends where `move` has come to."""
        self.base_from_lidar = base_from_lidar
        points = turn.points.astype(np.float64)
        config = self.mapper.config
        away = np.einsum("ij,ij->i", points, points)
        near = (away > config.nearest**2) & (away < config.farthest**2)
        points = points[near]
        if turn.times is None:
            points = base_from_lidar.apply(points)
        else:
            points = straightened(
                points,
                turn.times[near].astype(np.float64),
                turn.stamp,
                base_from_lidar,
                self._reckoning.motion,
            )
        now = self._reckoning.newest
        step = Transform() if self._last is None else self._last.inverse() @ now
        self._last = now
        self.mapper.add(turn.stamp, points, step, self._reckoning.up)
