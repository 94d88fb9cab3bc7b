"""The joint refinement: non-linear least squares over both unknowns, robust to wrong views.

A view's residual is the rotation vector and the position between the target as it was seen and as
it was predicted, each in units of its own noise, which is estimated from the residuals.
Gauss-Newton steps with Tukey's biweight for a whole view: a view far off has no influence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from momantu_bt.geometry import Array, Transform
from momantu_skills.calibration.hand_eye.views import Mounting, Views, predicted
from momantu_skills.calibration.poses import Mask, rotation_vectors, rotations_of, skew

UNKNOWNS = 12
_CUT = 40.0
"""Squared residual in units of noise from which on a view has no weight."""
_OUTLIER = float(chi2.ppf(0.9999, 6))
"""One good view of 10,000 lies beyond."""
_MEDIAN = float(chi2.ppf(0.5, 3))
_LEAST_NOISE = 1e-6
"""rad and m: no instrument is better, and rounding in files is no reason to call a view wrong."""
_STEPS = 60
_SMALLEST_STEP = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """The estimate.

    covariance: (12, 12) of small turns and shifts of the eye (about the camera's axes in rad,
    along the hand's or base's in m) and of the target. noise: of rotation per axis in rad, and of
    position per axis in m. outliers: the views (N,) that the estimate calls wrong.
    """

    mounting: Mounting
    covariance: Array
    noise: tuple[float, float]
    outliers: Mask

    @property
    def rotation_deviations(self) -> Array:
        """Standard deviations (3,) of the eye's rotation about the camera's axes, rad."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[:3]))

    @property
    def position_deviations(self) -> Array:
        """Standard deviations (3,) of the eye's position, m."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[3:6]))


def refine(views: Views, mounting: Mounting) -> Refined:
    """Refine both unknowns from a start that is roughly right.

    Raises:
        numpy.linalg.LinAlgError: the views do not determine the unknowns.
    """
    line = _linearised(views, mounting)
    noise = _median_noise(line.turned, line.moved)
    for _ in range(_STEPS):
        step = _step(*_weighed(line, noise))
        mounting = _moved(mounting, step)
        line = _linearised(views, mounting)
        noise = _noise(line.turned, line.moved, noise)
        if np.linalg.norm(step) < _SMALLEST_STEP:
            break
    rows, _, _ = _weighed(line, noise)
    fine = _squares(line.turned, line.moved, noise) <= _OUTLIER
    return Refined(
        mounting,
        np.linalg.inv(np.einsum("nri,nrj->ij", rows[fine], rows[fine])),
        noise,
        ~fine,
    )


def scale_of_target(views: Views, refined: Refined) -> tuple[float, float]:
    """By what factor the target's positions are too small, and its standard deviation.

    It is not 1 where the size of the target's squares or tags is wrong.
    """
    rows, residual, weights = _weighed(_linearised(views, refined.mounting), refined.noise)
    scaled = np.zeros((len(views), 6, 1))
    scaled[:, 3:, 0] = views.camera_from_target.positions / refined.noise[1]
    rows = np.concatenate([rows, scaled], axis=2)
    square = np.einsum("n,nri,nrj->ij", weights, rows, rows)
    side = -np.einsum("n,nri,nr->i", weights, rows, residual)
    covariance = np.linalg.pinv(square)
    return 1.0 + float(covariance[-1] @ side), float(np.sqrt(covariance[-1, -1]))


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """Residuals of rotation and position (N, 3), and their Jacobians (N, 3, 12).

    The Jacobians are with respect to turns `R Exp(turn)` and shifts of the eye and of the target.
    """

    turned: Array
    moved: Array
    of_turned: Array
    of_moved: Array


def _weighed(line: _Line, noise: tuple[float, float]) -> tuple[Array, Array, Array]:
    """The Jacobian (N, 6, 12) and residuals (N, 6) in units of noise, and weights (N,)."""
    rows = np.concatenate([line.of_turned / noise[0], line.of_moved / noise[1]], axis=1)
    residual = np.hstack([line.turned / noise[0], line.moved / noise[1]])
    inside = np.clip(1.0 - _squares(line.turned, line.moved, noise) / _CUT, 0.0, None)
    return rows, residual, inside**2


def _linearised(views: Views, mounting: Mounting) -> _Line:
    expected, seen = predicted(views, mounting), views.camera_from_target
    turned = rotation_vectors(np.swapaxes(expected.rotations, -1, -2) @ seen.rotations)
    moved = seen.positions - expected.positions
    camera_from_hand = mounting.eye.rotation.T
    of_turned = np.zeros((len(views), 3, UNKNOWNS))
    half = 0.5 * skew(turned)
    of_turned[:, :, :3] = (np.eye(3) + half) @ np.swapaxes(seen.rotations, -1, -2)
    of_turned[:, :, 6:9] = -(np.eye(3) - half)
    of_moved = np.zeros((len(views), 3, UNKNOWNS))
    of_moved[:, :, :3] = -skew(expected.positions)
    of_moved[:, :, 3:6] = camera_from_hand
    of_moved[:, :, 9:] = -camera_from_hand @ np.swapaxes(views.outer.rotations, -1, -2)
    return _Line(turned, moved, of_turned, of_moved)


def _step(rows: Array, residual: Array, weights: Array) -> Array:
    """One Gauss-Newton step (12,)."""
    square = np.einsum("n,nri,nrj->ij", weights, rows, rows)
    side = -np.einsum("n,nri,nr->i", weights, rows, residual)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(square), 1e-30))
    scaled = square * np.outer(scale, scale) + 1e-12 * np.eye(UNKNOWNS)
    return np.asarray(scale * np.linalg.solve(scaled, scale * side))


def _moved(mounting: Mounting, step: Array) -> Mounting:
    eye, target = mounting.eye, mounting.target
    turns = rotations_of(np.array([step[:3], step[6:9]]))
    return Mounting(
        Transform.from_rotation(eye.rotation @ turns[0], eye.position + step[3:6]),
        Transform.from_rotation(target.rotation @ turns[1], target.position + step[9:]),
    )


def _squares(turned: Array, moved: Array, noise: tuple[float, float]) -> Array:
    """Squared residuals (N,) in units of noise."""
    return np.asarray((turned**2).sum(axis=1) / noise[0] ** 2 + (moved**2).sum(1) / noise[1] ** 2)


def _median_noise(turned: Array, moved: Array) -> tuple[float, float]:
    """Noise per axis by the median: wrong even by wrong views, but never by much."""
    spread = max(1.0, len(turned) / max(1.0, len(turned) - UNKNOWNS / 6))
    rotation = np.sqrt(np.median((turned**2).sum(axis=1)) / _MEDIAN * spread)
    position = np.sqrt(np.median((moved**2).sum(axis=1)) / _MEDIAN * spread)
    return max(float(rotation), _LEAST_NOISE), max(float(position), _LEAST_NOISE)


def _noise(turned: Array, moved: Array, before: tuple[float, float]) -> tuple[float, float]:
    """Noise per axis by the views that are not outliers, as `before` tells them."""
    fine = _squares(turned, moved, before) <= _OUTLIER
    if 2 * fine.sum() <= len(fine):
        return _median_noise(turned, moved)
    freedom = 3.0 * fine.sum() - UNKNOWNS / 2
    rotation = np.sqrt((turned[fine] ** 2).sum() / freedom)
    position = np.sqrt((moved[fine] ** 2).sum() / freedom)
    return max(float(rotation), _LEAST_NOISE), max(float(position), _LEAST_NOISE)
