"""Convex hulls as vertices and outward triangles: qhull's, without a mesh library around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array

OPTIONS = "QbB Pp Qt"
"""Of qhull: scaled to a unit cube, no warnings, triangles only."""

THIN = 1e-14
"""Twice the area of a triangle below which it has no direction, m2."""


@dataclass(frozen=True, slots=True, eq=False)
class HullMesh:
    """vertices: (n, 3) m. triangles: (m, 3), counter-clockwise seen from outside.

    normals: (m, 3) unit, outward. volume: m3.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    normals: Array
    volume: float


def hull_mesh(points: Array) -> HullMesh:
    """The convex hull of points (n, 3).

    Raises:
        scipy.spatial.QhullError: they lie in one plane, or are too few.
    """
    hull = ConvexHull(points, qhull_options=OPTIONS)
    used = np.sort(hull.vertices)
    new = np.zeros(len(points), dtype=np.int64)
    new[used] = np.arange(len(used))
    vertices, triangles = np.asarray(points[used], dtype=np.float64), new[hull.simplices]
    # qhull's own normals and volume are those of the cube that it scales to
    own = vertices - vertices.mean(axis=0)
    a, b, c = (own[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    heights = np.einsum("ij,ij->i", normals, a)
    triangles = np.where(heights[:, None] < 0.0, triangles[:, ::-1], triangles)
    normals = np.where(heights[:, None] < 0.0, -normals, normals)
    length = np.linalg.norm(normals, axis=1)
    real = length > THIN
    return HullMesh(
        vertices,
        triangles[real],
        normals[real] / length[real, None],
        float(np.abs(heights).sum()) / 6.0,
    )
