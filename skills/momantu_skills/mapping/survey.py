"""A survey: scans one after the other, thinned by the way driven, and the map that they make."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass, replace

from momantu_bt.geometry import Pose2D
from momantu_skills.mapping.config import MappingConfig
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.mapper import Graph, Mapper
from momantu_skills.mapping.settling import settled
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.tracking import Tracked

MATCHED_EVERY = 0.1
"""The base must have driven this, m, or turned by as much, rad, since the last scan in use."""


BREAK = 1.0
"""Time between the stamps of two sessions whose clocks overlap, s."""


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """A finished survey. read, used: as `Survey` has them; those not used may lack their rays."""

    graph: Graph
    read: tuple[LoggedScan, ...]
    used: tuple[LoggedScan, ...]


class Survey:
    """Gives a mapper the scans that show something new.

    start: `map_from_base` of the first scan, where it is told; else the map begins at its origin.
    read: all scans, oldest first; used: those that the mapper got.
    """

    def __init__(self, start: Pose2D | None = None) -> None:
        self.mapper = Mapper(MappingConfig(), start or ORIGIN)
        self._start = start
        self.read: list[LoggedScan] = []
        self.used: list[LoggedScan] = []
        self._later = 0.0
        self._begins = True

    @classmethod
    def going_on(cls, known: Known, start: Pose2D) -> Survey:
        """A survey that goes on with another one, by a session with an odometry of its own.

        start: `map_from_base` of the session's first scan. If its clock is behind the last stamp,
        all its stamps are moved so that it begins `BREAK` s after it.
        """
        survey = cls()
        survey.mapper = Mapper.going_on(known.graph, start)
        survey.read, survey.used = list(known.read), list(known.used)
        return survey

    def known(self) -> Known:
        """What another survey can go on with; this one is finished."""
        return Known(self.mapper.graph(), tuple(self.read), tuple(self.used))

    @property
    def begins(self) -> bool:
        """Whether the next scan is the first one of its session."""
        return self._begins

    def due(self, odom_from_base: Pose2D) -> bool:
        """Whether a scan taken now would be used."""
        if self._begins:
            return True
        step = self.used[-1].odom_from_base.inverse() @ odom_from_base
        return abs(step.x) + abs(step.y) + abs(step.yaw) > MATCHED_EVERY

    def add(self, scan: LoggedScan) -> Tracked | None:
        """Read a scan; None if the base has hardly moved since the last one that was used."""
        if self._begins and self.read:
            self._later = max(0.0, self.read[-1].stamp + BREAK - scan.stamp)
        if self._later:
            scan = replace(scan, stamp=scan.stamp + self._later)
        self.read.append(scan)
        if not self.due(scan.odom_from_base):
            return None
        self._begins = False
        self.used.append(scan)
        return self.mapper.add(scan.odom_from_base, scan.rays)

    def pose(self, odom_from_base: Pose2D) -> Pose2D:
        """`map_from_base` now: a step of odometry from the last scan that was used."""
        return self.mapper.poses[-1] @ (self.used[-1].odom_from_base.inverse() @ odom_from_base)

    def finished(self) -> Survey:
        """The same survey with its last loops looked for; this one goes on as it is.

        Where the start was told, the map is moved to where its first scan lies there.
        """
        ended = Survey()
        ended.mapper = copy.deepcopy(self.mapper)
        ended.mapper.finish()
        ended.read, ended.used = self.read[:], self.used[:]
        if self._start is not None and self.used:
            matching = ended.mapper.config.matching
            ended.mapper.move(settled(ended.mapper.poses, self.used, self._start, matching))
        return ended

    def placed(self, first: int = 0) -> Iterator[tuple[Pose2D, Rays]]:
        """The poses of the scans in use and their rays, from the `first` on."""
        poses = self.mapper.poses[first:]
        yield from ((p, s.rays) for p, s in zip(poses, self.used[first:], strict=True))

    def trajectory(self) -> Iterator[tuple[float, Pose2D]]:
        """Stamp and pose of each scan that was read."""
        at = -1
        for scan in self.read:
            if at + 1 < len(self.used) and scan is self.used[at + 1]:
                at += 1
            step = self.used[at].odom_from_base.inverse() @ scan.odom_from_base
            yield scan.stamp, self.mapper.poses[at] @ step
