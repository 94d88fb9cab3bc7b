"""Arm and load as the moving base sees them: where they reach beyond it, and what stands there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product

import numpy as np
from scipy.spatial import cKDTree

from momantu_bt.geometry import Array, Transform
from momantu_skills.manipulation.scene.surroundings import Support, within

FIELD = 0.04
"""Longest edge of the fields of a part that are covered by a disc each, m: a disc extends at most 8
mm beyond its field."""
EXPLAINED = 0.1
"""Distance from what the map knows at which a laser's hit shows nothing new, m."""
GRID = 0.05
"""Greatest height of the pieces in which a column is looked at, m."""
DRAWN = 0.05
"""Distance beside a surface at which a laser's hit belongs to it, m."""


def overhang(parts: Iterable[Array], base: Array) -> Array:
    """Discs (k, 5) that cover what of some parts reaches beyond the base, base frame, m.

    parts: corners (n, 3) of each. base: the base's outline (m, 2). A row has x, y, radius, and the
    part's lowest and highest point.
    """
    rows = [
        (x, y, radius, part[:, 2].min(), part[:, 2].max())
        for part in parts
        if not within(part[:, :2], base).all()
        for x, y, radius in _covering(part)
    ]
    found = np.array(rows).reshape(-1, 5)
    inside = [bool(within(row[None, :2], base, -row[2])[0]) for row in found]
    return np.asarray(found[~np.array(inside, dtype=np.bool_)])


def _covering(part: Array) -> Array:
    """Discs (k, 3) that cover a part's projection on the floor: around the fields of a raster."""
    middle = part[:, :2].mean(axis=0)
    off = part[:, :2] - middle
    axes = np.linalg.eigh(off.T @ off)[1]
    low, high = (off @ axes).min(axis=0), (off @ axes).max(axis=0)
    counts = np.maximum(1, np.ceil((high - low) / FIELD)).astype(np.int64)
    edges = (high - low) / counts
    own = low + (np.indices(counts).reshape(2, -1).T + 0.5) * edges
    return np.column_stack([middle + own @ axes.T, np.full(len(own), np.hypot(*edges) / 2)])


def standing(points: Array, height: float, radius: float) -> Array:
    """Columns (n, 5) at points (n, 2) that stand on the floor, all of one height, m.

    A row has x, y, the lowest and the highest point, and the radius, m.
    """
    rest = np.tile((0.0, height, radius), (len(points), 1))
    return np.column_stack([points, rest])


def unexplained(points: Array, known: Array) -> Array:
    """Those of points (n, 2) that are far from all of some known ones (m, 2)."""
    if not len(known) or not len(points):
        return points
    away, _ = cKDTree(known).query(points, distance_upper_bound=EXPLAINED)
    return np.asarray(points[~np.isfinite(away)])


def cut(columns: Array) -> Array:
    """The same columns (n, 5) in pieces (m, 5) at most `GRID` high."""
    counts = np.maximum(1, np.ceil((columns[:, 3] - columns[:, 2]) / GRID)).astype(np.int64)
    pieces = np.repeat(columns, counts, axis=0)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    height = np.repeat((columns[:, 3] - columns[:, 2]) / counts, counts)
    pieces[:, 2] += (np.arange(len(pieces)) - first) * height
    pieces[:, 3] = pieces[:, 2] + height
    return np.asarray(pieces)


def samples(pieces: Array) -> Iterator[Array]:
    """Points (n, 3) of pieces (n, 5), set by set: middles, then corners of cells around them.

    A picture may pass beside the middle of a piece and yet show what stands in its cell: the thin
    back of a chair, where the base is a centimetre or two beside where it believes to be.
    """
    heights = pieces[:, 2:4].mean(axis=1)
    for dx, dy in ((0.0, 0.0), *product((-GRID / 2, GRID / 2), repeat=2)):
        yield np.column_stack([pieces[:, 0] + dx, pieces[:, 1] + dy, heights])


def beside(points: Array, supports: Sequence[Support], base_from_odom: Transform) -> Array:
    """Those of points (n, 2), base frame, that lie on none of the supports."""
    flat = np.column_stack([points, np.zeros(len(points))])
    odom = base_from_odom.inverse().apply(flat)[:, :2]
    kept = np.ones(len(points), dtype=np.bool_)
    for support in supports:
        kept &= ~within(odom, support.outline, DRAWN)
    return np.asarray(points[kept])
