"""Where rays meet convex hulls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array

PAD_ALONG = 0.2
"""Share of the pads' length, to each side of their middle, that is looked at: fingers that turn are
nearer to each other at one end."""
PARALLEL = 1e-12
"""A ray whose direction has less of a plane's normal runs along it."""


def planes_of(corners: Array) -> Array:
    """(k, 4): outward unit normals and offsets of the hull of corners (n, 3)."""
    return np.asarray(ConvexHull(corners).equations)


def crossings(planes: Array, origins: Array, directions: Array) -> tuple[Array, Array]:
    """Where rays (n, 3) enter and leave a convex solid, in lengths of their directions, (n,).

    Both are infinite where a ray passes by. What lies behind the origin is negative.
    """
    slope = directions @ planes[:, :3].T
    height = origins @ planes[:, :3].T + planes[:, 3]
    level = np.abs(slope) < PARALLEL
    at = -height / np.where(level, 1.0, slope)
    enter = np.where(level | (slope > 0), -np.inf, at).max(axis=1)
    leave = np.where(level | (slope < 0), np.inf, at).min(axis=1)
    missed = (enter > leave) | (level & (height > 0)).any(axis=1)
    return np.where(missed, np.inf, enter), np.where(missed, np.inf, leave)


def opening_between(fingers: Sequence[Array], pad_length: float, pad_height: float) -> float | None:
    """Distance between fingers along y, beside the origin of the grasp frame, m.

    fingers: corners (n, 3) of each one's hull in that frame. None where there is no finger to one
    of the sides.
    """
    x, z = np.meshgrid(
        np.linspace(-PAD_ALONG, PAD_ALONG, 3) * pad_length,
        np.linspace(-0.5, 0.5, 7) * pad_height,
    )
    starts = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    solids = [planes_of(corners) for corners in fingers]
    ends = []
    for side in (1.0, -1.0):
        spans = [crossings(s, starts, np.tile([0.0, side, 0.0], (x.size, 1))) for s in solids]
        nearest = [np.where(leave > 0, np.maximum(enter, 0.0), np.inf) for enter, leave in spans]
        ends.append(float(np.min(nearest)))
    return sum(ends) if np.isfinite(ends).all() else None


def blocked(solids: list[Array], origins: Array, directions: Array) -> Array:
    """(n,) distance at which rays meet the first of some solids, given by planes; else infinite.

    Solids that a ray begins in do not count: a sensor sits in its housing.
    """
    nearest = np.full(len(directions), np.inf)
    for planes in solids:
        enter, _ = crossings(planes, origins, directions)
        nearest = np.minimum(nearest, np.where(enter > 0, enter, np.inf))
    return nearest
