"""What any log may have wrong: a clock that runs back, odd scans, beams that hit nothing."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.mapping.logs.log import LogError

Scan = TypeVar("Scan")

JITTER = 2.0
"""How far back a stamp may lie behind the one before, s: loggers on two machines."""
_AT_MOST = 0.005
"""Share of beams at the greatest range from which on it means that nothing was hit."""


def backwards(stamps: Sequence[float], error: Callable[[int, str, str], LogError]) -> list[str]:
    """A note of how many stamps are earlier than the one before, if any.

    error: makes the error for the scan of an index, with what is wrong and what to do.

    Raises:
        LogError: the clock jumps back.
    """
    count = 0
    for index, (before, after) in enumerate(itertools.pairwise(stamps), 1):
        if after < before - JITTER:
            message = f"the clock runs backwards, from {before} to {after} s"
            raise error(index, message, "two logs in one file are two maps: split the file here")
        count += after < before
    return [f"{count} scans have an earlier stamp than the one before"] if count else []


def alike(scans: Sequence[Scan], beams: Callable[[Scan], int]) -> tuple[list[Scan], list[str]]:
    """Those scans that have the usual number of beams, and a note of the others."""
    counts = [beams(scan) for scan in scans]
    usual = max(counts, key=counts.count)
    same = [scan for scan, count in zip(scans, counts, strict=True) if count == usual]
    if len(same) == len(scans):
        return same, []
    others = len(scans) - len(same)
    return same, [f"left out {others} scans that have not {usual} beams as the others"]


def no_return(ranges: Array) -> float:
    """The range, m, from which on a beam has hit nothing: the greatest one, if it is frequent."""
    finite = ranges[np.isfinite(ranges)]
    if not finite.size:
        return math.inf
    most = float(finite.max())
    often = float((finite >= 0.99 * most).mean()) >= _AT_MOST
    return 0.99 * most if often else math.inf
