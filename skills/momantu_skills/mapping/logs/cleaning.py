"""What any log may have wrong: a clock that runs back, odd scans, beams that hit nothing."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from momantu_bt.formats.names import counted
from momantu_bt.geometry import Array
from momantu_skills.mapping.logs.log import LogError

Scan = TypeVar("Scan")

JITTER = 2.0
"""How far back a stamp may lie behind the one before, s: loggers on two machines."""
MOST_ODD = 0.5
"""Largest share of scans with another number of beams: with more, nothing is usual."""
FARTHEST = 1e6
"""Where odometry may lie at most, m: what is farther away is no pose."""
_AT_MOST = 0.005
"""Share of beams at the greatest range from which on it means that nothing was hit."""


def backwards(
    stamps: Sequence[float], error: Callable[[int, str, str], LogError], what: str = "scan"
) -> list[str]:
    """A note of how many stamps are earlier than the one before, if any.

    what: is stamped, in the singular. error: makes the error for the scan of an index, with what is
    wrong and what to do.

    Raises:
        LogError: the clock jumps back, or goes back little by little.
    """
    count, newest = 0, -math.inf
    for index, (before, after) in enumerate(itertools.pairwise(stamps), 1):
        newest = max(newest, before)
        if after < newest - JITTER:
            message = f"the clock runs backwards, from {newest} to {after} s"
            raise error(index, message, "two logs in one file are two maps: split the file here")
        count += after < before
    verb = "has" if count == 1 else "have"
    said = f"{counted(count, what)} {verb} an earlier stamp than the one before"
    return [said] if count else []


def alike(
    path: Path, scans: Sequence[Scan], beams: Callable[[Scan], int]
) -> tuple[list[Scan], list[str]]:
    """Those scans that have the usual number of beams, and a note of the others.

    Raises:
        LogError: most scans have other numbers.
    """
    counts = [beams(scan) for scan in scans]
    usual = max(counts, key=counts.count)
    same = [scan for scan, count in zip(scans, counts, strict=True) if count == usual]
    if len(same) == len(scans):
        return same, []
    others = len(scans) - len(same)
    if others > MOST_ODD * len(scans):
        raise LogError(
            f"{path}: the scans have {min(counts)} to {max(counts)} beams, and no number is that "
            f"of most of them; expected one laser, whose scans have as many beams each"
        )
    verb = "has" if others == 1 else "have"
    said = f"left out {counted(others, 'scan')} that {verb} not {usual} beams as the others"
    return same, [said]


def is_place(*metres: float) -> bool:
    """Whether coordinates, m, may be those of a base: finite, and not beyond `FARTHEST`."""
    return all(abs(each) < FARTHEST for each in metres)


def no_return(ranges: Array) -> float:
    """The range, m, from which on a beam has hit nothing: the greatest one, if it is frequent."""
    finite = ranges[np.isfinite(ranges)]
    if not finite.size:
        return math.inf
    most = float(finite.max())
    often = float((finite >= 0.99 * most).mean()) >= _AT_MOST
    return 0.99 * most if often else math.inf
