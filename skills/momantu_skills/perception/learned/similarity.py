"""The similarity (turn, scale, shift) between two sets of points, robust to wrong ones.

The closed form is that of Umeyama (1991); samples are drawn as in RANSAC, all at once.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

SAMPLES = 100
"""Samples that are tried; with half of the points wrong one in 16 is right."""
SAMPLE = 4
"""Points of a sample."""
TESTED = 120
"""About so many points of all tell which sample is best."""
ROUNDS = 3
"""Refinements with the points that fit."""


class Similarity(NamedTuple):
    """target = scale * rotation @ source + shift. fitting: (n,) bool: which points agree."""

    rotation: Array
    scale: float
    shift: Array
    fitting: NDArray[np.bool_]


def similarities(source: Array, target: Array) -> tuple[Array, Array, Array]:
    """The best rotations (k, 3, 3), scales (k,) and shifts (k, 3) of k sets of points (k, n, 3)."""
    middle, centre, covariance, spread = _moments(source, target)
    u, d, vt = np.linalg.svd(covariance)
    signs = np.ones((len(source), 3))
    signs[:, 2] = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    rotations = (u * signs[:, None]) @ vt
    scales = (d * signs).sum(axis=1) / np.maximum(spread, 1e-12)
    turned = (rotations @ middle[:, :, None])[:, :, 0]
    return rotations, scales, centre - scales[:, None] * turned


@numba.njit(cache=True)
def _moments(source: Array, target: Array) -> tuple[Array, Array, Array, Array]:
    """Of k sets (k, n, 3): both means (k, 3), covariances (k, 3, 3), variances of source (k,)."""
    sets, count = source.shape[0], source.shape[1]
    middle, centre = np.zeros((sets, 3)), np.zeros((sets, 3))
    covariance, spread = np.zeros((sets, 3, 3)), np.zeros(sets)
    for k in range(sets):
        for n in range(count):
            for c in range(3):
                middle[k, c] += source[k, n, c] / count
                centre[k, c] += target[k, n, c] / count
        for n in range(count):
            for c in range(3):
                a = source[k, n, c] - middle[k, c]
                spread[k] += a * a / count
                for r in range(3):
                    covariance[k, r, c] += (target[k, n, r] - centre[k, r]) * a / count
    return middle, centre, covariance, spread


@numba.njit(cache=True)
def _away(source: Array, target: Array, rotation: Array, scale: float, shift: Array) -> Array:
    """Distances (n,) between targets (n, 3) and where a similarity has their sources (n, 3)."""
    away = np.empty(len(source))
    for n in range(len(source)):
        square = 0.0
        for r in range(3):
            there = shift[r] - target[n, r]
            for c in range(3):
                there += scale * rotation[r, c] * source[n, c]
            square += there * there
        away[n] = math.sqrt(square)
    return away


@numba.njit(cache=True)
def _worth(
    source: Array, target: Array, rotations: Array, scales: Array, shifts: Array, tolerance: float
) -> Array:
    """How well k similarities fit points (n, 3): (k,); a point that fits exactly counts 1."""
    worth = np.zeros(len(scales))
    for k in range(len(scales)):
        for away in _away(source, target, rotations[k], scales[k], shifts[k]):
            worth[k] += max(0.0, 1.0 - away / tolerance)
    return worth


def fit(
    source: Array,
    target: Array,
    tolerance: float,
    scales: tuple[float, float],
    random: np.random.Generator,
) -> Similarity | None:
    """The similarity from source (n, 3) to target (n, 3) with the most agreeing points.

    tolerance: distance up to which a point agrees, in units of target. scales: range of valid
    scales. None if no sample has a valid scale, or too few points agree.
    """
    if len(source) < SAMPLE:
        return None
    drawn = random.integers(0, len(source), (SAMPLES, SAMPLE))
    source, target = np.ascontiguousarray(source), np.ascontiguousarray(target)
    rotations, sizes, shifts = similarities(source[drawn], target[drawn])
    valid = (sizes > scales[0]) & (sizes < scales[1])
    if not valid.any():
        return None
    rotations, sizes, shifts = rotations[valid], sizes[valid], shifts[valid]
    some = slice(None, None, max(1, len(source) // TESTED))
    tested, wanted = np.ascontiguousarray(source[some]), np.ascontiguousarray(target[some])
    worth = _worth(tested, wanted, rotations, sizes, shifts, tolerance)
    best = int(worth.argmax())
    rotation, size, shift = rotations[best], float(sizes[best]), shifts[best]
    fitting = _away(source, target, rotation, size, shift) < tolerance
    for _ in range(ROUNDS):
        if int(fitting.sum()) < SAMPLE:
            return None
        found = similarities(source[fitting][None], target[fitting][None])
        rotation, size, shift = found[0][0], float(found[1][0]), found[2][0]
        fitting = _away(source, target, rotation, size, shift) < tolerance
    return Similarity(rotation, size, shift, fitting)
