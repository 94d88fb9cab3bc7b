"""Localization without a map: odometry, corrected by laying each scan onto the ones before."""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.localize.hypotheses import Hypothesis
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing
from momantu_skills.navigation.matching.tracking import track

WAY = 10.0
"""Way on which scans are laid onto each other, m, a radian of turning counted as `TURN_COUNTS`;
then the scans of its second half make a fresh submap."""
TURN_COUNTS = 0.5
"""Metres that a radian of turning counts."""
MATCHES = 0.35
"""Score of a match from which on it counts; else odometry alone tells the step."""
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
        self._way = 0.0
        self._scans: deque[tuple[float, Pose2D, ScanPoints]] = deque()
        """The scans of the submap: way at which they were taken, m, and their poses in it."""
        self._submap: Growing | None = None

    def move(self, delta: Pose2D) -> None:
        """Follow odometry's `delta`, in the base's frame before the motion."""
        self.estimate = self.estimate @ delta
        self._moved = self._moved @ delta

    def observe(self, rays: Rays) -> None:
        """Lay a scan onto those of the last metres, and correct the estimate."""
        scan, moved = ScanPoints.from_rays(rays, self._config.longest), self._moved
        if self._submap is None:
            self._submap = self._fresh([(0.0, ORIGIN, scan)])
            return
        if max(math.hypot(moved.x, moved.y), abs(moved.yaw)) < SAME:
            return
        _, last, _ = self._scans[-1]
        tracked = track(self._submap, last, moved, scan, self._config)
        matches = tracked.score >= MATCHES
        here = tracked.pose if matches else last @ moved
        self.estimate = self.estimate @ (last @ moved).inverse() @ here
        self._moved = ORIGIN
        self._way += math.hypot(moved.x, moved.y) + TURN_COUNTS * abs(moved.yaw)
        if not matches:
            self._submap = self._fresh([(self._way, ORIGIN, scan)])
            return
        self._submap.add(here, scan)
        self._scans.append((self._way, here, scan))
        if self._way - self._scans[0][0] > WAY:
            late = [kept for kept in self._scans if self._way - kept[0] < WAY / 2]
            back = late[0][1].inverse()
            self._submap = self._fresh([(way, back @ pose, scan) for way, pose, scan in late])

    def _fresh(self, scans: list[tuple[float, Pose2D, ScanPoints]]) -> Growing:
        """A submap of scans; its frame is that of the first one."""
        self._scans = deque(scans)
        submap = Growing(self._config)
        for _, pose, scan in scans:
            submap.add(pose, scan)
        return submap

    def reset(self, pose: Pose2D, sigma_position: float, sigma_yaw: float) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def spread(self) -> None:
        """Stay: there is no map on which the robot could be elsewhere."""

    def use_map(self, grid: GridMap) -> None:
        """There is none."""

    def jitter(self, sigma: float) -> None:
        """Nothing is at random."""
