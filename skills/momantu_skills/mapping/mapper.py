"""The mapper: scans and odometry in, the poses of all scans out, better with each loop."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass, field

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_skills.mapping import pose_graph
from momantu_skills.mapping.config import MappingConfig
from momantu_skills.mapping.loops import SEEN_FROM, Loop, bears_out, distance, find_loop
from momantu_skills.mapping.pose_graph import Match
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing, Submap
from momantu_skills.navigation.matching.tracking import Tracked, track

TURN_COUNTS = 0.5
"""Metres that a radian of turning counts for a submap's length."""
NEW = np.diag([0.02**2, 0.02**2, 0.006**2])
"""Covariance (m, m, rad) of the scan that begins a submap."""
GROWTH = 0.05
"""Share by which the way grows before the graph is optimised again: the cost stays in proportion to
the way."""
LAST_ROUNDS = 3
"""Rounds of loops between neighbours at the end."""
NEIGHBOUR, ALONE = 1.5, 4.0
"""How far submaps may be off at the end, m: with a loop, and without one."""
LAST_CANDIDATES = 4
FEWEST = 200
"""Fewest points of a submap whose loops count alone; others need one that bears them out. A single
scan of a bare wall lies well on many walls."""
PLACED = np.diag([0.05**2, 0.05**2, 0.01**2])
"""Covariance (m, m, rad) of the first scan of a further session, where it was found on the map."""


@dataclass(slots=True, eq=False)
class _Open:
    """A submap that grows. number: its own; way: of the base since its start, m."""

    number: int
    growing: Growing
    way: float = 0.0
    scans: dict[int, Pose2D] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Graph:
    """All that a mapper knows once its submaps are finished: enough to go on from.

    poses: `map_from_base` of the scans; motions: by odometry between them, None where a session
    begins. origins: `map_from_submap`; ways: driven when they began, m. tried: pairs of submaps
    that were compared. finished: those that show something.
    """

    poses: list[Pose2D]
    motions: list[Pose2D | None]
    matches: list[Match]
    origins: list[Pose2D]
    ways: list[float]
    loops: list[Loop]
    tried: set[tuple[int, int]]
    finished: dict[int, Submap]


