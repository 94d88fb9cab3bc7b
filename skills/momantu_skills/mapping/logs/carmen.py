"""Logs of CARMEN: FLASER, ROBOTLASER1, and RAWLASER1 with ODOM; plain text or gzip.

The columns are those of CARMEN's logger, http://carmen.sourceforge.net/logger_playback.html.
"""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from momantu_bt.formats.names import counted
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.mapping.logs.cleaning import alike, backwards, is_place, no_return
from momantu_skills.mapping.logs.log import Log, LogError, LoggedScan
from momantu_skills.navigation.map.sensing import Rays

WORDS = ("FLASER", "ROBOTLASER1", "RAWLASER1", "ODOM")
"""Messages that are read; others, such as PARAM, RLASER and NEFF, say nothing of the map."""
_MOST_BYTES = 1_000_000_000
_MOST_BROKEN = 0.02
"""Largest share of broken lines: a cut-off line or two; more are another kind of file."""
_NEAREST = 0.02
"""Shorter ranges are the sensor's own housing, m."""
_SAME_MOUNT = 0.03
"""How far the laser's place on the base may vary in a raw log, m or rad."""
_HALF_TURN = 180.0


class _BrokenLineError(Exception):
    """What is wrong with one line."""


@dataclass(frozen=True, slots=True, eq=False)
class _Reading:
    """One scan's line. odom: None where the line does not say it; laser: of the same frame."""

    line: int
    stamp: float
    ranges: Array
    angles: Array
    farthest: float
    odom: Pose2D | None
    laser: Pose2D | None


def read_carmen(path: Path) -> Log:
    """The scans of a CARMEN log.

    Raises:
        LogError: the file cannot be read, is no such log, holds no scans, or is broken.
    """
    readings, odometry, broken = _lines(path)
    if not readings:
        raise LogError(_nothing(path, broken))
    lines = len(readings) + len(odometry) + len(broken)
    if len(broken) > max(1, _MOST_BROKEN * lines):
        line, why = broken[0]
        raise LogError.at(path, line, why, f"{len(broken)} of {lines} lines are broken")
    notes = []
    if broken:
        line, why = broken[0]
        notes.append(
            f"left out {counted(len(broken), 'broken line')}, the first is line {line}: {why}"
        )
    notes += backwards(
        [reading.stamp for reading in readings],
        lambda index, said, cure: LogError.at(path, readings[index].line, said, cure),
    )
    whole = [reading for reading in readings if reading.odom is not None]
    whole = whole or list(_with_odometry(path, readings, odometry))
    scans, odd = alike(path, whole, lambda reading: reading.ranges.size)
    return Log(tuple(_scans(scans)), (*notes, *odd))


def _lines(
    path: Path,
) -> tuple[list[_Reading], list[tuple[float, Pose2D]], list[tuple[int, str]]]:
    """Scans, odometry by its stamp, and broken lines with what is wrong."""
    readings: list[_Reading] = []
    odometry: list[tuple[float, Pose2D]] = []
    broken: list[tuple[int, str]] = []
    for number, words in _words(path):
        try:
            if words[0] == "ODOM":
                odometry.append(_odom(words))
            else:
                readings.append(_READERS[words[0]](number, words))
        except _BrokenLineError as error:
            broken.append((number, str(error)))
    return readings, odometry, broken


