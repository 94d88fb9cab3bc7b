"""Convex hulls as vertices and outward triangles: qhull's, without a mesh library around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array

OPTIONS = "QbB Pp Qt"
"""Of qhull: scaled to a unit cube, no warnings, triangles only."""


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
    triangles = hull.simplices
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals = hull.equations[:, :3]
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), normals) < 0.0
    triangles = np.where(inward[:, None], triangles[:, ::-1], triangles)
    return HullMesh(np.asarray(points[used]), new[triangles], normals, float(hull.volume))
