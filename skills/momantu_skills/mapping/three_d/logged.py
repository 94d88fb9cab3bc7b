"""A survey of a recorded log: its turns, with odometry and IMU as far as the log has them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import PointCloud
from momantu_skills.mapping.logs.clouds.log import CloudLog
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.standing import Standing, standing
from momantu_skills.mapping.three_d.surveying import CloudSurvey

CONFIG = replace(CloudConfig(), floor_reach=10.0)
"""Lidars of others stand higher: at 1.8 m the lowest of 16 rings meets the floor 7 m away."""
UNTOLD = 0.3
"""Correction of the expected pose, m and rad, above which a match does not count where there is no
odometry: within a turn of 0.1 s a base that brakes hard at 3 m/s2 and 5 rad/s2 is off by 0.1."""
STEP = 0.05
"""Time between two poses along which turns are straightened, s."""
GOES_ON = 0.5
"""Time for which a base whose motion nothing tells is taken to move on, s."""
MOST_STEPS = 1000
GRAVITY_TIME = 0.5
"""Time at the beginning over which specific forces tell what is up, s."""


@dataclass(frozen=True, slots=True, eq=False)
class Surveyed:
    """A survey of a log. stood: what was found of the floor. interrupted: it ends early."""

    survey: CloudSurvey
    stood: Standing
    interrupted: bool

    @property
    def lidar_height(self) -> float:
        """Height of the lidar above the floor, m."""
        return float(self.survey.base_from_lidar.position[2])


def surveyed(log: CloudLog, told: Callable[[int, int], bool]) -> Surveyed | None:
    """Map the turns of a log; None: there is none that can be used.

    told: hears how many turns are done and how many loops are closed; True ends the work.
    """
    follower: _Follower | None = None
    interrupted = False
    for done, turn in enumerate(log.turns(), 1):
        if follower is None:
            follower = _Follower(log, turn)
        follower.add(turn)
        if told(done, len(follower.survey.mapper.closed)):
            interrupted = True
            break
    if follower is None:
        return None
    return Surveyed(follower.survey, follower.stood, interrupted)


class _Follower:
    """Moves a survey from turn to turn."""

    def __init__(self, log: CloudLog, first: PointCloud) -> None:
        self._log = log
        points = log.base_from_lidar.apply(first.points.astype(np.float64))
        lidar = log.base_from_lidar.position
        self.stood = standing(points, lidar, _up(log, _begin(first)), log.base, CONFIG)
        floor_from_base = self.stood.floor_from_base
        self._from_base, self._to_base = floor_from_base, floor_from_base.inverse()
        self._mount = floor_from_base @ log.base_from_lidar
        imu = Transform() if log.imu is None else floor_from_base @ log.imu.base_from_imu
        measured = log.wheels is not None
        config = CONFIG if measured else replace(CONFIG, match_correction=UNTOLD)
        self.survey = CloudSurvey(imu, Transform(), config, measured=measured)
        self._at, self._odom = _begin(first), Transform()
        self._turned_at, self._followed = -math.inf, Transform()
        self._speed, self._turning = np.zeros(3), np.zeros(3)
        self.survey.move(self._at, self._odom, None)

    def add(self, turn: PointCloud) -> None:
        """Move on to a turn's end, and map it; one that ends before another is left out."""
        if turn.stamp <= self._at:
            self._log.left_out.add("it ends before the one before it")
            return
        count = min(MOST_STEPS, math.ceil((turn.stamp - self._at) / STEP))
        for stamp in np.linspace(self._at, turn.stamp, count + 1)[1:]:
            self._move(float(stamp))
        self.survey.add(turn, self._mount)
        self._learn(turn.stamp)

    def _move(self, stamp: float) -> None:
        self._odom = self._odom @ self._step(self._at, stamp)
        imu = None if self._log.imu is None else self._log.imu.between(self._at, stamp)
        self.survey.move(stamp, self._odom, imu)
        self._at = stamp

    def _step(self, before: float, after: float) -> Transform:
        """How the base moved: by its wheels, or as between the last two turns."""
        wheels = self._log.wheels
        if wheels is not None:
            first, last = wheels(before), wheels(after)
            if first is not None and last is not None:
                return self._from_base @ (first.inverse() @ last) @ self._to_base
        if before - self._turned_at > GOES_ON:
            return Transform()
        passed = after - before
        turned = Rotation.from_rotvec(self._turning * passed).as_matrix()
        return Transform.from_rotation(turned, self._speed * passed)

    def _learn(self, stamp: float) -> None:
        """Note how fast the base moved between the last two turns, as their matches tell."""
        now = self.survey.mapper.followed
        passed = stamp - self._turned_at
        if 0.0 < passed < GOES_ON:
            step = self._followed.inverse() @ now
            self._speed = step.position / passed
            self._turning = Rotation.from_matrix(step.rotation).as_rotvec() / passed
        else:
            self._speed, self._turning = np.zeros(3), np.zeros(3)
        self._turned_at, self._followed = stamp, now


def _begin(turn: PointCloud) -> float:
    """When the first point was measured, s."""
    if turn.times is None or not len(turn.times):
        return turn.stamp - STEP
    return turn.stamp + min(float(turn.times.min()), -STEP)


def _up(log: CloudLog, begin: float) -> Array | None:
    """The direction away from the earth's middle at the beginning, in base; None: unknown.

    Where there is odometry the base's own z is taken to be up.
    """
    if log.wheels is not None or log.imu is None:
        return None
    near = (log.imu.times >= begin - GRAVITY_TIME) & (log.imu.times <= begin + GRAVITY_TIME)
    if not near.any():
        return None
    force = log.imu.base_from_imu.rotation @ log.imu.forces[near].mean(axis=0)
    length = float(np.linalg.norm(force))
    return force / length if length > 1.0 else None