def _words(path: Path) -> Iterator[tuple[int, list[str]]]:
    try:
        with path.open("rb") as file:
            zipped = file.read(2) == b"\x1f\x8b"
            if path.stat().st_size > _MOST_BYTES:
                raise LogError(f"{path} has more than {_MOST_BYTES} bytes")
        with gzip.open(path, "rb") if zipped else path.open("rb") as stream:
            for number, line in enumerate(stream, 1):
                words = line.decode("ascii", "replace").split()
                if words and words[0] in WORDS:
                    yield number, words
    except (OSError, EOFError, zlib.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise LogError(f"the log {path} cannot be read: {reason}") from None


def _nothing(path: Path, broken: Sequence[tuple[int, str]]) -> str:
    if broken:
        line, why = broken[0]
        return f"{path}: no scan can be read; line {line}: {why}"
    if path.stat().st_size == 0:
        return f"{path} is empty"
    return (
        f"{path} holds no scans of CARMEN; expected lines that begin with FLASER, ROBOTLASER1 or "
        "RAWLASER1"
    )


def _numbers(words: Sequence[str], what: str) -> list[float]:
    try:
        return [float(word) for word in words]
    except ValueError:
        wrong = next(word for word in words if not _is_number(word))
        raise _BrokenLineError(f"{wrong!r} in {what} is not a number") from None


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _pose(words: Sequence[str], what: str) -> Pose2D:
    numbers = _numbers(words, what)
    if not (is_place(*numbers[:2]) and math.isfinite(numbers[2])):
        raise _BrokenLineError(f"{what} is {' '.join(words)}, expected finite metres and radians")
    return Pose2D(numbers[0], numbers[1], math.remainder(numbers[2], math.tau))


def _take(words: Sequence[str], at: int, count: int, what: str) -> list[str]:
    if count < 0 or len(words) < at + count:
        raise _BrokenLineError(f"the line ends within {what}")
    return list(words[at : at + count])


def _count(words: Sequence[str], at: int, what: str) -> int:
    word = _take(words, at, 1, what)[0]
    if not word.isdigit():
        raise _BrokenLineError(f"{word!r} is not a number of {what}")
    return int(word)


def _stamp(words: Sequence[str], at: int) -> float:
    stamp = _numbers(_take(words, at, 1, "the stamp"), "the stamp")[0]
    if not math.isfinite(stamp):
        raise _BrokenLineError(f"the stamp is {words[at]}, expected seconds")
    return stamp


def _odom(words: Sequence[str]) -> tuple[float, Pose2D]:
    stamp = _stamp(words, 7)
    return stamp, _pose(_take(words, 1, 3, "the pose"), "the pose")


def _flaser(line: int, words: Sequence[str]) -> _Reading:
    count = _count(words, 1, "ranges")
    ranges = np.array(_numbers(_take(words, 2, count, "the ranges"), "the ranges"))
    at = 2 + count
    laser = _pose(_take(words, at, 3, "the laser's pose"), "the laser's pose")
    odom = _pose(_take(words, at + 3, 3, "the odometry"), "the odometry")
    stamp = _stamp(words, at + 6)
    return _Reading(line, stamp, ranges, _half_turn(count), math.inf, odom, laser)


def _half_turn(count: int) -> Array:
    """Angles of a SICK's beams: 181 and 361 end on both sides, 180 and 360 before the left one."""
    step = _HALF_TURN / max(1, count - count % 2)
    return np.asarray(np.radians(-_HALF_TURN / 2 + step * np.arange(count)))


def _laser_head(words: Sequence[str]) -> tuple[int, Array, Array, float]:
    """The index after the remissions, the ranges, their angles, and the greatest range."""
    start, _, step, farthest = _numbers(_take(words, 2, 4, "the laser's angles"), "the angles")
    count = _count(words, 8, "ranges")
    ranges = np.array(_numbers(_take(words, 9, count, "the ranges"), "the ranges"))
    remissions = _count(words, 9 + count, "remissions")
    angles = np.asarray(start + step * np.arange(count), dtype=np.float64)
    return 10 + count + remissions, ranges, angles, farthest


def _robotlaser(line: int, words: Sequence[str]) -> _Reading:
    at, ranges, angles, farthest = _laser_head(words)
    laser = _pose(_take(words, at, 3, "the laser's pose"), "the laser's pose")
    odom = _pose(_take(words, at + 3, 3, "the robot's pose"), "the robot's pose")
    stamp = _stamp(words, at + 11)
    return _Reading(line, stamp, ranges, angles, farthest, odom, laser)


def _rawlaser(line: int, words: Sequence[str]) -> _Reading:
    at, ranges, angles, farthest = _laser_head(words)
    stamp = _stamp(words, at)
    return _Reading(line, stamp, ranges, angles, farthest, None, None)


_READERS = {"FLASER": _flaser, "ROBOTLASER1": _robotlaser, "RAWLASER1": _rawlaser}


def _scans(whole: Sequence[_Reading]) -> Iterator[LoggedScan]:
    """The scans of lines with odometry, all with as many beams."""
    nothing = no_return(np.concatenate([reading.ranges for reading in whole]))
    mount = _mount(whole)
    for reading in whole:
        assert reading.odom is not None
        angles = reading.angles + mount.yaw
        hit = np.isfinite(reading.ranges) & (reading.ranges > _NEAREST)
        hit &= reading.ranges < min(nothing, reading.farthest)
        rays = Rays(
            np.array([mount.x, mount.y]),
            np.column_stack([np.cos(angles), np.sin(angles)]),
            np.where(hit, reading.ranges, 0.0),
            hit,
        )
        yield LoggedScan(reading.stamp, reading.odom, rays)


def _mount(readings: Sequence[_Reading]) -> Pose2D:
    """`base_from_laser`, from a raw log; a corrected one does not tell it, so zero."""
    offsets = np.array(
        [
            (found.x, found.y, found.yaw)
            for each in readings
            if each.odom is not None and each.laser is not None
            for found in [each.odom.inverse() @ each.laser]
        ]
    )
    if not len(offsets):
        return Pose2D(0.0, 0.0)
    middle = np.median(offsets, axis=0)
    if float(np.quantile(np.abs(offsets - middle).max(axis=1), 0.95)) > _SAME_MOUNT:
        return Pose2D(0.0, 0.0)
    return Pose2D(*(float(value) for value in middle))


def _with_odometry(
    path: Path, readings: Sequence[_Reading], odometry: Sequence[tuple[float, Pose2D]]
) -> Iterator[_Reading]:
    """RAWLASER1's scans with the odometry at their stamps, between two lines ODOM."""
    if len(odometry) < 2:
        raise LogError(f"{path}: scans without odometry; expected lines ODOM beside RAWLASER1")
    stamps = np.array([stamp for stamp, _ in odometry])
    if not stamps[0] < readings[-1].stamp <= stamps[-1]:
        raise LogError(f"{path}: the stamps of ODOM and RAWLASER1 do not overlap")
    for each in readings:
        after = int(np.searchsorted(stamps, each.stamp))
        if not 0 < after < len(stamps):
            continue
        (t0, before), (t1, later) = odometry[after - 1], odometry[after]
        part = 0.0 if t1 <= t0 else (each.stamp - t0) / (t1 - t0)
        step = before.inverse() @ later
        odom = before @ Pose2D(part * step.x, part * step.y, part * step.yaw)
        yield _Reading(each.line, each.stamp, each.ranges, each.angles, each.farthest, odom, None)
