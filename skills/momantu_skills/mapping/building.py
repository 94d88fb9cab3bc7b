"""From the scans of a log to a floor plan."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.formats.maps import MapPicture
from momantu_bt.geometry import Pose2D
from momantu_skills.mapping.config import MappingConfig
from momantu_skills.mapping.logs.log import LoggedScan
from momantu_skills.mapping.mapper import Mapper
from momantu_skills.mapping.occupancy import floor_plan
from momantu_skills.mapping.results import report_of

FEWEST = 2
"""Fewest scans of a map."""
MATCHED_EVERY = 0.1
"""The base must have driven this, m, or turned by as much, rad, since the last scan in use."""


@dataclass(frozen=True, slots=True, eq=False)
class Built:
    """A map. poses: `map_from_base` of the scans at `stamps`. interrupted: it ends early."""

    plan: MapPicture
    stamps: tuple[float, ...]
    poses: tuple[Pose2D, ...]
    report: dict[str, Any]
    interrupted: bool


def build(
    scans: Sequence[LoggedScan], resolution: float, progress: Callable[[int, int], bool]
) -> Built:
    """Map scans, oldest first.

    progress: told how many scans are done and how many loops are closed; if it returns True, the
    mapping ends there.
    """
    config = MappingConfig()
    mapper, used = Mapper(config), list[LoggedScan]()
    done = 0
    for done, scan in enumerate(scans, 1):
        if not used or _moved(used[-1], scan):
            mapper.add(scan.odom_from_base, scan.rays)
            used.append(scan)
        if progress(done, len(mapper.loops)):
            break
    mapper.finish()
    placed = [(pose, scan.rays) for pose, scan in zip(mapper.poses, used, strict=True)]
    plan = floor_plan(placed, resolution, config.longest)
    report = {"scans_read": done, **report_of(plan, mapper.poses, len(mapper.loops))}
    read = scans[:done]
    poses = tuple(_all_poses(read, used, mapper.poses))
    return Built(plan, tuple(scan.stamp for scan in read), poses, report, done < len(scans))


def _all_poses(
    read: Sequence[LoggedScan], used: Sequence[LoggedScan], poses: Sequence[Pose2D]
) -> Iterator[Pose2D]:
    """The pose of each scan: those that were not used are a step of odometry from the last used."""
    at = -1
    for scan in read:
        if at + 1 < len(used) and scan is used[at + 1]:
            at += 1
        yield poses[at] @ (used[at].odom_from_base.inverse() @ scan.odom_from_base)


def _moved(last: LoggedScan, scan: LoggedScan) -> bool:
    step = last.odom_from_base.inverse() @ scan.odom_from_base
    return abs(step.x) + abs(step.y) + abs(step.yaw) > MATCHED_EVERY
