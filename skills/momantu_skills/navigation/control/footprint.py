"""Approximate the footprint by a few discs, so that one look-up per disc gives its clearance."""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array

SLACK = 0.015
"""How far a disc may extend beyond the outline, m; without it corners would need endless discs."""
SPACING = 0.02
"""Distance between the sample points inside the outline that must be covered, m."""
ROUNDING = 1e-9
"""Far more than the rounding error of a squared distance, m2."""
MOST = 12
"""Largest number of discs: enough for a rectangular base, or a round one with an outstretched
arm."""


def discs(outline: Array) -> Array:
    """Cover a convex outline (k, 2), counter-clockwise, m, with discs (m, 3) of x, y, radius.

    The algorithm is greedy: each step takes the disc that covers most points that are not covered
    yet, so the first disc is that of the base.

    Raises:
        ValueError: the outline has no inside.
    """
    points, depth = _inside(np.asarray(outline, dtype=np.float64))
    covers = _covers(points, depth + SLACK)
    bare = np.ones(len(points), dtype=bool)
    counts = np.count_nonzero(covers, axis=1)
    chosen: list[Array] = []
    while bare.any() and len(chosen) < MOST:
        best = int(np.argmax(counts))
        chosen.append(np.array([*points[best], depth[best] + SLACK]))
        fresh = bare & covers[best]
        counts -= np.count_nonzero(covers[:, fresh], axis=1)
        bare &= ~fresh
    return np.array(chosen)


@numba.njit(cache=True)
def _covers(points: Array, radii: Array) -> NDArray[np.bool_]:
    """Which discs around points (n, 2) with radii (n,) hold which of the points: (n, n).

    The exact distance is only computed where its square does not tell.
    """
    n = len(points)
    covers = np.empty((n, n), dtype=np.bool_)
    for i in range(n):
        square = radii[i] * radii[i]
        for j in range(n):
            x = points[i, 0] - points[j, 0]
            y = points[i, 1] - points[j, 1]
            excess = x * x + y * y - square
            covers[i, j] = excess < 0.0
            if abs(excess) < ROUNDING:
                covers[i, j] = math.hypot(x, y) <= radii[i]
    return covers


def half_width(outline: Array) -> float:
    """Return the largest extent to the left or right, m: the clearance needed to drive straight."""
    return float(np.abs(np.asarray(outline)[:, 1]).max())


def _inside(outline: Array) -> tuple[Array, Array]:
    """Return points (n, 2) inside a convex outline, and their distances (n,) to its sides."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    x, y = (np.arange(a, b + SPACING, SPACING) for a, b in zip(low, high, strict=True))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    sides = np.roll(outline, -1, axis=0) - outline
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    kept = lengths > 1e-9
    normals = np.stack([-sides[kept, 1], sides[kept, 0]], axis=1) / lengths[kept, None]
    depth = ((points[:, None, :] - outline[kept][None]) * normals[None]).sum(axis=2).min(axis=1)
    if not (depth > 0.0).any():
        raise ValueError(
            f"the footprint {outline.tolist()} has no inside; is it counter-clockwise?"
        )
    return points[depth > 0.0], depth[depth > 0.0]
