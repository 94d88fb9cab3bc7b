"""The estimate from a weighted set of planar poses: mean of the main cluster, full covariance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D

CLUSTER_RADIUS = 0.4
"""Particles within this distance (m, and rad) of the heaviest cell belong to the same
hypothesis."""


def mean_pose(poses: Array, weights: Array) -> Pose2D:
    """Weighted mean of poses (n, 3) with weights (n,); headings are averaged on the circle."""
    share = weights / weights.sum()
    sine, cosine = share @ np.sin(poses[:, 2]), share @ np.cos(poses[:, 2])
    return Pose2D(
        float(share @ poses[:, 0]),
        float(share @ poses[:, 1]),
        math.atan2(float(sine), float(cosine)),
    )


def differences(poses: Array, center: Pose2D) -> Array:
    """(n, 3) poses minus `center`, headings in (-pi, pi]."""
    delta = poses - np.array([center.x, center.y, center.yaw])
    delta[:, 2] = np.arctan2(np.sin(delta[:, 2]), np.cos(delta[:, 2]))
    return np.asarray(delta)


def main_cluster(poses: Array, weights: Array, guess: Pose2D) -> Pose2D:
    """Mean of the heaviest cluster; stays with `guess` while most of the weight is around it.

    Three mean-shift steps, from the guess or from the heaviest cell of a coarse grid.
    """
    if weights[_near(poses, guess)].sum() < 0.5 * weights.sum():
        guess = _heaviest(poses, weights)
    for _ in range(3):
        inside = _near(poses, guess)
        if not inside.any():
            return guess
        guess = mean_pose(poses[inside], weights[inside])
    return guess


def covariance(poses: Array, weights: Array, center: Pose2D) -> Array:
    """(3, 3) covariance of all particles about `center`, so other hypotheses enlarge it."""
    delta = differences(poses, center)
    share = weights / weights.sum()
    return np.asarray((delta * share[:, None]).T @ delta)


def _near(poses: Array, center: Pose2D) -> NDArray[np.bool_]:
    delta = np.abs(differences(poses, center))
    return np.asarray(
        (np.hypot(delta[:, 0], delta[:, 1]) < CLUSTER_RADIUS) & (delta[:, 2] < CLUSTER_RADIUS)
    )


def _heaviest(poses: Array, weights: Array) -> Pose2D:
    cells = np.floor(poses / CLUSTER_RADIUS).astype(np.int64)
    cells[:, 2] = np.floor((poses[:, 2] % (2 * math.pi)) / CLUSTER_RADIUS)
    cells -= cells.min(axis=0)
    label = np.ravel_multi_index(cells.T, cells.max(axis=0) + 1)
    best = int(np.argmax(np.bincount(label, weights=weights)))
    return mean_pose(poses[label == best], weights[label == best])
