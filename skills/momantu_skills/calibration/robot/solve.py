"""Robust least squares: what explains the views best, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.calibration.robot.model import Model, State

_ROUNDS = 40
_SETTLED = 1e-6
"""Relative gain in cost below which the estimation ends."""
_SOFT = 3.0
"""Cauchy's loss bends at this many times the usual error of a sighting."""
_FAR, _FAR_PIXELS = 6.0, 1.0
"""An outlier is off by more than this many times the median, and by this many pixels."""
_LEAST_PIXELS = 0.05
"""Corners are never better than this, px."""
_SPREAD = 1e-4
"""Weight of keeping tags and stands where they are, so that every system can be solved."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """state: the estimate. covariance: (P, P) of `told`, what is usual included.

    information: (P, P), what the views alone tell. errors: (N,) px, root mean square of each
    sighting. used: (N,). pixel: standard deviation of a corner's coordinate, px.
    """

    state: State
    covariance: Array
    information: Array
    errors: Array
    used: NDArray[np.bool_]
    pixel: float


def solve(model: Model, state: State, free: NDArray[np.bool_]) -> Solution:
    """Estimate. free: (P,), which parameters may change; tags and stands always may."""
    used = np.ones(len(model.views), dtype=bool)
    for _ in range(4):
        state = _descend(model, state, free, used)
        errors = _errors(model, state)
        far = max(_FAR_PIXELS, _FAR * float(np.median(errors)))
        now = errors <= far
        if (now == used).all():
            break
        used = now
    return _judged(model, state, free, used)


def _errors(model: Model, state: State) -> Array:
    return np.asarray(np.sqrt((model.pixels(state) ** 2).sum(2).mean(1) / 2))


def _descend(model: Model, state: State, free: NDArray[np.bool_], used: NDArray[np.bool_]) -> State:
    """Levenberg and Marquardt's method, with weights that fall for sightings far off."""
    damping = 1e-3
    for _ in range(_ROUNDS):
        weights, scale = _weights(_errors(model, state), used)
        matrix, gradient, cost = _system(model, state, weights, scale)
        fixed = np.flatnonzero(~free)
        matrix[fixed], matrix[:, fixed], gradient[fixed] = 0.0, 0.0, 0.0
        matrix[fixed, fixed] = 1.0
        gained = 0.0
        while damping < 1e8:
            damped = matrix + damping * np.diag(np.diag(matrix))
            moved = state.moved(np.asarray(-np.linalg.solve(damped, gradient), dtype=np.float64))
            after = _cost(model, moved, weights, scale)
            if after < cost:
                gained, state, damping = cost - after, moved, max(1e-9, damping / 10)
                break
            damping *= 10
        if gained <= _SETTLED * cost:
            break
    return state


def _weights(errors: Array, used: NDArray[np.bool_]) -> tuple[Array, float]:
    """Cauchy's weights (N,), and the usual error, px."""
    scale = max(_LEAST_PIXELS, float(np.median(errors[used])))
    return np.where(used, 1.0 / (1.0 + (errors / (_SOFT * scale)) ** 2), 0.0), scale


def _robust(off: Array) -> Array:
    """Cauchy's weights of odometry's residuals, in their standard deviations."""
    return 1.0 / (1.0 + (off / _SOFT) ** 2)


def _system(model: Model, state: State, weights: Array, scale: float) -> tuple[Array, Array, float]:
    """Normal matrix, gradient and cost, with what is usual."""
    off, slopes = model.linearised(state)
    each = np.repeat(weights, 8) / scale**2
    way, turns = model.driven(state)
    soft = _robust(way)
    usual = np.full(slopes.shape[1], _SPREAD)
    count = len(state.told)
    usual[:count] = model.parameters.usual**-2.0
    matrix = (slopes.T * each) @ slopes + (turns.T * soft) @ turns + np.diag(usual)
    gradient = slopes.T @ (each * off) + turns.T @ (soft * way)
    gradient[:count] += usual[:count] * state.told
    cost = _value(off, way, each, state, model)
    return matrix, gradient, cost


def _cost(model: Model, state: State, weights: Array, scale: float) -> float:
    each = np.repeat(weights, 8) / scale**2
    return _value(model.pixels(state).ravel(), model.driven(state)[0], each, state, model)


def _value(off: Array, way: Array, each: Array, state: State, model: Model) -> float:
    usual = (state.told / model.parameters.usual) ** 2
    driven = _SOFT**2 * np.log1p((way / _SOFT) ** 2)
    return float(each @ off**2 + driven.sum() + usual.sum())


def _judged(
    model: Model, state: State, free: NDArray[np.bool_], used: NDArray[np.bool_]
) -> Solution:
    """The solution with its spread."""
    errors = _errors(model, state)
    off, slopes = model.linearised(state)
    counted = np.repeat(used, 8)
    unknown = int(free.sum()) + slopes.shape[1] - len(free)
    spare = max(1, int(counted.sum()) - unknown)
    pixel = max(_LEAST_PIXELS, float(np.sqrt((off[counted] ** 2).sum() / spare)))
    way, turns = model.driven(state)
    told = (slopes[counted].T @ slopes[counted]) / pixel**2 + (turns.T * _robust(way)) @ turns
    count = len(state.told)
    rest = told[count:, count:] + _SPREAD * np.eye(len(told) - count)
    across = told[:count, count:]
    information = told[:count, :count] - across @ np.linalg.solve(rest, across.T)
    information = 0.5 * (information + information.T)
    information[~free], information[:, ~free] = 0.0, 0.0
    usual = np.diag(model.parameters.usual**-2.0)
    covariance = np.asarray(np.linalg.inv(information + usual), dtype=np.float64)
    return Solution(state, covariance, information, errors, used, pixel)
