"""Approximate the footprint by a few discs, so that one look-up per disc gives its clearance."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array

SLACK = 0.015
"""How far a disc may extend beyond the outline, m; without it corners would need endless discs."""
SPACING = 0.02
"""Distance between the sample points inside the outline that must be covered, m."""
MOST = 12
"""Largest number of discs: enough for a rectangular base, or a round one with an outstretched
arm."""


def discs(outline: Array) -> Array:
    """Cover a convex outline (k, 2), counter-clockwise, m, with discs (m, 3) of x, y, radius.

    The algorithm is greedy: each step takes the disc that covers most points that are not covered
    yet, so the first disc is that of the base.

    Greedy: the disc that covers most of what is still bare comes next, so the first is the base.

    Raises:
        ValueError: the outline has no inside.
    """
    points, depth = _inside(np.asarray(outline, dtype=np.float64))
    apart = np.hypot(*(points[:, None, :] - points[None, :, :]).transpose(2, 0, 1))
    covers = apart <= depth[:, None] + SLACK
    bare = np.ones(len(points), dtype=bool)
    chosen: list[Array] = []
    while bare.any() and len(chosen) < MOST:
        best = int(np.argmax(covers @ bare.astype(np.float64)))
        chosen.append(np.array([*points[best], depth[best] + SLACK]))
        bare &= ~covers[best]
    return np.array(chosen)


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
