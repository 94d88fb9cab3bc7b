"""Scans and frames of a log, as robots publish them: where the base was at each scan."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from momantu_bt.formats.names import counted
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import LaserScan
from momantu_skills.mapping.logs import by_scans
from momantu_skills.mapping.logs.cleaning import alike, backwards, is_place, no_return
from momantu_skills.mapping.logs.log import Log, LogError, LoggedScan
from momantu_skills.mapping.logs.transforms import Transforms, plain
from momantu_skills.navigation.map.sensing import Rays

FEWEST_MATCHED = 0.8
"""Least share of scans that have to fit those before, where they alone tell how the base moved."""
LEVEL = 0.985
"""Least cosine of the angle between the laser's axis and the vertical: 10 degrees."""


@dataclass(slots=True)
class Published:
    """What a log tells. scans: of one laser.

    odometry: (odom, base, stamp, `odom_from_base`), of messages that tell nothing else. broken: how
    many poses were left out, as they are none; see `pose_of`.
    """

    scans: list[LaserScan] = field(default_factory=list)
    transforms: Transforms = field(default_factory=Transforms)
    odometry: list[tuple[str, str, float, Transform]] = field(default_factory=list)
    broken: int = 0

    def frame(self, parent: str, child: str, stamp: float, pose: Transform | None) -> None:
        """Enter `parent_from_child` at a time, s; None counts as broken."""
        if pose is None:
            self.broken += 1
        else:
            self.transforms.add(parent, child, stamp, pose)

    def moved(self, odom: str, base: str, stamp: float, pose: Transform | None) -> None:
        """Enter `odom_from_base` at a time, s; None counts as broken."""
        if pose is None:
            self.broken += 1
        else:
            self.odometry.append((odom, base, stamp, pose))


def pose_of(position: Sequence[float], quaternion: Sequence[float]) -> Transform | None:
    """The pose of a position, m, and a quaternion w x y z; None if their numbers are no pose."""
    length = math.hypot(*quaternion)
    if not is_place(*position) or not 0.0 < length < math.inf:
        return None
    return Transform(position, quaternion)


def placed(path: Path, told: Published, laid: Callable[[int, int], None] | None = None) -> Log:
    """The scans with odometry, oldest first. Where none is told, the scans tell how the base moved.

    laid: told then how many of how many scans are laid on those before.

    Raises:
        LogError: nothing tells how the base moved, the laser is not level, or the clock runs back.
    """
    frame = plain(told.scans[0].frame)
    _check_angles(path, told.scans[0])
    found_base = moving(frame, told.scans[0].stamp, told)
    base = told.transforms.carrier(frame) if found_base is None else found_base.base
    notes = [] if found_base is None else list(found_base.notes)
    if told.broken:
        notes.append(broken_poses(told))
    scans, odd = alike(path, told.scans, lambda scan: scan.ranges.size)
    notes += odd
    stamps = [scan.stamp for scan in scans]
    notes += backwards(stamps, lambda _, said, cure: LogError(f"{path}: {said}\n  {cure}"))
    ranges = np.concatenate([scan.ranges for scan in scans])
    farthest = no_return(ranges) if np.isfinite(ranges).all() else math.inf
    seen = []
    for scan in scans:
        limited = replace(scan, range_max=min(scan.range_max, farthest))
        mount = _mount(path, told.transforms, base, frame, scan.stamp)
        seen.append((scan.stamp, Rays.from_scan(limited, mount)))
    if found_base is None:
        return _by_scans(path, frame, told, seen, notes, laid)
    return _by_odometry(path, found_base, told, seen, notes)


def _by_odometry(
    path: Path,
    base: Moving,
    told: Published,
    seen: Sequence[tuple[float, Rays]],
    notes: Sequence[str],
) -> Log:
    """seen: stamps, s, and beams in base."""
    found = []
    for stamp, rays in seen:
        odom_from_base = told.transforms.moved(base.base, stamp)
        if odom_from_base is not None:
            found.append(LoggedScan(stamp, Pose2D.from_transform(odom_from_base), rays))
    if not found:
        raise LogError(f"{path}: the stamps of the scans and of {base.odom!r} do not overlap")
    if len(found) == len(seen):
        return Log(tuple(found), tuple(notes))
    without = counted(len(seen) - len(found), "scan")
    said = f"left out {without} at whose time no odometry is told"
    return Log(tuple(found), (*notes, said))


