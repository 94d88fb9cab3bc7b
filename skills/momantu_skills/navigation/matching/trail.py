"""The scans of the last metres, laid onto each other: what the next scan is laid onto."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from momantu_bt.geometry import Pose2D
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
"""Score of a match from which on it counts; else the expected motion alone tells the step."""


@dataclass(frozen=True, slots=True)
class Look:
    """Where a scan was taken, in the trail's frame: as expected, and as found if it matches."""

    expected: Pose2D
    here: Pose2D
    matches: bool


class Trail:
    """A submap of the scans of the last metres. Its frame changes when a fresh one begins."""

    def __init__(self, scan: ScanPoints, config: MatchingConfig) -> None:
        """Begin at a scan."""
        self._config = config
        self._way = 0.0
        self._scans: deque[tuple[float, Pose2D, ScanPoints]] = deque()
        """The scans of the submap: way at which they were taken, m, and their poses in it."""
        self._submap = self._fresh([(0.0, ORIGIN, scan)])

    def look(self, moved: Pose2D, scan: ScanPoints) -> Look:
        """Lay a scan on the trail. moved: since the newest one in it, as expected."""
        last = self._scans[-1][1]
        tracked = track(self._submap, last, moved, scan, self._config)
        matches = tracked.score >= MATCHES
        return Look(last @ moved, tracked.pose if matches else last @ moved, matches)

    def enter(self, look: Look, moved: Pose2D, scan: ScanPoints) -> None:
        """Add a scan where it was found. One that does not match begins a fresh trail."""
        self._way += math.hypot(moved.x, moved.y) + TURN_COUNTS * abs(moved.yaw)
        if not look.matches:
            self._submap = self._fresh([(self._way, ORIGIN, scan)])
            return
        self._submap.add(look.here, scan)
        self._scans.append((self._way, look.here, scan))
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
