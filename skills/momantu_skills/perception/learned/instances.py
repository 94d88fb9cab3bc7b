"""Separate things among the cells of a crop, by the middles that the cells vote for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

VOXEL = 0.012
"""Edge of the voxels in which votes are counted, m."""
NEAR = 0.022
"""Distance from a middle within which votes shift it, m."""
REACH = 0.045
"""Distance from a middle up to which votes are for it, m."""
LEAST = 12
"""Fewest cells of a thing."""
SHIFTS = 4
"""Rounds of mean shift."""
MOST = 40
"""Most things in one crop."""


def instances(votes: Array) -> NDArray[np.int64]:
    """The thing (n,) that each vote (n, 3), m, is for, from 0; -1 of none.

    The densest place is taken first, then the densest among the votes that are left.
    """
    owner = np.full(len(votes), -1, dtype=np.int64)
    middles: list[Array] = []
    left = np.ones(len(votes), dtype=bool)
    while int(left.sum()) >= LEAST and len(middles) < MOST:
        middle = _densest(votes[left])
        for _ in range(SHIFTS):
            near = left & (np.linalg.norm(votes - middle, axis=1) < NEAR)
            if not near.any():
                break
            middle = votes[near].mean(axis=0)
        mine = left & (np.linalg.norm(votes - middle, axis=1) < NEAR)
        if int(mine.sum()) < LEAST:
            break
        middles.append(middle)
        left &= np.linalg.norm(votes - middle, axis=1) >= REACH
    if middles:
        away = np.linalg.norm(votes[:, None] - np.array(middles)[None], axis=2)
        nearest = away.argmin(axis=1)
        close = away[np.arange(len(votes)), nearest] < REACH
        owner[close] = nearest[close]
    return owner


def _densest(votes: Array) -> Array:
    """The middle of the voxel around which most votes lie."""
    cells = np.floor((votes - votes.min(axis=0)) / VOXEL).astype(np.int64) + 1
    shape = cells.max(axis=0) + 2
    flat = (cells[:, 0] * shape[1] + cells[:, 1]) * shape[2] + cells[:, 2]
    kinds, counts = np.unique(flat, return_counts=True)
    total = counts.astype(np.int64)
    for step in (1, shape[2], shape[1] * shape[2]):
        for way in (-step, step):
            at = np.minimum(np.searchsorted(kinds, kinds + way), len(kinds) - 1)
            total += np.where(kinds[at] == kinds + way, counts[at], 0)
    best = kinds[int(total.argmax())]
    return np.asarray(votes[flat == best].mean(axis=0))
