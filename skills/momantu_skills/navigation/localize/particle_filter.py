"""The particle filter's compiled steps: weigh poses by a likelihood field, resample (KLD)."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.navigation.map.fields import Field, sample

_SLOTS = 1 << 16
"""Slots of the hash table of occupied bins: three times the most particles, a power of two."""


def likelihood_field(distance: Field, sigma: float, random_share: float) -> Field:
    """Likelihood of a beam that ends at each cell, from the distance to the nearest surface, m."""
    hit = np.exp(-0.5 * np.square(distance / np.float32(sigma)))
    return np.asarray((1.0 - random_share) * hit + random_share, dtype=np.float32)


@numba.njit(cache=True)
def log_likelihoods(
    poses: Array,
    points: Array,
    field: Field,
    origin_x: float,
    origin_y: float,
    resolution: float,
    outside: float,
) -> Array:
    """For each pose, the sum over beams of the log of their likelihood.

    poses: (n, 3) x, y, yaw in the map. points: (k, 2) beam ends in the base frame, m. field:
    likelihood of a beam's end; `outside` is the value off the grid.
    """
    n = poses.shape[0]
    k = points.shape[0]
    total = np.empty(n)
    for i in range(n):
        c = math.cos(poses[i, 2]) / resolution
        s = math.sin(poses[i, 2]) / resolution
        x = (poses[i, 0] - origin_x) / resolution - 0.5
        y = (poses[i, 1] - origin_y) / resolution - 0.5
        product = 1.0
        log = 0.0
        for j in range(k):
            px = points[j, 0]
            py = points[j, 1]
            product *= sample(field, x + c * px - s * py, y + s * px + c * py, outside)
            if product < 1e-100:
                log += math.log(product)
                product = 1.0
        total[i] = log + math.log(product)
    return total


@numba.njit(cache=True)
def kld_resample(
    poses: Array,
    weights: Array,
    uniforms: Array,
    fewest: int,
    bin_position: float,
    bin_yaw: float,
    error: float,
    quantile: float,
) -> NDArray[np.int64]:
    """Resample: indices of particles drawn by weight, as many as the KL divergence bound needs.

    poses: (n, 3). weights: (n,) summing to 1. uniforms: (m,) in [0, 1); at most m indices are
    drawn. Stops at `fewest` or at the bound of KLD sampling for the bins occupied so far, whichever
    is more.
    """
    cumulative = np.cumsum(weights)
    table = np.full(_SLOTS, -1, dtype=np.int64)
    most = uniforms.shape[0]
    chosen = np.empty(most, dtype=np.int64)
    bins = 0
    needed = fewest
    count = 0
    while count < most and count < needed:
        i = np.searchsorted(cumulative, uniforms[count] * cumulative[-1], side="right")
        i = min(i, poses.shape[0] - 1)
        chosen[count] = i
        count += 1
        a = math.floor(poses[i, 0] / bin_position) + 100_000
        b = math.floor(poses[i, 1] / bin_position) + 100_000
        turned = poses[i, 2] - 2.0 * math.pi * math.floor(poses[i, 2] / (2.0 * math.pi))
        key = (a * 200_003 + b) * 1_009 + math.floor(turned / bin_yaw)
        slot = (key * 2_654_435_761) & (_SLOTS - 1)
        while table[slot] != -1 and table[slot] != key:
            slot = (slot + 1) & (_SLOTS - 1)
        if table[slot] == -1:
            table[slot] = key
            bins += 1
            if bins > 1:
                part = 2.0 / (9.0 * (bins - 1))
                bound = 1.0 - part + math.sqrt(part) * quantile
                needed = max(fewest, math.ceil((bins - 1) / (2.0 * error) * bound**3))
    return chosen[:count]
