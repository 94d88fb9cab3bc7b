"""Moments at which two trajectories are both known, and which of them differ enough to count."""

from __future__ import annotations

import math

import numpy as np

from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.poses import Indices, Poses, angles
from momantu_skills.calibration.trajectory.trajectory import Trajectory

MOST = 300
"""Views beyond this many add nothing but time."""
_TURN = math.radians(1.0)
_SHIFT = 0.005
"""A view counts if the hand has turned or moved this far, rad and m, since the last that counts."""
_FACTORS = {1e3: "milliseconds", 1e6: "microseconds", 1e9: "nanoseconds"}


def paired(
    hand: Trajectory, target: Trajectory, offset: float, gap: float
) -> tuple[Poses, Trajectory]:
    """The hand's poses at the target's stamps plus offset, and those samples of the target.

    Raises:
        CalibrationError: no stamp of the target lies in the hand's record.
    """
    times = target.times + offset
    if times[-1] < hand.times[0] - gap or times[0] > hand.times[-1] + gap:
        raise CalibrationError(_no_overlap(hand, target, offset))
    poses, known = hand.at(times, gap)
    if not known.any():
        raise CalibrationError(
            f"no pose of {target.name} lies between two poses of {hand.name} that are at most "
            f"{gap:g} s apart (its poses come every {hand.step:.3g} s); --gap sets that time"
        )
    return poses[known], target[known]


def distinct(hand: Poses, most: int = MOST) -> Indices:
    """The indices of views that differ in the hand's pose, at most so many, evenly chosen."""
    kept = [0]
    for index in range(1, len(hand)):
        last, this = hand.rotations[kept[-1]], hand.rotations[index]
        shift = np.linalg.norm(hand.positions[index] - hand.positions[kept[-1]])
        if shift > _SHIFT or angles(last.T @ this) > _TURN:
            kept.append(index)
    even = np.linspace(0, len(kept) - 1, min(most, len(kept))).round().astype(int)
    return np.asarray(np.array(kept)[np.unique(even)])


def _no_overlap(hand: Trajectory, target: Trajectory, offset: float) -> str:
    spans = " and ".join(
        f"{each.name} lasts from {each.times[0] + more:.3f} to {each.times[-1] + more:.3f} s"
        for each, more in ((hand, 0.0), (target, offset))
    )
    for each, other in ((hand, target), (target, hand)):
        unit = _unit(each, other)
        if unit:
            return f"no overlap in time: {spans}. Stamps of {each.name} look like {unit}; write s"
    return (
        f"no overlap in time: {spans}. Are they of the same recording? If their clocks differ, "
        f"--align-time finds the offset from the motions"
    )


def _unit(each: Trajectory, other: Trajectory) -> str:
    """The unit of the stamps of `each`, if those of `other` are in s; empty for s."""
    for factor, unit in _FACTORS.items():
        if not 1e-4 < each.step / factor < 10.0:
            continue
        if other.times[0] and 0.5 < abs(each.times[0] / other.times[0]) / factor < 2.0:
            return unit
        if other.step and 0.1 < _duration(each) / _duration(other) / factor < 10.0:
            return unit
    return ""


def _duration(each: Trajectory) -> float:
    return float(each.times[-1] - each.times[0])
