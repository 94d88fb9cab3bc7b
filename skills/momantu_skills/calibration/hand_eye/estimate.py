"""The whole estimate: a robust start, the joint refinement, and all methods on poses held back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.hand_eye.closed_form import METHODS, closed_form
from momantu_skills.calibration.hand_eye.refine import Refined, refine
from momantu_skills.calibration.hand_eye.robust import Robust, robust
from momantu_skills.calibration.hand_eye.start import (
    POSITION_NOISE,
    ROTATION_NOISE,
    starts,
)
from momantu_skills.calibration.hand_eye.views import Mounting, Views, residuals
from momantu_skills.calibration.poses import Indices

JOINT = "joint"
"""The joint refinement's name among the methods."""
LEAST_VIEWS = 5
_FOLDS = 5
_MOST_NOISE = math.radians(5.0)
_UNEXPLAINED = 0.5
"""Noise of positions per axis, as a share of how far the target moves in the camera's frame."""
_LEAST_SPREAD = 0.02


@dataclass(frozen=True, slots=True)
class Method:
    """One method. rotation, position: medians of its residuals, rad and m, on views held back.

    eye: by all views; None where the method fails, and then both residuals are NaN.
    """

    name: str
    eye: Transform | None
    rotation: float
    position: float


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """The result. rotations, positions: the residuals of all views (N,), rad and m."""

    refined: Refined
    methods: tuple[Method, ...]
    rotations: Array
    positions: Array


def solve(views: Views, seed: int) -> Refined:
    """The joint refinement.

    Raises:
        CalibrationError: there are too few views, or they determine nothing.
    """
    return _refined(views, rough(views, seed))


def rough(views: Views, seed: int) -> Robust:
    """Robust least squares from the best of several starts.

    Raises:
        CalibrationError: there are too few views, or they determine nothing.
    """
    found = []
    for start in starts(views, np.random.default_rng(seed)):
        try:
            found.append(robust(views, start.mounting))
        except np.linalg.LinAlgError:
            continue
    if not found:
        raise _undetermined()
    return min(found, key=lambda each: _typical(views, each.mounting))


def _refined(views: Views, start: Robust) -> Refined:
    try:
        return refine(views, start)
    except np.linalg.LinAlgError:
        raise _undetermined() from None


def _undetermined() -> CalibrationError:
    return CalibrationError(
        "the views determine no mounting: turn the hand more, about two axes or more"
    )


def estimate(views: Views, seed: int = 0) -> Estimate:
    """Estimate the mounting, and compare the methods on views held back.

    Raises:
        CalibrationError: there are too few views, they determine nothing, or fewer than half of
            them agree.
    """
    if len(views) < LEAST_VIEWS:
        raise CalibrationError(
            f"{len(views)} different views; at least {LEAST_VIEWS} are needed, 15 or more are good"
        )
    start = rough(views, seed)
    _check_fit(views, start)
    refined = _refined(views, start)
    rotations, positions = residuals(views, refined.mounting)
    return Estimate(refined, _compared(views, refined, seed), rotations, positions)


def _check_fit(views: Views, found: Robust) -> None:
    """CalibrationError where the mounting explains hardly anything."""
    positions = views.camera_from_target.positions
    spread = np.linalg.norm(positions - np.median(positions, axis=0), axis=1)
    most = max(_UNEXPLAINED * float(np.median(spread)), _LEAST_SPREAD)
    if found.right.mean() <= 0.5 or found.noise[0] > _MOST_NOISE or found.noise[1] > most:
        turned, away = residuals(views, found.mounting)
        raise CalibrationError(
            f"the files do not fit together: half of the {len(views)} views are off by more than "
            f"{math.degrees(np.median(turned)):.1f} deg and {1e3 * np.median(away):.0f} mm. Are "
            f"they of the same recording, with the same clock (--align-time finds an offset), and "
            f"did the target and the camera stay where they are fixed?"
        )


def _typical(views: Views, mounting: Mounting) -> float:
    turned, away = residuals(views, mounting)
    return float(np.median((turned / ROTATION_NOISE) ** 2 + (away / POSITION_NOISE) ** 2))


def _compared(views: Views, refined: Refined, seed: int) -> tuple[Method, ...]:
    """All methods; each view is held back once."""
    folds = _folds(len(views), seed)
    rows = []
    for name in (*METHODS, JOINT):
        held = [_held_back(views, fold, name, seed) for fold in folds]
        turned, away = (np.concatenate(each) for each in zip(*held, strict=True))
        whole = refined.mounting if name == JOINT else closed_form(views, name)
        rows.append(
            Method(
                name,
                None if whole is None else whole.eye,
                float(np.median(turned)),
                float(np.median(away)),
            )
        )
    return tuple(rows)


def _folds(count: int, seed: int) -> list[Indices]:
    shuffled = np.random.default_rng(seed).permutation(count)
    return [np.sort(each) for each in np.array_split(shuffled, min(_FOLDS, count))]


def _held_back(views: Views, fold: Indices, name: str, seed: int) -> tuple[Array, Array]:
    """Residuals of the views of a fold, by a method that saw the other views only."""
    rest = views[np.setdiff1d(np.arange(len(views)), fold)]
    mounting: Mounting | None
    try:
        mounting = solve(rest, seed).mounting if name == JOINT else closed_form(rest, name)
    except CalibrationError:
        mounting = None
    if mounting is None:
        lost = np.full(len(fold), np.nan)
        return lost, lost
    return residuals(views[fold], mounting)
