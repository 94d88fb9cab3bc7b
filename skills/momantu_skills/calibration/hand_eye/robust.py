"""Least squares that wrong views do not spoil: which views are right, and roughly the mounting.

Rotation and position of a view count in units of their own noise, which is estimated from the
residuals. Gauss-Newton steps with Tukey's biweight for a whole view: one far off has no influence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from momantu_bt.geometry import Array
from momantu_skills.calibration.hand_eye.linear import UNKNOWNS, linearised, moved, step
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import Mask

OUTLIER = float(chi2.ppf(0.9999, 6))
"""Squared residual in units of noise; one good view of 10,000 lies beyond."""
LEAST_NOISE = 1e-6
"""rad and m: no instrument is better, and rounding in files is no reason to call a view wrong."""
_CUT = 40.0
"""Squared residual in units of noise from which on a view has no weight."""
_MEDIAN = float(chi2.ppf(0.5, 3))
_STEPS = 60
_SMALLEST_STEP = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Robust:
    """The estimate. noise: of rotation, rad, and position, m, per axis. right: the views (N,)."""

    mounting: Mounting
    noise: tuple[float, float]
    right: Mask


def robust(views: Views, mounting: Mounting) -> Robust:
    """Improve both unknowns from a start that is roughly right.

    Raises:
        numpy.linalg.LinAlgError: the views do not determine the unknowns.
    """
    line = linearised(views, mounting)
    noise = _median_noise(line.residuals)
    for _ in range(_STEPS):
        inside = np.clip(1.0 - _squares(line.residuals, noise) / _CUT, 0.0, None)
        scaled = inside[:, None] ** 2 / np.repeat(noise, 3) ** 2  # weights (N, 6)
        square = np.einsum("nr,nri,nrj->ij", scaled, line.rows, line.rows)
        change = step(square, -np.einsum("nr,nri,nr->i", scaled, line.rows, line.residuals))
        mounting = moved(mounting, change)
        line = linearised(views, mounting)
        noise = _noise(line.residuals, noise)
        if np.linalg.norm(change) < _SMALLEST_STEP:
            break
    return Robust(mounting, noise, _squares(line.residuals, noise) <= OUTLIER)


def _squares(residuals: Array, noise: tuple[float, float]) -> Array:
    """Squared residuals (N,) in units of noise."""
    return np.asarray(((residuals / np.repeat(noise, 3)) ** 2).sum(axis=1))


def _median_noise(residuals: Array) -> tuple[float, float]:
    """Noise per axis by the median: wrong even by wrong views, but never by much."""
    spread = max(1.0, len(residuals) / max(1.0, len(residuals) - UNKNOWNS / 6))
    turned, away = ((residuals**2).reshape(-1, 2, 3)).sum(axis=2).T
    rotation = np.sqrt(np.median(turned) / _MEDIAN * spread)
    position = np.sqrt(np.median(away) / _MEDIAN * spread)
    return max(float(rotation), LEAST_NOISE), max(float(position), LEAST_NOISE)


def _noise(residuals: Array, before: tuple[float, float]) -> tuple[float, float]:
    """Noise per axis by the views that are right, as `before` tells them."""
    right = _squares(residuals, before) <= OUTLIER
    if 2 * right.sum() <= len(right):
        return _median_noise(residuals)
    freedom = 3.0 * right.sum() - UNKNOWNS / 2
    rotation = np.sqrt((residuals[right, :3] ** 2).sum() / freedom)
    position = np.sqrt((residuals[right, 3:] ** 2).sum() / freedom)
    return max(float(rotation), LEAST_NOISE), max(float(position), LEAST_NOISE)