class Mapper:
    """Makes a map of scans that come one after the other. Two submaps grow at a time."""

    def __init__(self, config: MappingConfig | None = None, start: Pose2D = ORIGIN) -> None:
        """Start without a scan. start: `map_from_base` of the first one, which fixes the map."""
        self.config = config or MappingConfig()
        self.poses: list[Pose2D] = []
        """`map_from_base` of each scan."""
        self.revision = 0
        """How often the poses of earlier scans were changed."""
        self._start = start
        self.loops: list[Loop] = []
        self._doubtful: list[Loop] = []
        """Loops that do not count yet."""
        self._odometry = ORIGIN
        self._motions: list[Pose2D | None] = []
        self._matches: list[Match] = []
        self._origins: list[Pose2D] = []
        self._ways: list[float] = []
        self._finished: dict[int, Submap] = {}
        self._open: list[_Open] = []
        self._tried: set[tuple[int, int]] = set()
        self._optimised = 0
        self._waiting = 0
        """Loops that the graph has not been optimised with."""

    @classmethod
    def going_on(cls, graph: Graph, start: Pose2D) -> Mapper:
        """A mapper that knows a graph, of which it makes a copy.

        start: `map_from_base` of the next scan, which begins a session of its own odometry.
        """
        mapper = cls(None, start)
        mapper.poses, mapper._motions = graph.poses[:], graph.motions[:]
        mapper._matches, mapper.loops = graph.matches[:], graph.loops[:]
        mapper._origins, mapper._ways = graph.origins[:], graph.ways[:]
        mapper._finished, mapper._tried = dict(graph.finished), set(graph.tried)
        mapper._optimised = len(graph.poses)
        return mapper

    def graph(self) -> Graph:
        """What is known; all submaps are finished."""
        assert not self._open
        return Graph(
            self.poses,
            self._motions,
            self._matches,
            self._origins,
            self._ways,
            self.loops,
            self._tried,
            self._finished,
        )

    def add(self, odom_from_base: Pose2D, rays: Rays) -> Tracked:
        """Enter the next scan. The mapper's newest pose is then in `poses`."""
        scan = ScanPoints.from_rays(rays, self.config.matching.longest)
        if not self._open:
            tracked = Tracked(Pose2D(0.0, 0.0), NEW, 1.0)
            self._begin_session(scan)
        else:
            motion = self._odometry.inverse() @ odom_from_base
            tracked = self._track(motion, scan)
            self._motions.append(motion)
        self._odometry = odom_from_base
        self._turn_over(scan, broken=tracked.score < self.config.broken_score)
        return tracked

    def _begin_session(self, scan: ScanPoints) -> None:
        """Enter the first scan, or the first of a session that goes on with a map."""
        known = self._nearest_submap()
        if self.poses:
            self._motions.append(None)
        self.poses.append(self._start)
        self._begin(scan)
        if known is not None:
            there = self._origins[known].inverse() @ self._start
            scan_number = len(self.poses) - 1
            self._matches.append(Match(known, scan_number, there, PLACED, entered=False))

    def _nearest_submap(self) -> int | None:
        """The finished submap whose middle is nearest to the start."""

        def far(number: int) -> float:
            middle = self._origins[number].apply(self._finished[number].middle[None])[0]
            return math.hypot(middle[0] - self._start.x, middle[1] - self._start.y)

        return min(self._finished, key=far, default=None)

    def _track(self, motion: Pose2D, scan: ScanPoints) -> Tracked:
        number = len(self.poses)
        first = self._open[0]
        tracked = track(first.growing, first.scans[number - 1], motion, scan, self.config.matching)
        pose = self._origins[first.number] @ tracked.pose
        self.poses.append(pose)
        way = math.hypot(motion.x, motion.y) + TURN_COUNTS * abs(motion.yaw)
        for each in self._open:
            own = tracked.pose
            if each is not first:
                own = self._origins[each.number].inverse() @ pose
            entered = tracked.score >= self.config.broken_score
            if entered:
                each.growing.add(own, scan)
            each.scans[number] = own
            each.way += way
            self._matches.append(Match(each.number, number, own, tracked.covariance, entered))
        return tracked

    def _begin(self, scan: ScanPoints) -> None:
        """Begin a submap at the newest scan."""
        number, at = len(self._origins), len(self.poses) - 1
        self._origins.append(self.poses[-1])
        driven = self._open[-1].way if self._open else 0.0
        self._ways.append(driven + (self._ways[-1] if self._ways else 0.0))
        opened = _Open(number, Growing(self.config.matching))
        opened.growing.add(Pose2D(0.0, 0.0), scan)
        opened.scans[at] = Pose2D(0.0, 0.0)
        self._open.append(opened)
        self._matches.append(Match(number, at, Pose2D(0.0, 0.0), NEW))

    def _turn_over(self, scan: ScanPoints, broken: bool) -> None:
        """Finish and begin submaps as the way demands it, or as a scan that does not match does."""
        oldest = self._open[0]
        if broken:
            ended = self._open[:]
            self._begin(scan)
            del self._open[: len(ended)]
            for each in ended:
                self._finish(each)
        elif len(self._open) == 1 and oldest.way > self.config.submap_way / 2:
            self._begin(scan)
        elif oldest.way > self.config.submap_way:
            self._begin(scan)
            self._finish(self._open.pop(0))

    def _finish(self, opened: _Open) -> None:
        submap = opened.growing.finished()
        if submap is None:
            return
        self._finished[opened.number] = submap
        off = {
            older: min(
                self.config.loop_uncertainty
                + self.config.loop_drift * self._driven(older, opened.number),
                self.config.loop_farthest,
            )
            for older in self._finished
            if older < opened.number - 2
        }
        self._waiting += self._find_loops(opened.number, off, self.config.loop_candidates)
        if self._waiting and len(self.poses) > (1.0 + GROWTH) * self._optimised:
            self._optimise()

    def _driven(self, older: int, newer: int) -> float:
        """The way, m, on which the newer submap has drifted from the older one."""
        closed = [loop.newer for loop in self.loops if older < loop.newer <= newer]
        return self._ways[newer] - self._ways[max(closed, default=older)]

    def _find_loops(self, newer: int, off: dict[int, float], most: int) -> int:
        """Compare a submap with the nearest of others that may be `off` by so much, m.

        Returns how many loops count now that did not before.
        """
        submap, at = self._finished[newer], self._origins[newer]
        near: list[tuple[float, int]] = []
        for older, far in off.items():
            apart = distance(submap, at, self._finished[older], self._origins[older])
            if apart < far + SEEN_FROM:
                bisect.insort(near, (apart, older))
        for _, older in near[:most]:
            guess = self._origins[older].inverse() @ at
            self._tried.add((older, newer))
            pose = find_loop(self._finished[older], submap, guess, off[older], self.config)
            if pose is not None:
                self._doubtful.append(Loop(older, newer, pose))
        return self._enter_loops()

    def _enter_loops(self) -> int:
        """Let those of the doubtful loops count that need no other one or have it; how many."""
        known = self.loops + self._doubtful
        good = [
            loop
            for loop in self._doubtful
            if len(self._finished[loop.newer].points) >= FEWEST
            or any(bears_out(other, loop, self._origins) for other in known)
        ]
        self.loops += good
        self._doubtful = [loop for loop in self._doubtful if loop not in good]
        return len(good)

    def _optimise(self) -> None:
        self.poses, self._origins = pose_graph.optimise(
            self.poses,
            self._origins,
            self._motions,
            self._matches,
            self.loops,
            self.config.matching,
        )
        self._optimised, self._waiting = len(self.poses), 0
        self.revision += 1

    def move(self, change: Pose2D) -> None:
        """Move the whole map: `new_from_old`."""
        self.poses = [change @ pose for pose in self.poses]
        self._origins = [change @ origin for origin in self._origins]
        self.revision += 1

    def finish(self) -> None:
        """Finish all submaps, look for loops between neighbours, and optimise for the last time."""
        while self._open:
            self._finish(self._open.pop(0))
        if not self._finished:
            return
        for _ in range(LAST_ROUNDS):
            self._optimise()
            closed = {number for loop in self.loops for number in (loop.older, loop.newer)}
            found = 0
            for newer in self._finished:
                off = NEIGHBOUR if newer in closed else ALONE
                untried = {
                    older: off
                    for older in self._finished
                    if older < newer - 2 and (older, newer) not in self._tried
                }
                found += self._find_loops(newer, untried, LAST_CANDIDATES)
            if not found:
                break
        self._optimise()
