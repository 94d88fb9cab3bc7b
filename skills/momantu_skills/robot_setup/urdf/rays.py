"""Intersections of rays with convex hulls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array

PAD_ALONG = 0.2
"""Share of the pads' length, to each side of their centre, that is measured: fingers that rotate
are closer to each other at one end."""
RAYS = 15
"""Heights at which fingers are looked for that stand above and below the pads' height."""
PARALLEL = 1e-12
"""A ray is parallel to a plane if the dot product of its direction and the normal is below this."""


def planes_of(corners: Array) -> Array:
    """(k, 4): outward unit normals and offsets of the hull of corners (n, 3)."""
    return np.asarray(ConvexHull(corners).equations)


def crossings(planes: Array, origins: Array, directions: Array) -> tuple[Array, Array]:
    """Where rays (n, 3) enter and leave a convex solid, in lengths of their directions, (n,).

    Both are infinite if a ray misses the solid, and negative behind the ray's origin.
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

    fingers: corners (n, 3) of each one's hull in that frame. Where one side has no finger at the
    pads' height, as of three fingers two stand above and below the third, it is looked for at
    every height that fingers of that side have. None if one side has no finger at all.
    """
    ends = []
    for side in (1.0, -1.0):
        gap = _gap(fingers, side, pad_length, 0.5 * pad_height * np.linspace(-1.0, 1.0, 7))
        own = [corners for corners in fingers if side * corners[:, 1].mean() > 0]
        if not np.isfinite(gap) and own:
            z = np.concatenate(own)[:, 2]
            gap = _gap(own, side, pad_length, np.linspace(z.min(), z.max(), RAYS))
        ends.append(gap)
    return sum(ends) if np.isfinite(ends).all() else None


def _gap(fingers: Sequence[Array], side: float, pad_length: float, heights: Array) -> float:
    """From y = 0 to the first finger on a side, m, at heights (k,); infinite without one."""
    x, z = np.meshgrid(np.linspace(-PAD_ALONG, PAD_ALONG, 3) * pad_length, heights)
    starts = np.stack([x.ravel(), np.zeros(x.size), z.ravel()], axis=1)
    ways = np.tile([0.0, side, 0.0], (x.size, 1))
    spans = [crossings(planes_of(corners), starts, ways) for corners in fingers]
    nearest = [np.where(leave > 0, np.maximum(enter, 0.0), np.inf) for enter, leave in spans]
    return float(np.min(nearest))


def blocked(solids: list[Array], origins: Array, directions: Array) -> Array:
    """Distances (n,) to the first solid that rays hit, given by planes; infinite without a hit.

    A solid that contains a ray's origin is ignored: a sensor is inside its housing.
    """
    nearest = np.full(len(directions), np.inf)
    for planes in solids:
        enter, _ = crossings(planes, origins, directions)
        nearest = np.minimum(nearest, np.where(enter > 0, enter, np.inf))
    return nearest
