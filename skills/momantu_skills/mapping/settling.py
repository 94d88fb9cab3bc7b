"""The whole map, moved so that its first scan lies where the robot was told to be.

The first scans are matched with hardly a map, so that the rest can come out turned against them:
half a degree is 8 cm at the other end of a flat. At the end that scan is matched with what
the later ones show.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from momantu_bt.geometry import Pose2D, path_lengths
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.navigation.matching.config import MatchingConfig
from momantu_skills.navigation.matching.poses import ORIGIN
from momantu_skills.navigation.matching.scan import ScanPoints
from momantu_skills.navigation.matching.submap import Growing
from momantu_skills.navigation.matching.tracking import track

LEFT = 2.0
"""Way, m, after which scans no longer were matched with the first ones alone."""
NEAR = 8.0
"""Distance from the start up to which a scan shows what the first one shows, m."""
MOST = 80
"""Most scans that the first one is matched with."""
SURE = 0.7
"""Least score of that match."""


def settled(
    poses: Sequence[Pose2D], scans: Sequence[LoggedScan], start: Pose2D, config: MatchingConfig
) -> Pose2D:
    """`new_from_old` of the map: what moves it to where its first scan lies at the start.

    poses: `map_from_base` of the scans. start: that of the first one, as it was told. The origin,
    which moves nothing, if too little of what the first scan shows is seen later.
    """
    start_from_map = start.inverse()
    start_from_base = [start_from_map @ pose for pose in poses]
    later = [
        number
        for number, (way, pose) in enumerate(zip(path_lengths(poses), start_from_base, strict=True))
        if way > LEFT and math.hypot(pose.x, pose.y) < NEAR
    ]
    if not later:
        return ORIGIN
    shown = Growing(config)
    for number in later[:: math.ceil(len(later) / MOST)]:
        points = ScanPoints.from_rays(scans[number].rays, config.longest)
        shown.add(start_from_base[number], points)
    first = ScanPoints.from_rays(scans[0].rays, config.longest)
    found = track(shown, start_from_base[0], ORIGIN, first, config)
    return start @ found.pose.inverse() @ start_from_map if found.score >= SURE else ORIGIN
