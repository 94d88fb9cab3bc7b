"""Level faces of bodies: of their collision shapes, and of what is drawn of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import cv2
import numpy as np

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.hulls import hull_mesh
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.parts import MeshPart, hull_of

UPRIGHT = 0.995
"""Least share of its length that a level face's normal has upwards."""
CELL = 0.02
"""Cell size of the grid on which faces that touch are found, m."""
MOST_CELLS = 1000
"""Most cells along one side of it."""
THIN = 1e-10
"""Area below which a triangle has no direction, m2."""

Outline: TypeAlias = tuple[float, Array]
"""A height, m, and the points (n, 3) of a level face."""


def face_of(hull: Array, level: float, low: float, high: float) -> Outline | None:
    """The level upper face of a hull (n, 3) between two heights, m; None if it has none."""
    height = float(hull[:, 2].max())
    upper = hull[hull[:, 2] > height - level]
    return (height, upper) if low <= height <= high and len(upper) > 2 else None


def drawn_faces(body: ImportedBody, low: float, high: float) -> Array:
    """Level triangles (n, 3, 3) of all that is drawn of a body between two heights, m, map."""
    found = [np.zeros((0, 3, 3))]
    for part in body.parts:
        if not part.visual:
            continue
        if part.faces is not None:
            own = part.faces
        elif part.hulls or not isinstance(part.solid, MeshPart):
            hulls = part.hulls or (hull_of(part.solid),)  # type: ignore[arg-type]
            own = np.concatenate([_triangles(hull) for hull in hulls])
        else:
            continue
        at = body.at @ part.body_from_part
        placed = at.apply(own.reshape(-1, 3)).reshape(-1, 3, 3)
        top = placed[:, :, 2].max(axis=1)
        placed = placed[(top >= low) & (top <= high)]
        normals = np.cross(placed[:, 1] - placed[:, 0], placed[:, 2] - placed[:, 0])
        length = np.linalg.norm(normals, axis=1)
        found.append(placed[(np.abs(normals[:, 2]) > UPRIGHT * length) & (length > THIN)])
    return np.concatenate(found)


def _triangles(hull: Array) -> Array:
    """Triangles (n, 3, 3) of the convex hull of points (n, 3)."""
    mesh = hull_mesh(hull)
    return mesh.vertices[mesh.triangles]


def patches(triangles: Array, level: float) -> Iterator[tuple[float, Array]]:
    """Triangles of one height that touch, each with the height, m, and their points (n, 3, 2)."""
    if not len(triangles):
        return
    heights = triangles[:, :, 2].max(axis=1)
    order = np.argsort(heights, kind="stable")
    breaks = np.flatnonzero(np.diff(heights[order]) > level) + 1
    for own in np.split(order, breaks):
        flat = triangles[own][:, :, :2]
        for label, members in _touching(flat):
            if label:
                yield float(heights[own][members].max()), flat[members]


def _touching(flat: Array) -> Iterator[tuple[int, Array]]:
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    cell = max(CELL, float((high - low).max()) / MOST_CELLS)
    shape = np.ceil((high - low) / cell).astype(int) + 3
    picture = np.zeros((int(shape[1]), int(shape[0])), dtype=np.uint8)
    corners = np.round((flat - low) / cell).astype(np.int32) + 1
    for triangle in corners:
        cv2.fillConvexPoly(picture, triangle, 1)
    _, labels = cv2.connectedComponents(picture, connectivity=8)
    of_each = labels[corners[:, 0, 1], corners[:, 0, 0]]
    for label in np.unique(of_each).tolist():
        yield int(label), of_each == label


def level_at(points: Array, triangles: Array, low: float, high: float) -> Array:
    """Height of the highest of some level triangles above each point (n, 2), m; -inf: none.

    Only those between two heights count.
    """
    found = np.full(len(points), -np.inf)
    top = triangles[:, :, 2].max(axis=1) if len(triangles) else np.zeros(0)
    for triangle, height in zip(triangles, top, strict=True):
        if not low <= height <= high:
            continue
        a, b, c = triangle[:, :2]
        sides = [_side(points, p, q) for p, q in ((a, b), (b, c), (c, a))]
        within = np.all([s >= -THIN for s in sides], axis=0) | np.all(
            [s <= THIN for s in sides], axis=0
        )
        found[within] = np.maximum(found[within], height)
    return found


def _side(points: Array, start: Array, end: Array) -> Array:
    """On which side of a line points (n, 2) lie: the sign says it."""
    along, to = end - start, points - start
    return np.asarray(along[0] * to[:, 1] - along[1] * to[:, 0])
