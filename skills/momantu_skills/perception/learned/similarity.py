"""The similarity (turn, scale, shift) between two sets of points, robust to wrong ones.

The closed form is that of Umeyama (1991); samples are drawn as in RANSAC, all at once.
"""

from __future__ import annotations

from typing import NamedTuple

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
    middle, centre = source.mean(axis=1, keepdims=True), target.mean(axis=1, keepdims=True)
    a, b = source - middle, target - centre
    covariance = np.einsum("kni,knj->kij", b, a) / source.shape[1]
    u, d, vt = np.linalg.svd(covariance)
    signs = np.ones((len(source), 3))
    signs[:, 2] = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    rotations = np.einsum("kij,kj,kjl->kil", u, signs, vt)
    spread = np.maximum((a**2).sum(axis=2).mean(axis=1), 1e-12)
    scales = (d * signs).sum(axis=1) / spread
    turned = np.einsum("kij,kj->ki", rotations, middle[:, 0])
    return rotations, scales, centre[:, 0] - scales[:, None] * turned


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
    rotations, sizes, shifts = similarities(source[drawn], target[drawn])
    valid = (sizes > scales[0]) & (sizes < scales[1])
    if not valid.any():
        return None
    rotations, sizes, shifts = rotations[valid], sizes[valid], shifts[valid]
    some = slice(None, None, max(1, len(source) // TESTED))
    turned = source[some] @ rotations.transpose(0, 2, 1)
    away = np.linalg.norm(sizes[:, None, None] * turned + shifts[:, None] - target[some], axis=2)
    worth = np.clip(1.0 - away / tolerance, 0.0, None).sum(axis=1)
    best = int(worth.argmax())
    rotation, size, shift = rotations[best], float(sizes[best]), shifts[best]
    fitting = np.linalg.norm(size * source @ rotation.T + shift - target, axis=1) < tolerance
    for _ in range(ROUNDS):
        if int(fitting.sum()) < SAMPLE:
            return None
        found = similarities(source[fitting][None], target[fitting][None])
        rotation, size, shift = found[0][0], float(found[1][0]), found[2][0]
        off = np.linalg.norm(size * source @ rotation.T + shift - target, axis=1)
        fitting = off < tolerance
    return Similarity(rotation, size, shift, fitting)
