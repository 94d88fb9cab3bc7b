"""Approximate convex decomposition of hollow furniture: split where the hulls shrink the most.

A part is cut by planes across its axes as long as the convex hulls of what lies on both sides are
together clearly smaller than the hull before: a table becomes its top and its legs. This is the
greedy scheme of Mamou and Ghorbel (A simple and efficient approach for 3D mesh approximate convex
decomposition, ICIP 2009), on triangles instead of voxels, so level tops keep their height.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.geometry import Array
from momantu_worlds.sdf.mesh.files import Piece
from momantu_worlds.sdf.mesh.reducing import reduced

GAIN = 0.12
"""Least share of its volume that a hull must lose by a cut."""
LEAST = 5e-4
"""Least volume that a cut must save, m3: that of a cube of 8 cm."""
MOST_PIECES = 48
"""Most pieces of one part."""
CUTS = 5
"""Planes that are tried across each axis, besides those at edges of the part."""
EDGES = 3
"""Most planes at edges that are tried across each axis."""
TRIED = 6
"""Cuts of the simpler surface that are tried on the whole one."""
BESIDE = 1e-3
"""Distance of a plane from the edge that it is put beside, m."""
MOST_TRIANGLES = 1000
"""With more, planes are chosen for a simpler surface."""

Triangles: TypeAlias = Array
"""Corners (n, 3, 3)."""


@dataclass(frozen=True, slots=True)
class _Cut:
    """The best cut of a piece. saved: volume, m3."""

    saved: float
    axis: int
    at: float


@dataclass(frozen=True, slots=True)
class _Piece:
    """few: a simpler surface of the same form."""

    whole: Triangles
    few: Triangles

    def parts(self, cut: _Cut) -> tuple[_Piece, _Piece]:
        """What lies below and above a cut."""
        whole, few = (_cut_at(t, cut.axis, cut.at) for t in (self.whole, self.few))
        return _Piece(whole[0], few[0]), _Piece(whole[1], few[1])


def split_hulls(vertices: Array, triangles: NDArray[np.int64]) -> list[Array]:
    """Points (n, 3) of the convex pieces that cover a surface; one if no cut is worth it.

    It is cut along the sides of the least rectangle around it, seen from above.
    """
    *_, angle = cv2.minAreaRect(vertices[:, :2].astype(np.float32))
    cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn = np.array([(cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)])
    return [piece @ turn.T for piece in _split(vertices @ turn, triangles)]


def _split(vertices: Array, triangles: NDArray[np.int64]) -> list[Array]:
    simple = reduced([Piece(vertices, triangles)], MOST_TRIANGLES)
    few = np.concatenate([piece.vertices[piece.triangles] for piece in simple])
    waiting: list[tuple[float, int, _Piece, _Cut]] = []
    done: list[_Piece] = []
    fresh = [_Piece(vertices[triangles], few)]
    for number in range(MOST_PIECES):
        for order, piece in enumerate(fresh):
            cut = _best_cut(piece)
            if cut is None:
                done.append(piece)
            else:
                heapq.heappush(waiting, (-cut.saved, 2 * number + order, piece, cut))
        if not waiting or len(waiting) + len(done) == MOST_PIECES:
            break
        _, _, piece, cut = heapq.heappop(waiting)
        fresh = list(piece.parts(cut))
    done += [piece for _, _, piece, _ in sorted(waiting, key=lambda entry: entry[1])]
    return [np.unique(p.whole.reshape(-1, 3), axis=0) for p in done if len(p.whole)]


def _best_cut(piece: _Piece) -> _Cut | None:
    """The cut that saves most; None if none is worth it."""
    found = sorted(_cuts(piece.few), key=lambda cut: -cut.saved)[:TRIED]
    volume = _volume(piece.whole)
    true = [
        _Cut(volume - sum(_volume(part.whole) for part in piece.parts(cut)), cut.axis, cut.at)
        for cut in found
    ]
    best = max(true, key=lambda cut: cut.saved, default=None)
    return None if best is None or best.saved < max(GAIN * volume, LEAST) else best


def _cuts(triangles: Triangles) -> Iterator[_Cut]:
    """Cuts that save something."""
    volume = _volume(triangles)
    if volume < LEAST:
        return
    for axis in range(3):
        for at in _planes(triangles, axis):
            below, above = _cut_at(triangles, axis, at)
            if len(below) and len(above):
                saved = volume - _volume(below) - _volume(above)
                if saved > LEAST:
                    yield _Cut(saved, axis, at)


def _planes(triangles: Triangles, axis: int) -> Iterator[float]:
    """Positions of planes across an axis: evenly spaced, and beside where many corners lie."""
    values = triangles[:, :, axis].reshape(-1)
    low, high = float(values.min()), float(values.max())
    if high - low < 4 * BESIDE:
        return
    yield from np.linspace(low, high, CUTS + 2)[1:-1].tolist()
    levels, counts = np.unique(np.round(values, 3), return_counts=True)
    inside = (levels > low + 2 * BESIDE) & (levels < high - 2 * BESIDE)
    order = np.argsort(-counts[inside], kind="stable")[:EDGES]
    for level in levels[inside][order].tolist():
        yield level - BESIDE
        yield level + BESIDE


def _cut_at(triangles: Triangles, axis: int, at: float) -> tuple[Triangles, Triangles]:
    """The triangles below and above a plane; those across it are cut."""
    side = triangles[:, :, axis] > at
    count = side.sum(axis=1)
    below, above = [triangles[count == 0]], [triangles[count == 3]]
    for lone, few, many in ((1, above, below), (2, below, above)):
        crossing = triangles[count == lone]
        if not len(crossing):
            continue
        own = side[count == lone] == (lone == 1)
        first = own.argmax(axis=1)
        rows = np.arange(len(crossing))
        a, b, c = (crossing[rows, (first + step) % 3] for step in range(3))
        ab, ac = _on_plane(a, b, axis, at), _on_plane(a, c, axis, at)
        few.append(np.stack([a, ab, ac], axis=1))
        many += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
    return np.concatenate(below), np.concatenate(above)


def _on_plane(start: Array, end: Array, axis: int, at: float) -> Array:
    share = (at - start[:, axis]) / (end[:, axis] - start[:, axis])
    return np.asarray(start + share[:, None] * (end - start))


def _volume(triangles: Triangles) -> float:
    """Volume of the convex hull of some triangles, m3; 0 if they are flat."""
    points = triangles.reshape(-1, 3)
    if len(points) > 64:
        points = points[_outer(points)]
    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0


_angles = np.arange(0, 48)
_DIRECTIONS = np.stack(
    [
        np.cos(_angles * 2.399963) * np.sqrt(1 - ((_angles + 0.5) / 24 - 1) ** 2),
        np.sin(_angles * 2.399963) * np.sqrt(1 - ((_angles + 0.5) / 24 - 1) ** 2),
        (_angles + 0.5) / 24 - 1,
    ]
)
"""Directions (3, 48), evenly on a sphere (a Fibonacci spiral)."""


def _outer(points: Array) -> Array:
    """Indices of points that lie farthest in some direction: their hull is nearly that of all."""
    along = points @ np.concatenate([_DIRECTIONS, np.eye(3), -np.eye(3)], axis=1)
    return np.unique(along.argmax(axis=0))
