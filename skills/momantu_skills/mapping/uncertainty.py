"""How far off the pose on a growing map may be: odometry's error since scans last told it."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.config import LocalizationConfig
from momantu_skills.navigation.matching.tracking import FLOOR, Tracked


class Uncertainty:
    """The covariance (3, 3) of the pose relative to the map around, in base: m, m, rad.

    Along a bare wall a scan does not tell how far the base has come. Then odometry does, whose
    error grows with the way. As in an extended Kalman filter (Thrun, Burgard, Fox: Probabilistic
    Robotics, ch. 3).
    """

    def __init__(self, config: LocalizationConfig) -> None:
        """Begin at the map's first scan, which says where the map lies."""
        self._config = config
        self._told = np.zeros((3, 3))

    @property
    def covariance(self) -> Array:
        """(3, 3), at least what cells and timing leave."""
        return self._told + FLOOR

    def follow(self, motion: Pose2D, tracked: Tracked) -> None:
        """Take in a step by odometry, and where the scan after it was found."""
        c, s = math.cos(motion.yaw), math.sin(motion.yaw)
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        lever = np.array([[1.0, 0.0, -motion.y], [0.0, 1.0, motion.x], [0.0, 0.0, 1.0]])
        step = turn @ lever
        noise = np.diag(np.square(self._config.odometry_deviation(motion)))
        expected = step @ self._told @ step.T + noise
        seen = tracked.covariance - FLOOR
        gain = expected @ np.linalg.inv(expected + seen)
        self._told = expected - gain @ expected
