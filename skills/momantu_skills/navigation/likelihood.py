"""How well poses explain a scan: a likelihood field, looked up where the beams end."""

from __future__ import annotations

import math

import numba
import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.navigation.fields import Field, sample


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
    """Sum over beams of the log of their likelihood, for each pose.

    poses: (n, 3) x, y, yaw in the map. points: (k, 2) beam ends in the base frame, m.
    field: likelihood of a beam's end; `outside` holds off the grid.
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
