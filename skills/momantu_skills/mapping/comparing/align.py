"""How one map lies on another: searched for everywhere by branch and bound, then refined."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from momantu_bt.formats.maps import FREE
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.mapping.comparing.agreement import SAME, judged
from momantu_skills.mapping.comparing.side import Side
from momantu_skills.navigation.matching import likelihood, search
from momantu_skills.navigation.matching.poses import as_array, as_pose

FINEST = 0.1
"""Least cell of the search, m."""
CELLS = 300
"""Cells of the search along the larger map's edge: a larger map is searched in larger cells."""
POINTS = 600
"""Points of the smaller map that are searched for in the larger one."""
SECTORS = 4
"""Ranges of yaw that are searched one by one, so that rivals show up."""
BORDER = 10
"""Cells around the searched grid."""
LEAST_SCORE = 0.2
"""Share of likelihood below which a pose is not looked at any further."""
NEARBY = np.array([1.0, 0.3])
"""Half widths (m, rad) of the search around the same frame, which maps of one robot often share."""
CAPTURE = 0.6
"""Distance of points beyond which they do not pull, m; it shrinks while the pose is refined."""
ROUNDS = (CAPTURE, 0.3, 0.15)
MOST_REFINED = 2000
"""Most points of each map that are refined with."""
LEAST_AGREED = 1.5
"""Least length of the walls that both maps have, m."""
LEAST_SHARE, SURE_SHARE = 0.7, 0.85
"""Least share of surfaces that agree, of those that lie where the other map knows something; and
what two maps by lasers of a place that has hardly changed have."""
LEAST_PART = 0.2
"""Least share of the smaller map's surfaces that agree, and of its free floor that is free on both:
a room on the other side of a wall agrees with the wall, too."""
RIVAL = 0.9
"""Share of the best pose's merit from which on another one is a rival."""
APART = (0.5, 0.2)
"""Distance (m, rad) from which on poses are different ones."""


@dataclass(frozen=True, slots=True)
class Aligned:
    """How the second map lies on the first.

    merit: metres of wall that agree, less those that do not. share: of the surfaces that agree, see
    LEAST_SHARE; the lesser one of both maps. rivals: other poses that explain the maps nearly as
    well, best first.
    """

    a_from_b: Pose2D
    merit: float
    share: float
    rivals: tuple[Pose2D, ...]


def align(a: Side, b: Side, least_share: float = LEAST_SHARE) -> Aligned | None:
    """Lay the second map on the first; None if they do not show the same place.

    least_share: of each map's surfaces that agree, of those where the other knows something.
    """
    if not len(a.points) or not len(b.points):
        return None
    if _length(b) > _length(a):
        found = _align_smaller(b, a, least_share)
        if found is None:
            return None
        rivals = tuple(pose.inverse() for pose in found.rivals)
        return Aligned(found.a_from_b.inverse(), found.merit, found.share, rivals)
    return _align_smaller(a, b, least_share)


def _align_smaller(large: Side, small: Side, least_share: float) -> Aligned | None:
    """The same for a second map that has no more walls than the first."""
    refined = [refine(large, small, start) for start in _starts(large, small)]
    good = [
        (_merit(large, small, pose), pose)
        for pose in refined
        if _shared(large, small, pose, least_share)
    ]
    good.sort(key=lambda each: -each[0])
    different: list[tuple[float, Pose2D]] = []
    for merit, pose in good:
        if all(_apart(pose, other) for _, other in different):
            different.append((merit, pose))
    if not different:
        return None
    merit, best = different[0]
    rivals = tuple(pose for value, pose in different[1:] if value > RIVAL * merit)
    return Aligned(best, merit, _share(large, small, best), rivals)


def refine(a: Side, b: Side, a_from_b: Pose2D) -> Pose2D:
    """Move a pose to where the surfaces of both maps lie nearest to each other."""
    return _settled([(a, b.points, False), (b, a.points, True)], a_from_b)


def _settled(laid: Sequence[tuple[Side, Array, bool]], start: Pose2D) -> Pose2D:
    """Move a pose to where points lie nearest to the walls of maps.

    laid: maps, points (n, 2) for each, and whether the pose is to be inverted for them. The first
    points are turned about their middle, so that turning and moving hardly depend on each other.
    """
    thin = [(side, _thinned(points, MOST_REFINED), back) for side, points, back in laid]
    middle = thin[0][1].mean(axis=0)
    at = start.apply(middle[None])[0]
    state = np.array([at[0], at[1], start.yaw])

    def pose(now: Array) -> Pose2D:
        turned = Pose2D(0.0, 0.0, float(now[2])).apply(middle[None])[0]
        return Pose2D(float(now[0] - turned[0]), float(now[1] - turned[1]), float(now[2]))

    def misfit(now: Array, reach: float) -> Array:
        there = pose(now)
        inverse = there.inverse()
        parts = [
            side.from_middles((inverse if back else there).apply(points))
            for side, points, back in thin
        ]
        return np.minimum(np.concatenate(parts), reach)

    for reach in ROUNDS:
        found = least_squares(
            misfit, state, loss="cauchy", f_scale=reach / 3, diff_step=1e-5, args=(reach,)
        )
        state = found.x
    settled = pose(state)
    return Pose2D(settled.x, settled.y, math.remainder(settled.yaw, math.tau))


