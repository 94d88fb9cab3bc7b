"""Where the noise of the views acts, and how large it is: a covariance for each view's residual.

A small turn at the hand, such as a joint's, moves the target by the turn times the distance from
the hand. A turn of the target as the camera sees it moves nothing. So rotation and position of a
residual tell together about which point the noise turns, and weighing them by that covariance
gives the mounting two to three times as exactly as if they were independent.

Residuals are sums of independent parts: a shift, and turns about the frames of the target, the
camera, the eye's carrier and the target's holder. Their variances are those of largest likelihood,
by Zhou, Hu, Qiao and Zhou, MM Algorithms for Variance Components Models, 2019.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.hand_eye.linear import Line
from momantu_skills.calibration.hand_eye.robust import LEAST_NOISE
from momantu_skills.calibration.hand_eye.views import Mounting, Views, predicted
from momantu_skills.calibration.poses import Poses, skew

PLACES = ("target", "camera", "carrier", "holder")
"""About which frames noise turns; carrier and holder as `Settings` names them."""
_STEPS = 3
"""Of the variances, for each step of the mounting."""
_BELIEF = 0.1
"""How many residuals of the usual size, at each place, count beside those that were measured."""


@dataclass(frozen=True, slots=True, eq=False)
class Noise:
    """The noise per axis of residuals: rotation, rad, and position at the target, m.

    shares: of the rotation's variance that acts at each of `PLACES`, (4,); they sum to 1.
    """

    rotation: float
    position: float
    shares: Array


def shapes(views: Views, mounting: Mounting) -> Array:
    """Covariances (5, N, 6, 6) of residuals by a shift of 1 m, and turns of 1 rad at `PLACES`."""
    expected = predicted(views, mounting)
    seen, eye = expected.positions, mounting.eye.inverse()
    holder = (Poses.of([eye]) @ views.outer.inverse()).positions
    levers = (np.zeros_like(seen), seen, seen - eye.position, seen - holder)
    target_from_camera = np.swapaxes(expected.rotations, -1, -2)
    found = np.zeros((1 + len(levers), len(views), 6, 6))
    found[0, :, 3:, 3:] = np.eye(3)
    for place, lever in enumerate(levers, 1):
        acts = np.concatenate([target_from_camera, -skew(lever)], axis=1)
        found[place] = acts @ np.swapaxes(acts, -1, -2)
    return found


def first_variances(noise: tuple[float, float]) -> Array:
    """Where the likelihood's ascent begins: (5,), each place with a part of the usual noise."""
    rotation, position = noise
    return np.array([position**2 / 2.0, *[rotation**2 / len(PLACES)] * len(PLACES)])


def likelier(variances: Array, usual: Array, line: Line, forms: Array) -> Array:
    """Variances (5,) that are likelier than those before, given residuals and their shapes.

    The likelihood is that of residuals after a fit (REML), so that few views do not seem to be
    without noise. usual: (5,), variances that count as much as `_BELIEF` residuals.
    """
    for _ in range(_STEPS):
        inverse = inverses(variances, forms)
        weighed = np.einsum("nij,nj->ni", inverse, line.residuals)
        told = np.einsum("ni,knij,nj->k", weighed, forms, weighed, optimize=True)
        rows = inverse @ line.rows
        square = np.einsum("nri,nrj->ij", line.rows, rows)
        hat = rows @ np.linalg.pinv(square, hermitian=True) @ np.swapaxes(rows, -1, -2)
        expected = np.einsum("nij,knji->k", inverse - hat, forms)
        told += _BELIEF * usual / variances**2
        expected += _BELIEF / variances
        variances = variances * np.sqrt(told / expected)
    return variances


def inverses(variances: Array, forms: Array) -> Array:
    """The inverse covariance (N, 6, 6) of each view's residual."""
    least = np.maximum(variances, [LEAST_NOISE**2, LEAST_NOISE**2, 0.0, 0.0, 0.0])
    return np.asarray(np.linalg.inv(np.tensordot(least, forms, axes=1)))


def noise_of(variances: Array, forms: Array) -> Noise:
    """What variances (5,) mean for a usual view."""
    usual = np.trace(np.tensordot(variances, forms, axes=1)[:, 3:, 3:], axis1=1, axis2=2) / 3.0
    turned = float(variances[1:].sum())
    shares = variances[1:] / turned if turned > 0.0 else np.array([1.0, 0.0, 0.0, 0.0])
    rotation, position = np.sqrt(turned), np.sqrt(np.median(usual))
    return Noise(max(float(rotation), LEAST_NOISE), max(float(position), LEAST_NOISE), shares)
