"""Thin convex plates that replace a hollow mesh's faces, so that its inside stays free."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sdf.mesh.files import Piece
from momantu_worlds.sdf.mesh.reducing import clustered

PLATE = 0.01
"""Thickness of a plate towards its inner side, m."""
FLAT = 0.02
"""Largest share of its area by which the outline of joined triangles may differ from a convex
one."""
ONE_PLANE = 0.002
"""Distance above which parallel faces are different ones, m."""
MOST_PLATES = 600
"""Most plates of one part; with more, its hull is used."""
CELL = 0.02
"""Details smaller than this do not matter for a plate, m."""
MOST_TRIANGLES = 4000
"""Most triangles of a part that becomes plates; with more, its vertices are clustered first."""
THIN = 1e-9
"""Area below which triangles are left out, m2."""


def plates_of(vertices: Array, triangles: NDArray[np.int64]) -> list[Array]:
    """Thin convex pieces below a surface; none when it takes too many."""
    if len(triangles) > MOST_TRIANGLES:
        few = clustered(Piece(vertices, triangles), CELL)
        vertices, triangles = few.vertices, few.triangles
        if len(triangles) > MOST_TRIANGLES:
            return []
    triangles = triangles[_areas(vertices, triangles) > THIN]
    found: list[Array] = []
    for normal, face in _faces(vertices, triangles):
        for polygon in _convex_polygons(vertices, face, normal):
            found.append(np.concatenate([polygon, polygon - PLATE * normal]))
        if len(found) > MOST_PLATES:
            return []
    return found


def _areas(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0)


def _faces(
    vertices: Array, triangles: NDArray[np.int64]
) -> Iterator[tuple[Array, NDArray[np.int64]]]:
    """Triangles that lie in one plane, with its normal."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    offsets = np.einsum("ij,ij->i", normals, a)
    keys = np.round(np.column_stack([normals / FLAT, offsets / ONE_PLANE])).astype(np.int64)
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.reshape(-1)
    for one in range(int(group.max()) + 1):
        own = group == one
        yield normals[own].mean(axis=0), triangles[own]


def _convex_polygons(vertices: Array, face: NDArray[np.int64], normal: Array) -> Iterator[Array]:
    """Corners (n, 3) of convex polygons that cover the triangles of a face, joined greedily."""
    flat = _in_plane(normal)
    polygons = [frozenset(map(int, triangle)) for triangle in face]
    areas = {p: _hull_area(vertices[list(p)] @ flat) for p in polygons}
    open_polygons = list(dict.fromkeys(polygons))
    while open_polygons:
        polygon = open_polygons.pop(0)
        grown = True
        while grown:
            grown = False
            for other in open_polygons:
                joined = polygon | other
                if len(polygon & other) < 2:
                    continue
                area = _hull_area(vertices[list(joined)] @ flat)
                if area <= (areas[polygon] + areas[other]) * (1.0 + FLAT):
                    open_polygons.remove(other)
                    areas[joined] = area
                    polygon, grown = joined, True
                    break
        yield vertices[sorted(polygon)]


def _in_plane(normal: Array) -> Array:
    """Two unit vectors (3, 2) across a normal."""
    seed = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = np.cross(normal, seed)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)], axis=1)


def _hull_area(points: Array) -> float:
    """Area of the convex hull of points (n, 2), m2."""
    return float(shapely.convex_hull(shapely.multipoints(points)).area)
