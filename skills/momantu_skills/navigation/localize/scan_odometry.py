"""Localization without a map: odometry, corrected by laying each scan onto the ones before."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.localize.hypotheses import Hypothesis
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.trail import Trail

SAME = 0.01
"""Motion below which a scan shows nothing new, m or rad."""


class ScanOdometry:
    """What `Localizer` offers, in a frame that begins where the robot does, and drifts a little.

    estimate: the pose. covariance: zero, as nobody can be elsewhere in a frame of one's own.
    quality: 1.
    """

    places: tuple[Hypothesis, ...] = ()
    lost = False
    quality = 1.0

    def __init__(self, start: Pose2D) -> None:
        self.estimate = start
        self.covariance: Array = np.zeros((3, 3))
        self._config = MatchingConfig()
        self._moved = ORIGIN
        """Odometry since the newest scan that counted."""
        self._trail: Trail | None = None

    def move(self, delta: Pose2D) -> None:
        """Follow odometry's `delta`, in the base's frame before the motion."""
        self.estimate = self.estimate @ delta
        self._moved = self._moved @ delta

    def observe(self, rays: Rays) -> None:
        """Lay a scan onto those of the last metres, and correct the estimate."""
        scan, moved = ScanPoints.from_rays(rays, self._config.longest), self._moved
        if self._trail is None:
            self._trail = Trail(scan, self._config)
            return
        if max(math.hypot(moved.x, moved.y), abs(moved.yaw)) < SAME:
            return
        look = self._trail.look(moved, scan)
        self.estimate = self.estimate @ look.expected.inverse() @ look.here
        self._trail.enter(look, moved, scan)
        self._moved = ORIGIN

    def reset(self, pose: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def spread(self) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def use_map(self, grid: GridMap) -> None:
        """There is none."""

    def jitter(self, sigma: float) -> None:
        """Nothing is at random."""
