"""When each point of a turn was measured: as its driver tells it, or by how far it had turned."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.mapping.logs.clouds.fields import Points

UNITS = (1.0, 1e-3, 1e-6, 1e-9)
"""Units that drivers write times in, s: which one it is, the length of a turn tells."""
SHORTEST, LONGEST = 5e-3, 2.0
"""Lengths of a turn, s; a thousandth of one is none."""
SAME_CLOCK = 1.0
"""How far times of points may lie from the header's stamp on one clock, s."""
FEWEST = 100
"""Points from which it can be told how a lidar turns."""
STEADY = 0.9
"""Least share of the steps along a ring that lead the same way round."""
ROUND = math.radians(270.0)
"""Least angle of a turn: what sees less than that, such as a camera, does not turn."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """When points were measured: at `stamp`, s, the last of them; times: (n,) s after it, none > 0.

    times None: nobody knows. how: in words, by which turns of a log are told apart.
    """

    stamp: float
    times: Array | None
    how: str


TOLD = "told"
OTHER_CLOCK = "told by another clock"
TURNED = "turned"
AT_ONCE = "at once"


def measured(points: Points, stamp: float, period: float) -> Measured:
    """When the points of a turn were measured.

    stamp: of the header, s. period: time between two turns, s.
    """
    told = None if points.times is None else _told(points.times, stamp)
    if told is not None:
        return told
    if points.rings is not None and len(points.xyz) >= FEWEST:
        share = _turned(points.xyz, points.rings)
        if share is not None:
            return Measured(stamp, (share - 1.0) * period, TURNED)
    return Measured(stamp, None, AT_ONCE)


def _told(times: Array, stamp: float) -> Measured | None:
    """Times of points in s; None if they tell nothing.

    Small ones count from the header's stamp. Those of another clock are laid so that the turn
    begins at the stamp, as the drivers that write them have it.
    """
    if not len(times):
        return None
    span = float(times.max() - times.min())
    unit = next((each for each in UNITS if SHORTEST <= span * each <= LONGEST), None)
    if unit is None:
        return None
    last = float(times.max())
    after = (times - last) * unit
    if abs(last * unit) <= LONGEST:
        return Measured(stamp + last * unit, after, TOLD)
    if abs(last * unit - stamp) <= SAME_CLOCK:
        return Measured(last * unit, after, TOLD)
    return Measured(stamp + span * unit, after, OTHER_CLOCK)


def _turned(xyz: Array, rings: NDArray[np.int64]) -> Array | None:
    """The share (n,) of the turn after which each point was measured; None: it does not turn so.

    Along each ring the points must come in the order in which the lidar turns, from the angle at
    which the message begins.
    """
    order = np.argsort(rings, kind="stable")
    angle = np.arctan2(xyz[order, 1], xyz[order, 0])
    ends = np.flatnonzero(np.diff(rings[order])) + 1
    begins = np.concatenate([[0], ends])
    steps = np.angle(np.exp(1j * np.diff(angle)))
    steps[ends - 1] = 0.0
    moved = steps[steps != 0.0]
    if len(moved) < FEWEST // 2:
        return None
    way = 1.0 if np.median(moved) > 0.0 else -1.0
    if float((way * moved > 0.0).mean()) < STEADY:
        return None
    gone = np.concatenate([[0.0], np.cumsum(way * steps)])
    gone -= np.repeat(gone[begins], np.diff([*begins, len(gone)]))
    if gone.max() < ROUND:
        return None
    first = np.angle(np.exp(1j * angle[begins]).mean())
    late = np.angle(np.exp(1j * way * (angle[begins] - first)))
    gone += np.repeat(late, np.diff([*begins, len(gone)]))
    share = np.empty(len(gone))
    share[order] = np.clip(gone / (2.0 * math.pi), 0.0, 1.0)
    return share