def _by_scans(
    path: Path,
    frame: str,
    told: Published,
    seen: Sequence[tuple[float, Rays]],
    notes: Sequence[str],
    laid: Callable[[int, int], None] | None,
) -> Log:
    """seen: stamps, s, and beams in base."""
    ways = by_scans.reckoned(seen, laid)
    if ways.matched < FEWEST_MATCHED * len(seen):
        raise _motionless(path, frame, told, len(seen) - ways.matched, len(seen))
    said = (
        "nothing tells how the base moved, so the scans do, each laid on those before; along bare "
        "corridors they do not show how far it went"
    )
    poses = zip(seen, ways.odom_from_base, strict=True)
    found = tuple(LoggedScan(stamp, pose, rays) for (stamp, rays), pose in poses)
    return Log(found, (*notes, said))


def broken_poses(told: Published) -> str:
    """A note of poses that were left out."""
    return f"left out {counted(told.broken, 'pose')} whose numbers are not finite, or no pose's"


def _check_angles(path: Path, scan: LaserScan) -> None:
    """Refuse scans whose beams point nowhere, or all in one direction."""
    turned = abs(scan.angle_increment) * (scan.ranges.size - 1)
    if scan.ranges.size < 2 or (math.isfinite(scan.angle_min) and 0.0 < turned < 3.0 * math.pi):
        return
    raise LogError(
        f"{path}: the scans of {scan.frame!r} begin at {scan.angle_min:g} rad and have "
        f"{scan.ranges.size} beams each {scan.angle_increment:g} rad apart; expected beams over at "
        "most a turn"
    )


@dataclass(frozen=True, slots=True)
class Moving:
    """The frame of odometry, that of the base which moves in it, and what was assumed, in words."""

    odom: str
    base: str
    notes: tuple[str, ...] = ()


def moving(frame: str, stamp: float, told: Published) -> Moving | None:
    """Where the base of a sensor's frame moves; None: nothing tells.

    Where nothing tells the sensor's mount, it is entered for `stamp`, s: in the base's middle.
    """
    chain = told.transforms.above(frame)
    for below, above in itertools.pairwise(chain):
        if above in {plain(odom) for odom, *_ in told.odometry} or "odom" in above.lower():
            return Moving(above, below)
    if told.odometry:
        odom, base = plain(told.odometry[0][0]), plain(told.odometry[0][1])
        for _, _, when, pose in told.odometry:
            told.transforms.add(odom, base, when, pose)
        if base in chain:
            return Moving(odom, base)
    elif (pair := told.transforms.in_odometry()) is not None:
        odom, base = pair
    else:
        return None
    told.transforms.add(base, frame, stamp, Transform())
    said = f"nothing tells where {frame!r} sits on {base!r}; taken to be at its middle, ahead"
    return Moving(odom, base, (said,))


def _motionless(path: Path, frame: str, told: Published, lost: int, count: int) -> LogError:
    broken = f"; {counted(told.broken, 'pose')} left out, which are none" if told.broken else ""
    return LogError(
        f"{path}: nothing tells how the base moved: {lost} of {count} scans do not fit those "
        f"before, and above the laser's frame are {' on '.join(told.transforms.above(frame))}, of "
        "which none is odometry; expected a transform to a frame 'odom' (/tf), or messages "
        f"nav_msgs/Odometry{broken}"
    )


def _mount(path: Path, transforms: Transforms, base: str, frame: str, stamp: float) -> Transform:
    base_from_laser = transforms.mounted(base, frame, stamp)
    if abs(float(base_from_laser.rotation[2, 2])) < LEVEL:
        raise LogError(
            f"{path}: the laser {frame!r} is not level on {base!r}; a floor plan needs scans "
            "parallel to the floor"
        )
    return base_from_laser
