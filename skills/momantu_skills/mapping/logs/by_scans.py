"""Odometry of the scans themselves, where nothing else tells how the base moved."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from momantu_bt.geometry import Pose2D
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.trail import Trail

GUESSED = replace(MatchingConfig(), drift=0.05, turn_drift=0.06)
"""The base is taken to step as it did to the scan before: so much may it be elsewhere, m and rad.
Stamps do not tell how long a step is: drivers jitter, and some logs have a scan every 10 cm."""
KEPT = 0.1
"""A scan is entered once the base has moved so far, m, or turned so much, rad: each one that is
entered adds its error."""
LONGEST_STEP = 1.5
"""Time between two scans, s, beyond which the base is taken to stand."""


@dataclass(frozen=True, slots=True)
class Reckoned:
    """odom_from_base: at each scan; the first is the origin. matched: how many fit those before."""

    odom_from_base: tuple[Pose2D, ...]
    matched: int


def reckoned(
    scans: Sequence[tuple[float, Rays]], laid: Callable[[int, int], None] | None = None
) -> Reckoned:
    """How the base moved, by laying each scan on those of the last metres.

    scans: stamps, s, and beams in base, oldest first; one at least. laid: told after each how many
    of how many are laid.
    """
    trail: Trail | None = None
    at, kept, step, before, matched = ORIGIN, ORIGIN, ORIGIN, 0.0, 1
    poses = []
    for number, (stamp, rays) in enumerate(scans, 1):
        scan = ScanPoints.from_rays(rays, GUESSED.longest)
        if trail is None:
            trail = Trail(scan, GUESSED)
        else:
            expected = at @ step if stamp - before < LONGEST_STEP else at
            moved = kept.inverse() @ expected
            look = trail.look(moved, scan)
            now = expected @ look.expected.inverse() @ look.here
            step = at.inverse() @ now if look.matches else ORIGIN
            at, moved = now, kept.inverse() @ now
            matched += look.matches
            if not look.matches or max(math.hypot(moved.x, moved.y), abs(moved.yaw)) > KEPT:
                trail.enter(look, moved, scan)
                kept = at
        poses.append(at)
        before = stamp
        if laid is not None:
            laid(number, len(scans))
    return Reckoned(tuple(poses), matched)
