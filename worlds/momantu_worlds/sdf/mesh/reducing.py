"""Simplifying meshes: vertices that lie close become one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sdf.mesh.files import Piece

MOST_TRIANGLES = 60_000
"""Of one mesh to look at: a camera's picture of 640 x 480 shows few more."""
FIRST_CELL = 0.01
"""m; edge of the grid's cells that is tried first where triangles have no area."""
COARSER = 1.25
MOST_TRIES = 40


def reduced(pieces: Sequence[Piece], most: int = MOST_TRIANGLES) -> tuple[Piece, ...]:
    """Pieces with at most so many triangles in all, or as they are when they have no more.

    Vertex clustering (Rossignac and Borrel, 1993) on a grid that grows coarser until it is enough.
    """
    if count(pieces) <= most:
        return tuple(pieces)
    # a grid over a flat face has two triangles in each of its squares
    cell = math.sqrt(2.0 * sum(map(_area, pieces)) / most) or FIRST_CELL
    found = tuple(pieces)
    for _ in range(MOST_TRIES):
        found = tuple(p for p in (clustered(piece, cell) for piece in pieces) if len(p.triangles))
        if count(found) <= most:
            break
        cell *= COARSER
    return found


def _area(piece: Piece) -> float:
    a, b, c = (piece.vertices[piece.triangles[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0


def count(pieces: Sequence[Piece]) -> int:
    """Triangles of all pieces."""
    return sum(len(piece.triangles) for piece in pieces)


def clustered(piece: Piece, cell: float) -> Piece:
    """Vertices of one cell (edge: m) become one, the nearest to their mean; so uv stays true."""
    low = piece.vertices.min(axis=0)
    keys = np.floor((piece.vertices - low) / cell).astype(np.int64)
    _, group = np.unique(_packed(keys), return_inverse=True)
    chosen = _nearest_to_mean(piece.vertices, group)
    triangles = group[piece.triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(_packed(np.sort(triangles, axis=1)), return_index=True)
    triangles = triangles[np.sort(first)]
    return replace(
        piece,
        vertices=piece.vertices[chosen],
        triangles=triangles,
        uv=None if piece.uv is None else piece.uv[chosen],
    )


def _packed(rows: NDArray[np.int64]) -> NDArray[np.int64]:
    """One number for each row (n, 3) of numbers below 2 ** 21, equal for equal rows alone."""
    return np.asarray((rows[:, 0] << 42) | (rows[:, 1] << 21) | rows[:, 2])


def _nearest_to_mean(vertices: Array, group: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each group the index of its vertex that lies nearest to the group's mean."""
    sizes = np.bincount(group)
    sums = np.stack([np.bincount(group, vertices[:, i]) for i in range(3)], axis=1)
    away = np.linalg.norm(vertices - (sums / sizes[:, None])[group], axis=1)
    order = np.lexsort((away, group))
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    return np.asarray(order[starts])
