"""The mapper in three dimensions: straightened turns in, the poses of the base out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_skills.mapping.three_d import graph, loops
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.floor import floor_plane
from momantu_skills.mapping.three_d.graph import Edge, Level
from momantu_skills.mapping.three_d.registration import Surface, laid_on

GROWTH = 0.1
"""Share by which the way grows before the graph is optimised again: the cost stays in proportion to
the way."""


@dataclass(frozen=True, slots=True, eq=False)
class Keyframe:
    """A turn that is kept. points: (n, 3) in base; thinned: those that are matched."""

    points: NDArray[np.float32]
    thinned: Array


class CloudMapper:
    """Makes a map of turns that come one after the other.

    Each is laid on the last kept ones. Where it has moved on, it is kept too, and compared with
    places that were passed before.
    """

    def __init__(self, config: CloudConfig | None = None, start: Transform | None = None) -> None:
        """Begin without a turn. start: `map_from_base` of the first one."""
        self.config = config or CloudConfig()
        self.keyframes: list[Keyframe] = []
        self.poses: list[Transform] = [start or Transform()]
        """`map_from_base` of each kept turn; before the first one, of where it will be."""
        self.closed: list[Edge] = []
        """Loops."""
        self.doubtful = 0
        """Turns that could not be matched: odometry counted."""
        self._steps: list[Edge] = []
        self._levels: list[Level] = []
        self._chain: list[Transform] = []
        """Poses of kept turns as one match after the other tells them."""
        self._ways: list[float] = []
        self._turns: list[tuple[float, int, Transform]] = []
        self._now = Transform()
        self._unmatched = 0.0
        """Way and turning since the last match, m and rad."""
        self._local: Surface
        self._looked = 0.0
        self._optimised = 0

    def add(self, stamp: float, points: Array, step: Transform, up: Array | None) -> None:
        """Enter the next turn.

        points: (n, 3) straightened, in the base of `stamp`. step: how odometry says that the base
        moved since the last turn. up: see `Reckoning.up`.
        """
        surface = Surface.of(points, self.config.voxel, self.config.neighbours)
        if not self.keyframes:
            self._keep(points, surface, up, 0.0)
        else:
            matched = self._follow(surface, step)
            moved = self._chain[-1].inverse() @ self._now
            way = float(np.linalg.norm(moved.position))
            turned = moved.angle_to(Transform())
            if way > self.config.keyframe_way or turned > self.config.keyframe_turn:
                sigmas = graph.MATCHED if matched else graph.RECKONED
                last = len(self.keyframes) - 1
                self._steps.append(Edge(last, last + 1, moved, sigmas))
                self._keep(points, surface, up, way)
        last = len(self.keyframes) - 1
        self._turns.append((stamp, last, self._chain[-1].inverse() @ self._now))

    def _follow(self, surface: Surface, step: Transform) -> bool:
        """Lay a turn on the last kept ones; whether that was possible."""
        config, guess = self.config, self._now @ step
        self._now = guess
        self._unmatched += _size(step)
        found = laid_on(self._local, surface, guess, config.match_distance)
        trusted = config.match_correction + config.match_slip * self._unmatched
        if (
            found is None
            or found.share < config.match_share
            or _size(guess.inverse() @ found.pose) > trusted
        ):
            self.doubtful += 1
            return False
        self._now, self._unmatched = found.pose, 0.0
        return True

    def _keep(self, points: Array, surface: Surface, up: Array | None, way: float) -> None:
        if self.keyframes:
            moved = self._chain[-1].inverse() @ self._now
            self.poses.append(self.poses[-1] @ moved)
        self.keyframes.append(Keyframe(points.astype(np.float32), surface.positions()))
        self._chain.append(self._now)
        self._ways.append(self._ways[-1] + way if self._ways else 0.0)
        self._levels.append(Level(floor_plane(points, self.config), up))
        self._renew_local()
        if self._ways[-1] - self._looked > self.config.loop_every:
            self._look_for_loop(surface)
        grown = len(self.poses) > (1.0 + GROWTH) * self._optimised
        if grown and self.closed and self.closed[-1].second >= self._optimised:
            self._optimise()

    def _renew_local(self) -> None:
        first = max(0, len(self.keyframes) - self.config.local_keyframes)
        seen = [
            pose.apply(keyframe.thinned)
            for pose, keyframe in zip(self._chain[first:], self.keyframes[first:], strict=True)
        ]
        self._local = Surface.of(np.concatenate(seen), self.config.voxel, self.config.neighbours)

    def _look_for_loop(self, surface: Surface) -> None:
        """Compare the newest kept turn with the nearest place that was passed before."""
        config, newest = self.config, len(self.keyframes) - 1
        since = self._ways[newest] - max((self._ways[e.second] for e in self.closed), default=0.0)
        off = min(config.loop_uncertainty + config.loop_drift * since, config.loop_widest)
        older = loops.candidate(self._ways, self.poses, off, config)
        if older is None:
            return
        self._looked = self._ways[newest]
        target = loops.around(older, [k.thinned for k in self.keyframes], self._chain, config)
        guess = self.poses[older].inverse() @ self.poses[newest]
        pose = loops.closed(target, surface, guess, off, config)
        if pose is not None:
            self.closed.append(Edge(older, newest, pose, graph.CLOSED))

    def _optimise(self) -> None:
        self.poses = graph.optimise(self.poses, self._steps, self.closed, self._levels)
        self._optimised = len(self.poses)

    def finish(self) -> None:
        """Optimise for the last time."""
        if self.keyframes:
            self._optimise()

    @property
    def map_from_base(self) -> Transform:
        """Where the base is at the newest turn."""
        if not self._turns:
            return self.poses[0]
        return self.poses[-1] @ self._turns[-1][2]

    @property
    def followed(self) -> Transform:
        """Where the base is as one match after the other tells: loops do not move it."""
        return self._now

    @property
    def way(self) -> float:
        """The way until the newest kept turn, m."""
        return self._ways[-1] if self._ways else 0.0

    def trajectory(self) -> Iterator[tuple[float, Transform]]:
        """Stamp and `map_from_base` of each turn."""
        for stamp, number, moved in self._turns:
            yield stamp, self.poses[number] @ moved


def _size(motion: Transform) -> float:
    """Way and turning of a motion, m and rad together."""
    return float(np.linalg.norm(motion.position)) + motion.angle_to(Transform())
