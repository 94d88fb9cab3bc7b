"""Fit upright bodies of revolution to points on a part of their side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

SLICE = 0.01
"""Height of the slices that each have one radius, m."""
ROUNDS = 12
"""Gauss-Newton steps; five suffice from the algebraic solution."""
OUTLIER = 0.005
"""Residual at which the weight of a point is down to a quarter, m (Geman-McClure)."""
DAMPING = 1e-6
"""Added to the normal matrix, m2 per point, so that a flat patch does not cause a huge step."""


@dataclass(frozen=True, slots=True, eq=False)
class Revolution:
    """centre: (2,) of the axis, m. radii: (k,) of the slices, m, NaN for an empty slice.

    heights: (k,) middles of the slices above the support, m. residuals: (n,) of the points, m.
    radius: median over all points, m. radius_sigma: its uncertainty, m.
    """

    centre: Array
    radii: Array
    heights: Array
    residuals: Array
    radius: float
    radius_sigma: float

    @property
    def misfit(self) -> float:
        """Median absolute residual, m."""
        return float(np.median(np.abs(self.residuals)))


def fit_revolution(points: Array, radius: float | None = None) -> Revolution | None:
    """Fit a vertical axis and radii to points (n, 3); heights are above the support.

    One centre, one radius per slice of SLICE: an algebraic fit (x2 + y2 = 2ax + 2by + c per slice),
    then robust Gauss-Newton on the distances. If `radius` is given, all slices have that one. None
    if the points are too flat to have a centre within 1 m.
    """
    if len(points) < 12:
        return None
    slices = np.floor(points[:, 2] / SLICE).astype(np.int64)
    slices -= slices.min()
    flat, origin = points[:, :2], points[:, :2].mean(axis=0)
    centre = _algebraic(flat - origin, slices)
    if centre is None:
        return None
    centre = centre + origin
    if radius is not None:
        centre = _pushed_to(flat, centre, radius)
    sigma = np.inf
    for _ in range(ROUNDS):
        step, sigma = _step(flat, slices, centre, radius)
        centre = centre + step
        if float(np.abs(step).max()) < 1e-6:
            break
    return _result(points, slices, centre, radius, sigma)


def _algebraic(flat: Array, slices: NDArray[np.int64]) -> Array | None:
    squares = (flat**2).sum(axis=1)
    a = 2 * (flat - _slice_means(flat, slices))
    b = squares - _slice_means(squares[:, None], slices)[:, 0]
    normal = a.T @ a + DAMPING * len(flat) * np.eye(2)
    centre = np.linalg.solve(normal, a.T @ b)
    return centre if float(np.abs(centre).max()) < 1.0 else None


def _pushed_to(flat: Array, centre: Array, radius: float) -> Array:
    """The start for a given radius: behind the visible side, at that distance from it."""
    middle = np.median(flat, axis=0)
    away = centre - middle
    distance = float(np.hypot(*away))
    return np.asarray(middle + away * (radius / max(distance, 1e-9)) * 0.8)


def _step(
    flat: Array, slices: NDArray[np.int64], centre: Array, radius: float | None
) -> tuple[Array, float]:
    offsets = flat - centre
    distances = np.maximum(np.hypot(offsets[:, 0], offsets[:, 1]), 1e-6)
    outward = offsets / distances[:, None]
    if radius is None:
        medians = _slice_medians(distances, slices)
        weights = _weights(distances - medians)
        means = _slice_means(distances[:, None], slices, weights)[:, 0]
        residuals = distances - means
        slopes = -(outward - _slice_means(outward, slices, weights))
    else:
        residuals, slopes = distances - radius, -outward
        weights = _weights(residuals)
    weighted = slopes * weights[:, None]
    normal = weighted.T @ slopes + DAMPING * len(flat) * np.eye(2)
    step = -np.linalg.solve(normal, weighted.T @ residuals)
    length = float(np.hypot(*step))
    step *= min(1.0, 0.02 / max(length, 1e-12))
    noise = float(weights @ residuals**2) / max(float(weights.sum()), 1.0)
    worst = noise / max(float(np.linalg.eigvalsh(normal)[0]), 1e-12)
    return np.asarray(step), float(np.sqrt(worst))


def _weights(residuals: Array) -> Array:
    return np.asarray(1.0 / (1.0 + (residuals / OUTLIER) ** 2) ** 2)


def _slice_means(values: Array, slices: NDArray[np.int64], weights: Array | None = None) -> Array:
    """(n, d) for each point the (weighted) mean of its slice."""
    weights = np.ones(len(values)) if weights is None else weights
    total = np.maximum(np.bincount(slices, weights), 1e-12)
    columns = [
        (np.bincount(slices, weights * values[:, c]) / total)[slices]
        for c in range(values.shape[1])
    ]
    return np.column_stack(columns)


def _slice_medians(values: Array, slices: NDArray[np.int64]) -> Array:
    """(n,) for each point the median of its slice."""
    order = np.lexsort((values, slices))
    counts = np.bincount(slices)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    middles = values[order[np.minimum(starts + counts // 2, len(values) - 1)]]
    return np.asarray(middles[slices])


def _result(
    points: Array, slices: NDArray[np.int64], centre: Array, radius: float | None, sigma: float
) -> Revolution:
    offsets = points[:, :2] - centre
    distances = np.hypot(offsets[:, 0], offsets[:, 1])
    medians = _slice_medians(distances, slices)
    weights = _weights(distances - (medians if radius is None else radius))
    means = _slice_means(distances[:, None], slices, weights)[:, 0]
    count = int(slices.max()) + 1
    radii = np.full(count, np.nan)
    radii[slices] = means
    lowest = np.floor(points[:, 2].min() / SLICE) * SLICE
    return Revolution(
        centre,
        radii,
        lowest + SLICE * (np.arange(count) + 0.5),
        distances - (means if radius is None else radius),
        float(np.median(means)) if radius is None else radius,
        sigma,
    )
