"""Finding the robot on the whole map: every place that explains what it has seen.

Several places that look alike are all kept, however alike: only what tells them apart drops one.
So places are judged by how much of everything seen they explain, each surface counted once. A
particle filter multiplies scan by scan, as if each were news, and soon has one of two twins left.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from momantu_bt.formats.maps import FREE
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.config import LocalizationConfig
from momantu_skills.navigation.localize.belief import covariance
from momantu_skills.navigation.localize.fit import SHORT_COUNTS, beam_counts
from momantu_skills.navigation.localize.panorama import Panorama
from momantu_skills.navigation.localize.particle_filter import likelihood_field, log_likelihoods
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

LEAST = 0.7
"""Share of what was seen that a place must explain; the usual share is 0.95 or more."""
LEAD = 0.05
"""Places that explain less than the best by this are no longer possible. In the bundled worlds the
best wrong place explains 0.13 less than the right one."""
LOOKS = 2
"""Searches in a row that must leave the same one place."""
NEWS = (0.8, 1.4)
"""Way and turn after which the map is searched again, m and rad: a different view."""
LONGEST = 30.0
"""Way after which what was seen is forgotten and collected anew, m."""
UNCONFIRMED = (0.5, 0.5, 0.5)
"""Standard deviations while the place is not certain, m, m and rad."""
COARSE = 3.0
"""The first comparison multiplies `hit_sigma` by this, because the poses that it tries lie far
apart."""
POINTS = 120
"""Points of the panorama that are compared with the map at every pose."""
FIRST = 4000
"""Best poses of the first comparison among which candidates are chosen."""
CANDIDATES = 150
"""Poses that are made more exact."""
APART = (0.3, 0.3)
"""Distance and angle, m and rad, from which two poses are two candidates."""
PLACE = (0.5, 0.5)
"""The same of two places where the robot may be."""
STEPS = (
    (0.08, 0.05, 2.0),
    (0.04, 0.03, 2.0),
    (0.04, 0.02, 1.0),
    (0.02, 0.01, 1.0),
    (0.01, 0.005, 1.0),
)
"""Steps in which a candidate is made more exact, m and rad, each with a factor on `hit_sigma`."""
MOVES = np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=3)))
EQUAL = 0.02
"""Fits that differ by less than this count as equal; then the likelihood decides."""
ROUNDS = 3
"""Rounds of each step."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """A place where the robot may be (map). fit: 0..1, share of what it saw that this explains."""

    pose: Pose2D
    fit: float


class PlaceSearch:
    """Compares what is seen with every pose on a map, again and again while the robot moves.

    places: where it may be, likeliest first; those that explain nearly as much as the best.
    found: the one place, once several looks from different poses have left no other.
    """

    def __init__(self, grid: GridMap, field: Field, config: LocalizationConfig) -> None:
        """field: distance to the map's surfaces, m."""
        self._grid, self._distance, self._config = grid, field, config
        self._lattice = every_pose(grid, config)
        self._panorama = Panorama()
        self._looked: tuple[float, float] | None = None
        self._alone = 0
        self.places: tuple[Hypothesis, ...] = ()
        self.found: Pose2D | None = None

    def move(self, delta: Pose2D) -> None:
        """Carry everything on by odometry's `delta`, in the base's frame before the motion."""
        before = self._panorama.here
        self._panorama.move(delta)
        self._carry(before)

    def _carry(self, before: Pose2D) -> None:
        moved = before.inverse() @ self._panorama.here
        self.places = tuple(replace(place, pose=place.pose @ moved) for place in self.places)

    def see(self, rays: Rays) -> None:
        """Take over a scan; compare with the map when enough is new."""
        if self._panorama.way > LONGEST:
            self._panorama, self._looked = Panorama(), None
        before = self._panorama.here
        self._panorama.add(rays)
        self._carry(before)
        if self._due():
            self._looked = self._panorama.turned, self._panorama.way
            self._judge(self.hypotheses(self._panorama))

    def _judge(self, found: list[Hypothesis]) -> None:
        before = self.places[0].pose if len(self.places) == 1 else None
        least = max(LEAST, found[0].fit - LEAD) if found else 0.0
        self.places = tuple(each for each in found if each.fit >= least)
        here = self.places[0].pose if len(self.places) == 1 else None
        if here is None:
            self._alone = 0
            return
        again = before is not None and _same_place(before, here)
        self._alone = self._alone + 1 if again else 1
        if self._alone >= LOOKS:
            self.found = here

    def covariance(self) -> Array:
        """(3, 3) of x, y, yaw about the likeliest place, m2, m rad, rad2."""
        poses = np.array([(each.pose.x, each.pose.y, each.pose.yaw) for each in self.places])
        spread = covariance(poses, np.ones(len(poses)), self.places[0].pose)
        return np.asarray(spread + np.diag(np.square(UNCONFIRMED)))

    def _due(self) -> bool:
        if self._looked is None:
            return True
        turned, way = self._looked
        return self._panorama.turned - turned > NEWS[1] or self._panorama.way - way > NEWS[0]

    def hypotheses(self, panorama: Panorama) -> list[Hypothesis]:
        """Places by their fit, best first; none without a point."""
        points = panorama.points(POINTS)
        if not len(points):
            return []
        few = points[:: max(1, len(points) // self._config.beams)]
        logs = self._logs(self._lattice, np.ascontiguousarray(few), COARSE)
        first = np.argsort(-logs, kind="stable")[:FIRST]
        candidates = _apart(self._lattice[first], APART, CANDIDATES)
        for step, turn, widening in STEPS:
            for _ in range(ROUNDS):
                candidates = self._better(candidates, points, (step, step, turn), widening)
        fits = np.array([self.fit(Pose2D(*map(float, pose)), panorama) for pose in candidates])
        exact = self._logs(candidates, points, 1.0)
        order = np.lexsort((-exact, -np.round(fits / EQUAL)))
        places = _apart(np.column_stack([candidates, fits])[order], PLACE, CANDIDATES)
        return [Hypothesis(Pose2D(*map(float, row[:3])), float(row[3])) for row in places]

    def fit(self, pose: Pose2D, panorama: Panorama) -> float:
        """0..1: how much of a panorama a pose of the base explains, as `scan_fit`."""
        hits = early = through = 0
        for base_from_then, rays in panorama.views():
            found = beam_counts(self._grid, self._distance, pose @ base_from_then, rays)
            hits, early, through = hits + found[0], early + found[1], through + found[2]
        weight = hits + through + SHORT_COUNTS * early
        return hits / weight if weight > 0 else 0.0

    def _better(
        self, poses: Array, points: Array, step: tuple[float, float, float], widening: float
    ) -> Array:
        """Each pose, or the best of its 26 neighbours."""
        tried = (poses[:, None] + MOVES * step).reshape(-1, 3)
        logs = self._logs(tried, points, widening).reshape(len(poses), len(MOVES))
        best = np.argmax(logs, axis=1)
        return np.asarray(tried.reshape(len(poses), len(MOVES), 3)[np.arange(len(poses)), best])

    def _logs(self, poses: Array, points: Array, widening: float) -> Array:
        grid, share = self._grid, self._config.random_share
        field: Field = likelihood_field(self._distance, self._config.hit_sigma * widening, share)
        found: Array = log_likelihoods(poses, points, field, *grid.origin, grid.resolution, share)
        return found


def _same_place(before: Pose2D, now: Pose2D) -> bool:
    return before.distance_to(now) < PLACE[0] and abs((before.inverse() @ now).yaw) < PLACE[1]


def every_pose(grid: GridMap, config: LocalizationConfig) -> Array:
    """Poses (n, 3): free cells on a lattice, each with evenly spaced headings."""
    skip = max(1, round(config.global_spacing / grid.resolution))
    lattice = np.zeros(grid.cells.shape, dtype=np.bool_)
    lattice[::skip, ::skip] = grid.cells[::skip, ::skip] == FREE
    spots = grid.centers(lattice)
    yaws = np.arange(config.global_headings) * (2 * math.pi / config.global_headings)
    repeated = np.repeat(spots, len(yaws), axis=0)
    return np.concatenate([repeated, np.tile(yaws, len(spots))[:, None]], axis=1)


def _apart(poses: Array, least: tuple[float, float], most: int) -> Array:
    """Of poses (n, 3 or more), best first: at most `most` that are apart from all better ones."""
    left = poses
    chosen: list[Array] = []
    while len(left) and len(chosen) < most:
        best = left[0]
        chosen.append(best)
        far = np.hypot(left[:, 0] - best[0], left[:, 1] - best[1]) > least[0]
        turn = np.abs((left[:, 2] - best[2] + math.pi) % (2 * math.pi) - math.pi) > least[1]
        left = left[far | turn]
    return np.array(chosen)
