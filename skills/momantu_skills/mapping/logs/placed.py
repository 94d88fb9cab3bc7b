"""Scans and frames of a log, as robots publish them: where the base was at each scan."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import LaserScan
from momantu_skills.mapping.logs.cleaning import alike, backwards, no_return
from momantu_skills.mapping.logs.log import Log, LogError, LoggedScan
from momantu_skills.mapping.logs.transforms import Transforms, plain
from momantu_skills.navigation.map.sensing import Rays

LEVEL = 0.985
"""Least cosine of the angle between the laser's axis and the vertical: 10 degrees."""


@dataclass(slots=True)
class Published:
    """What a log tells. scans: of one laser.

    odometry: (odom, base, stamp, `odom_from_base`), of messages that tell nothing else.
    """

    scans: list[LaserScan] = field(default_factory=list)
    transforms: Transforms = field(default_factory=Transforms)
    odometry: list[tuple[str, str, float, Transform]] = field(default_factory=list)


def placed(path: Path, told: Published) -> Log:
    """The scans with odometry, oldest first.

    Raises:
        LogError: nothing tells how the base moved, the laser is not level, or the clock runs back.
    """
    frame = plain(told.scans[0].frame)
    odom, base, notes = _moving(path, frame, told)
    scans, odd = alike(told.scans, lambda scan: scan.ranges.size)
    notes += odd
    stamps = [scan.stamp for scan in scans]
    notes += backwards(stamps, lambda _, said, cure: LogError(f"{path}: {said}\n  {cure}"))
    ranges = np.concatenate([scan.ranges for scan in scans])
    farthest = no_return(ranges) if np.isfinite(ranges).all() else math.inf
    found = []
    for scan in scans:
        odom_from_base = told.transforms.moved(base, scan.stamp)
        if odom_from_base is None:
            continue
        seen = replace(scan, range_max=min(scan.range_max, farthest))
        rays = Rays.from_scan(seen, _mount(path, told.transforms, base, frame, scan.stamp))
        found.append(LoggedScan(scan.stamp, Pose2D.from_transform(odom_from_base), rays))
    if not found:
        raise LogError(f"{path}: the stamps of the scans and of {odom!r} do not overlap")
    if len(found) < len(scans):
        notes.append(f"left out {len(scans) - len(found)} scans at whose time no odometry is told")
    return Log(tuple(found), tuple(notes))


def _moving(path: Path, frame: str, told: Published) -> tuple[str, str, list[str]]:
    """The frames of odometry and of the base that moves in it, and notes."""
    chain = told.transforms.above(frame)
    for below, above in itertools.pairwise(chain):
        if above in {plain(odom) for odom, *_ in told.odometry} or "odom" in above.lower():
            return above, below, []
    if not told.odometry:
        raise LogError(
            f"{path}: nothing tells how the base moved: above the laser's frame are "
            f"{' on '.join(chain)}, of which none is odometry; expected a transform to a frame "
            "'odom' (/tf), or messages nav_msgs/Odometry"
        )
    odom, base = plain(told.odometry[0][0]), plain(told.odometry[0][1])
    for _, _, stamp, pose in told.odometry:
        told.transforms.add(odom, base, stamp, pose)
    if base in chain:
        return odom, base, []
    told.transforms.add(base, frame, told.scans[0].stamp, Transform())
    return (
        odom,
        base,
        [f"nothing tells where {frame!r} sits on {base!r}; taken to be at its middle, ahead"],
    )


def _mount(path: Path, transforms: Transforms, base: str, frame: str, stamp: float) -> Transform:
    base_from_laser = transforms.mounted(base, frame, stamp)
    if abs(float(base_from_laser.rotation[2, 2])) < LEVEL:
        raise LogError(
            f"{path}: the laser {frame!r} is not level on {base!r}; a floor plan needs scans "
            "parallel to the floor"
        )
    return base_from_laser
