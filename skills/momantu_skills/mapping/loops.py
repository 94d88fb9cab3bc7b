"""Loops: submaps that show the same place, and how they lie to each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_skills.mapping.config import MappingConfig
from momantu_skills.navigation.matching import lines, search
from momantu_skills.navigation.matching.poses import as_array, as_pose
from momantu_skills.navigation.matching.submap import Submap

SEEN_FROM = 6.0
"""How far the middles of submaps that show the same place may lie apart, m."""
_POINTS = 300
"""Points of a submap that are searched for in another one."""
_TURN_STEP = 0.015
_GATE = 0.15
"""Distance of points to their lines at the end, m."""
_NEAR = 3
"""How many numbers apart submaps may be for their loops to bear each other out."""
_AGREES, _TURN_AGREES = 0.3, 0.05
"""How much such loops may contradict each other, m and rad."""
_FREE = np.array([10.0, 10.0])
"""Standard deviations (m, rad) of a place that nothing else tells."""


@dataclass(frozen=True, slots=True)
class Loop:
    """`older_from_newer` of two submaps, by their numbers."""

    older: int
    newer: int
    pose: Pose2D


def find_loop(
    older: Submap, newer: Submap, guess: Pose2D, off: float, config: MappingConfig
) -> Pose2D | None:
    """`older_from_newer` if the submaps show the same place. guess: the same, off by up to `off` m.

    The search turns the newer submap about its middle.
    """
    middle = _middle(newer)
    points = newer.points - newer.middle
    score, found = search.search(
        older.levels,
        older.corner,
        config.matching.search_resolution,
        points[:: max(1, len(points) // _POINTS)].copy(),
        as_array(guess @ middle),
        np.array([off, min(0.6, 0.15 + 0.08 * off)]),
        _TURN_STEP,
        config.loop_score,
    )
    if score < 0.0:
        return None
    start = as_array(as_pose(found) @ middle.inverse())
    pose, _, misfit, count = lines.lay_on(
        older.index,
        older.points,
        older.normals,
        older.corner,
        config.matching.resolution,
        newer.points[::2].copy(),
        newer.normals[::2].copy(),
        start,
        start,
        _FREE,
        1.0,
        _GATE,
    )
    share = count / math.ceil(len(newer.points) / 2)
    good = share > config.loop_share and misfit < config.loop_misfit
    return as_pose(pose) if good else None


def distance(first: Submap, at: Pose2D, second: Submap, there: Pose2D) -> float:
    """Distance between the middles of two submaps at their poses of the map, m."""
    return (at @ _middle(first)).distance_to(there @ _middle(second))


def _middle(submap: Submap) -> Pose2D:
    return Pose2D(float(submap.middle[0]), float(submap.middle[1]))


def bears_out(other: Loop, loop: Loop, origins: Sequence[Pose2D]) -> bool:
    """Whether a loop says the same as another one, of another newer submap near it.

    origins: `map_from_submap`, which are trusted over a few submaps. A submap's own loops do not
    bear each other out: what looks alike lies on both of two older ones that overlap.
    """
    if not 0 < abs(other.newer - loop.newer) <= _NEAR or abs(other.older - loop.older) > _NEAR:
        return False
    older_from_other = origins[loop.older].inverse() @ origins[other.older]
    other_from_newer = origins[other.newer].inverse() @ origins[loop.newer]
    apart = loop.pose.inverse() @ (older_from_other @ other.pose @ other_from_newer)
    return math.hypot(apart.x, apart.y) < _AGREES and abs(apart.yaw) < _TURN_AGREES