class _Walls:
    """A map's surfaces on a pyramid of grids, in which other points are searched."""

    def __init__(self, side: Side) -> None:
        self.cell = max(FINEST, max(side.grid.size) / CELLS)
        self.corner = side.points.min(axis=0) - BORDER * self.cell
        self.extent = side.points.max(axis=0) + BORDER * self.cell - self.corner
        columns, rows = np.ceil(self.extent / self.cell).astype(int)
        grid = np.zeros((rows, columns), dtype=np.uint8)
        stamp = likelihood.stencil(self.cell, self.cell)
        likelihood.add_ends(grid, grid.copy(), self.corner, self.cell, side.points, stamp)
        self._levels = search.pyramid(grid)

    def search(self, points: Array, expected: Pose2D, window: Array) -> Pose2D | None:
        """Where points (n, 2) fit best, within a window (m, rad) around an expected pose."""
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        about = np.ascontiguousarray(points - middle)
        radius = float(np.hypot(about[:, 0], about[:, 1]).max())
        shift = Pose2D(float(middle[0]), float(middle[1]))
        score, found = search.search(
            self._levels,
            self.corner,
            self.cell,
            about,
            as_array(expected @ shift),
            window,
            self.cell / max(radius, 4 * self.cell),
            LEAST_SCORE,
        )
        return as_pose(found) @ shift.inverse() if score > 0.0 else None


def placed(side: Side, points: Array, expected: Pose2D, window: Array) -> tuple[float, Pose2D]:
    """Where a scan's hits (n, 2) lie on a map, within a window (m, rad) around an expected pose.

    Returns the share of hits within SAME of a wall, and the pose; 0 if nothing fits.
    """
    if not len(points) or not len(side.points):
        return 0.0, expected
    found = _Walls(side).search(_thinned(points, POINTS), expected, window)
    if found is None:
        return 0.0, expected
    pose = _settled([(side, points, False)], found)
    return float(np.mean(side.from_faces(pose.apply(points)) <= SAME)), pose


def _starts(large: Side, small: Side) -> list[Pose2D]:
    """Poses from which to refine: the best of each range of yaw, and of the same frame."""
    walls = _Walls(large)
    thin = _thinned(small.points, POINTS)
    middle = (thin.min(axis=0) + thin.max(axis=0)) / 2
    radius = float(np.hypot(*(thin - middle).T).max())
    centre = walls.corner + walls.extent / 2
    far = float(walls.extent.max()) / 2 + radius / 2
    half = math.pi / SECTORS
    back = Pose2D(float(middle[0]), float(middle[1])).inverse()
    windows = [
        (
            Pose2D(float(centre[0]), float(centre[1]), 2 * half * sector) @ back,
            np.array([far, half]),
        )
        for sector in range(SECTORS)
    ]
    windows.append((Pose2D(0.0, 0.0), NEARBY))
    found = (walls.search(thin, expected, window) for expected, window in windows)
    return [pose for pose in found if pose is not None]


def _merit(a: Side, b: Side, a_from_b: Pose2D) -> float:
    of_b, of_a = judged(b, a, a_from_b), judged(a, b, a_from_b.inverse())
    return sum(
        (int(each.same.sum()) - int(each.missing.sum())) * side.grid.resolution
        for side, each in ((a, of_a), (b, of_b))
    )


def _share(a: Side, b: Side, a_from_b: Pose2D) -> float:
    """The lesser share of both maps' surfaces that agree, of those that the other one knows."""
    shares = []
    for told in (judged(b, a, a_from_b), judged(a, b, a_from_b.inverse())):
        same = int(told.same.sum())
        shares.append(same / max(1, same + int(told.missing.sum())))
    return min(shares)


def _shared(large: Side, small: Side, pose: Pose2D, least_share: float) -> bool:
    """Whether enough agrees for the maps to be of one place."""
    agreed = int(judged(small, large, pose).same.sum())
    if agreed < LEAST_PART * len(small.points) or _share(large, small, pose) < least_share:
        return False
    if agreed * small.grid.resolution < LEAST_AGREED:
        return False
    free = _thinned(small.grid.centers(small.grid.cells == FREE), MOST_REFINED)
    there = large.cells_at(pose.apply(free)) == FREE
    return not len(free) or float(np.mean(there)) > LEAST_PART


def _apart(first: Pose2D, second: Pose2D) -> bool:
    turn = abs(math.remainder(first.yaw - second.yaw, math.tau))
    return first.distance_to(second) > APART[0] or turn > APART[1]


def _length(side: Side) -> float:
    return len(side.points) * side.grid.resolution


def _thinned(points: Array, most: int) -> Array:
    """At most so many of points (n, 2), evenly spread over their order."""
    if len(points) <= most:
        return points
    return np.asarray(points[np.linspace(0, len(points) - 1, most).round().astype(int)])
