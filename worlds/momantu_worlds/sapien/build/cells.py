"""Cutting a mesh that is not convex into cells that nearly are."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh import intersections

from momantu_bt.robot import Cuts

CRUMB = 1e-5
"""m3; hulls below it are slivers along a cut."""


def convex_cells(path: str, cuts: Cuts) -> list[NDArray[np.float32]]:
    """Vertices (n, 3) of the convex hull of each cell of the mesh in a file."""
    mesh: Any = trimesh.load(path, force="mesh")
    cells = [(mesh.vertices, mesh.faces)]
    for axis, places in enumerate((cuts.x, cuts.y, cuts.z)):
        for place in places:
            cells = [half for cell in cells for half in _halves(*cell, axis, place)]
    hulls = [trimesh.convex.convex_hull(vertices[np.unique(faces)]) for vertices, faces in cells]
    return [np.asarray(hull.vertices, dtype=np.float32) for hull in hulls if hull.volume > CRUMB]


def _halves(vertices: Any, faces: Any, axis: int, place: float) -> list[tuple[Any, Any]]:
    """The triangles on either side of a plane across an axis, those it crosses cut."""
    origin, normal = np.zeros(3), np.zeros(3)
    origin[axis], normal[axis] = place, 1.0
    cut: Any = intersections.slice_faces_plane
    sides = [cut(vertices, faces, n, origin) for n in (normal, -normal)]
    return [(side[0], side[1]) for side in sides if len(side[1])]
