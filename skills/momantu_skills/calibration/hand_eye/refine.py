"""The joint refinement: the likeliest mounting, target and noise of the views that are right.

It starts where the robust least squares end. Steps of the mounting, weighed by each view's
covariance, and of the noise take turns; then views that are not right are told again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.hand_eye.linear import linearised, moved, step
from momantu_skills.calibration.hand_eye.noise import (
    Noise,
    first_variances,
    inverses,
    likelier,
    noise_of,
    shapes,
)
from momantu_skills.calibration.hand_eye.robust import OUTLIER, Robust
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import Mask

_ROUNDS = 4
_STEPS = 60
_SMALLEST = 1e-4
"""Of a step, in standard deviations of the mounting."""


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """The estimate.

    covariance: (12, 12) of small turns and shifts of the eye (about the camera's axes in rad,
    along the hand's or base's in m) and of the target. variances: (5,) of the noise's parts, see
    `shapes`. outliers: the views (N,) that the estimate calls wrong.
    """

    mounting: Mounting
    covariance: Array
    variances: Array
    noise: Noise
    outliers: Mask

    @property
    def rotation_deviations(self) -> Array:
        """Standard deviations (3,) of the eye's rotation about the camera's axes, rad."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[:3]))

    @property
    def position_deviations(self) -> Array:
        """Standard deviations (3,) of the eye's position, m."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[3:6]))


def refine(views: Views, start: Robust) -> Refined:
    """Refine both unknowns, and tell the noise.

    Raises:
        numpy.linalg.LinAlgError: the views do not determine the unknowns.
    """
    mounting, right = start.mounting, start.right
    variances = usual = first_variances(start.noise)
    for _ in range(_ROUNDS):
        mounting, variances = _likeliest(views[right], mounting, variances, usual)
        inverse = inverses(variances, shapes(views, mounting))
        line = linearised(views, mounting)
        squares = np.einsum("ni,nij,nj->n", line.residuals, inverse, line.residuals)
        before, right = right, squares <= OUTLIER
        if 2 * right.sum() <= len(right):
            right = before
        if (right == before).all():
            break
    square = _normal(line.rows[right], inverse[right], line.residuals[right])[0]
    return Refined(
        mounting,
        np.asarray(np.linalg.inv(square), dtype=np.float64),
        variances,
        noise_of(variances, shapes(views[right], mounting)),
        ~right,
    )


def scale_of_target(views: Views, refined: Refined) -> tuple[float, float]:
    """By what factor the target's positions are too small, and its standard deviation.

    It is not 1 where the size of the target's squares or tags is wrong.
    """
    right = views[~refined.outliers]
    line = linearised(right, refined.mounting)
    scaled = np.zeros((len(right), 6, 1))
    scaled[:, 3:, 0] = right.camera_from_target.positions
    rows = np.concatenate([line.rows, scaled], axis=2)
    inverse = inverses(refined.variances, shapes(right, refined.mounting))
    square, side = _normal(rows, inverse, line.residuals)
    covariance = np.linalg.pinv(square)
    return 1.0 + float(covariance[-1] @ side), float(np.sqrt(covariance[-1, -1]))


def _likeliest(
    views: Views, mounting: Mounting, variances: Array, usual: Array
) -> tuple[Mounting, Array]:
    for _ in range(_STEPS):
        line, forms = linearised(views, mounting), shapes(views, mounting)
        variances = likelier(variances, usual, line, forms)
        square, side = _normal(line.rows, inverses(variances, forms), line.residuals)
        change = step(square, side)
        mounting = moved(mounting, change)
        if change @ square @ change < _SMALLEST**2:
            break
    return mounting, variances


def _normal(rows: Array, inverse: Array, residuals: Array) -> tuple[Array, Array]:
    """The normal equations of rows (N, 6, U): matrix (U, U) and side (U,)."""
    weighed = np.swapaxes(rows, -1, -2) @ inverse
    return (weighed @ rows).sum(axis=0), -np.einsum("nij,nj->i", weighed, residuals)
