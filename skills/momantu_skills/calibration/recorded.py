"""From two recorded trajectories to a hand-eye calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from momantu_bt.geometry import Array
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.hand_eye.estimate import LEAST_VIEWS, Estimate, estimate, rough
from momantu_skills.calibration.hand_eye.linear import UNKNOWNS
from momantu_skills.calibration.hand_eye.readings import Reading, better_reading
from momantu_skills.calibration.hand_eye.robust import robust
from momantu_skills.calibration.hand_eye.spread import check_spread
from momantu_skills.calibration.hand_eye.views import Mounting, Views, residuals
from momantu_skills.calibration.trajectory.pairing import distinct, paired
from momantu_skills.calibration.trajectory.time_offset import time_offset
from momantu_skills.calibration.trajectory.trajectory import Trajectory

_VIEWS_TO_ALIGN = 100
_TOO_FAR = 20.0
"""m; no robot moves its hand so far to look at a target that far away."""


class MisreadError(CalibrationError):
    """The files fit together far better if they are read in another way."""

    def __init__(self, reading: Reading) -> None:
        super().__init__(reading.value)
        self.reading = reading


@dataclass(frozen=True, slots=True)
class Settings:
    """How to calibrate.

    on_base: whether the camera stands on the base, and the target is in the hand. gap: s, see
    `Trajectory.at`. align: whether to estimate the offset between the clocks.
    """

    on_base: bool = False
    align: bool = False
    gap: float = 0.5
    seed: int = 0

    @property
    def carrier(self) -> str:
        """What carries the eye: "hand" or "base"."""
        return "base" if self.on_base else "hand"

    @property
    def holder(self) -> str:
        """What carries the target: "base" or "hand"."""
        return "hand" if self.on_base else "base"


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """A calibration and what it was made from.

    views: those used, and lines (N,): their lines in the target's file. samples: in the target's
    file; matched: of them, those at which the hand's pose is known. offset: s, to add to the
    target's stamps. turned: typical angles (3,) about three axes between views, rad.
    """

    settings: Settings
    hand: Trajectory
    target: Trajectory
    estimate: Estimate
    views: Views
    lines: NDArray[np.intp]
    samples: int
    matched: int
    offset: float
    turned: Array


def calibrate(hand: Trajectory, target: Trajectory, settings: Settings) -> Calibration:
    """Calibrate from `base_from_hand` and `camera_from_target` over time.

    Raises:
        CalibrationError: the records are the same, have no common time or too few different views,
            or do not determine the mounting.
        MisreadError: they are probably inverted, or in other units.
    """
    if hand.times.shape == target.times.shape and np.array_equal(hand.positions, target.positions):
        raise CalibrationError(
            f"{hand.name} and {target.name} hold the same poses; expected those of the hand in one "
            f"file, and those of the target in the camera's frame in the other"
        )
    _check_metres(hand, target)
    offset = time_offset(hand, target) if settings.align else 0.0
    views, lines, matched = _views(hand, target, offset, settings)
    _check_count(len(views), matched, target)
    turned = check_spread(views.outer, settings.carrier)
    reading = better_reading(views, settings.seed)
    if reading is not None:
        raise MisreadError(reading)
    if settings.align:
        offset = _refined_offset(hand, target, offset, settings)
        views, lines, matched = _views(hand, target, offset, settings)
    found = estimate(views, settings.seed)
    return Calibration(
        settings, hand, target, found, views, lines, len(target), matched, offset, turned
    )


def _check_metres(hand: Trajectory, target: Trajectory) -> None:
    """CalibrationError where both files are in another unit, which no residual shows."""
    moves = float(np.linalg.norm(np.ptp(hand.positions, axis=0)))
    away = float(np.median(np.linalg.norm(target.positions, axis=1)))
    if min(moves, away) > _TOO_FAR:
        raise CalibrationError(
            f"the hand moves by {moves:.0f} m, and the target is {away:.0f} m from the camera: "
            f"positions in {hand.name} and {target.name} are in millimetres or so; write metres"
        )


def _views(
    hand: Trajectory, target: Trajectory, offset: float, settings: Settings
) -> tuple[Views, NDArray[np.intp], int]:
    """The views, their lines in the target's file, and how many samples matched."""
    poses, seen = paired(hand, target, offset, settings.gap)
    chosen = distinct(poses)
    outer = poses[chosen].inverse() if settings.on_base else poses[chosen]
    return Views(outer, seen[chosen].poses), seen.lines[chosen], len(seen)


def _check_count(count: int, matched: int, target: Trajectory) -> None:
    if count >= LEAST_VIEWS:
        return
    if matched < LEAST_VIEWS:
        raise CalibrationError(
            f"{matched} of {len(target)} poses of {target.name} have a pose of the hand at the "
            f"same time; at least {LEAST_VIEWS} are needed, and 15 or more are good"
        )
    raise CalibrationError(
        f"all views are alike: of {matched} only {count} differ by 1 deg or 5 mm in the hand's "
        f"pose; at least {LEAST_VIEWS} are needed, and 15 or more are good"
    )


def _refined_offset(
    hand: Trajectory, target: Trajectory, offset: float, settings: Settings
) -> float:
    """The offset that explains positions and rotations best, near a first estimate."""
    poses, seen = paired(hand, target, offset, settings.gap)
    few = seen[distinct(poses, _VIEWS_TO_ALIGN)]
    views, _, _ = _views(hand, few, offset, settings)
    start = rough(views, settings.seed)

    def cost(change: float) -> float:
        changed, _, _ = _views(hand, few, offset + change, settings)
        return _misfit(changed, start.mounting, start.noise) if len(changed) >= LEAST_VIEWS else 1e9

    width = 1.5 * max(hand.step, target.step, 0.02)
    found = minimize_scalar(cost, bounds=(-width, width), method="bounded", options={"xatol": 1e-5})
    return offset + float(found.x)


def _misfit(views: Views, mounting: Mounting, noise: tuple[float, float]) -> float:
    """The mean residual of the best mounting, in units of given noise; one view counts little."""
    turned, away = residuals(views, robust(views, mounting).mounting)
    squares = (turned / noise[0]) ** 2 + (away / noise[1]) ** 2
    return float(np.mean(np.log1p(squares / (UNKNOWNS / 2))))
