"""The offset between the clocks of two trajectories, from how fast both turn.

Two frames of one rigid body, or one frame seen from two sides, turn equally fast at each moment,
whatever the unknown transforms between them are.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import correlate

from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.poses import Mask, angles
from momantu_skills.calibration.trajectory.trajectory import Trajectory

_SLOWEST = 0.5
"""s between two samples: slower files do not tell how fast something turns."""
_LEAST_CORRELATION = 0.5
_LEAST_OVERLAP = 0.3
"""Share of the shorter record that two records must have in common."""
_HALF_WINDOW = 0.1
_MOST_SAMPLES = 200_000


def time_offset(first: Trajectory, second: Trajectory) -> float:
    """What to add to the stamps of `second` for the clock of `first`, s; right to about one sample.

    Raises:
        CalibrationError: a file has too few samples in a second, or the motions do not correlate.
    """
    for each in (first, second):
        if not 0 < each.step <= _SLOWEST:
            raise CalibrationError(
                f"{each.name} has a pose every {each.step:.3g} s; --align-time needs motions, with "
                f"at least {1 / _SLOWEST:.0f} poses a second"
            )
    step = max(first.step, second.step, 0.01)
    longest = max(each.times[-1] - each.times[0] for each in (first, second))
    step = max(step, longest / _MOST_SAMPLES)
    speed, known = _speeds(first, step)
    other, other_known = _speeds(second, step)
    lag, best = _best_lag(speed, known, other, other_known)
    if best < _LEAST_CORRELATION:
        raise CalibrationError(
            f"the motions of {first.name} and {second.name} do not correlate (at best {best:.2f}, "
            f"of 1; {_LEAST_CORRELATION} is needed): are they of the same recording? Turn the hand "
            f"fast and slowly, about several axes"
        )
    return float(first.times[0] - second.times[0] + lag * step)


def _speeds(trajectory: Trajectory, step: float) -> tuple[Array, Mask]:
    """Angular speeds, rad/s, every `step` s from the first sample on; and which are known."""
    times = np.arange(trajectory.times[0], trajectory.times[-1], step)
    half = max(_HALF_WINDOW, step)
    gap = max(0.3, 3 * trajectory.step)
    before, known_before = trajectory.at(times - half, gap)
    after, known_after = trajectory.at(times + half, gap)
    turned = angles(np.swapaxes(before.rotations, -1, -2) @ after.rotations)
    known = known_before & known_after
    return np.where(known, turned / (2 * half), 0.0), known


def _best_lag(first: Array, known: Mask, second: Array, second_known: Mask) -> tuple[float, float]:
    """The lag of `second` behind the start of `first`, in samples, and its correlation in 0 to 1.

    Only what is known in both counts (Padfield, Masked Object Registration in the Fourier Domain,
    2012).
    """
    a, b = known.astype(float), second_known.astype(float)
    both = np.maximum(correlate(a, b), 1e-9)
    sums = correlate(first, b), correlate(a, second)
    product = correlate(first, second) - sums[0] * sums[1] / both
    spread = correlate(first**2, b) - sums[0] ** 2 / both
    other = correlate(a, second**2) - sums[1] ** 2 / both
    floor = 1e-6 * max(float(spread.max()), 1e-12), 1e-6 * max(float(other.max()), 1e-12)
    found = product / np.sqrt(np.maximum(spread, floor[0]) * np.maximum(other, floor[1]))
    enough = both >= _LEAST_OVERLAP * min(a.sum(), b.sum())
    found = np.where(enough, found, -1.0)
    peak = int(np.argmax(found))
    return peak - (len(second) - 1) + _between(found, peak), float(found[peak])


def _between(values: Array, peak: int) -> float:
    """Where a parabola through a peak and its neighbours is highest, relative to the peak."""
    if not 0 < peak < len(values) - 1:
        return 0.0
    left, middle, right = (float(v) for v in values[peak - 1 : peak + 2])
    bend = left - 2 * middle + right
    shift = 0.5 * (left - right) / bend if bend < 0 else 0.0
    return shift if math.isfinite(shift) and abs(shift) <= 1 else 0.0
