"""Parts of bodies as triangle meshes, for rays and cuts.

Boxes, cylinders and hulls are those of trimesh, number by number. trimesh itself, whose import
takes longer than building a world, is loaded for other shapes.
"""

from __future__ import annotations

import math
from contextlib import suppress
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import QhullError

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Geometry, Hull, Part, Sphere
from momantu_worlds.scenes.geometry.hulls import hull_mesh

with lazily():
    import trimesh

CYLINDER_SIDES = 24
"""Sides of the prism that replaces a cylinder: the error is at most 0.9 % of the radius."""
SPHERE_LEVEL = 2
"""Refinements of the icosahedron that replaces a sphere: the error is at most 2 % of the radius."""

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
"""(8, 3): the corners of a box with edges of 1."""
_BOX = np.array(
    [
        *((1, 3, 0), (4, 1, 0), (0, 3, 2), (2, 4, 0), (1, 7, 3), (5, 1, 4)),
        *((5, 7, 1), (3, 7, 2), (6, 4, 2), (2, 7, 6), (6, 5, 4), (7, 5, 6)),
    ],
    dtype=np.int32,
)
"""(12, 3): the triangles of a box, counter-clockwise from outside."""
_NO_AREA = 1e-8
"""Triangles of a cylinder with less area, m2, are left out."""
_NOT_MOVED = 1e-8
"""A pose whose matrix differs less from that of no motion is none."""


class TriangleMesh(NamedTuple):
    """vertices: (n, 3) m. faces: (m, 3) indices, counter-clockwise seen from outside."""

    vertices: Array
    faces: NDArray[np.int32]

    @property
    def triangles(self) -> Array:
        """Corners (m, 3, 3) of each triangle."""
        return self.vertices[self.faces]


def collision_mesh(geometry: Geometry) -> TriangleMesh:
    """The geometry around its own origin; the arrays may be shared, so do not change them.

    Raises:
        TypeError: a visual-only geometry.
    """
    if isinstance(geometry, Box):
        return TriangleMesh(_CORNERS * np.asarray(geometry.size, dtype=np.float64), _BOX)
    if isinstance(geometry, Cylinder):
        return _cylinder(geometry.radius, geometry.height)
    if isinstance(geometry, Sphere):
        return _taken(trimesh.creation.icosphere(SPHERE_LEVEL, geometry.radius))
    if isinstance(geometry, Hull):
        return _hull(_data(geometry))[0]
    raise TypeError(f"a {type(geometry).__name__} has no collision shape")


def volume(geometry: Geometry) -> float:
    """Volume of a colliding geometry, m3."""
    if isinstance(geometry, Box):
        return math.prod(geometry.size)
    if isinstance(geometry, Cylinder):
        return math.pi * geometry.radius**2 * geometry.height
    if isinstance(geometry, Sphere):
        return 4.0 / 3.0 * math.pi * geometry.radius**3
    if isinstance(geometry, Hull):
        return _hull(_data(geometry))[1]
    raise TypeError(f"a {type(geometry).__name__} has no collision shape")


def body_mesh(body: Body) -> TriangleMesh | None:
    """All colliding parts of a body in its own frame; None without any."""
    parts = [_placed(part) for part in body.parts if part.collision]
    if not parts:
        return None
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])], dtype=np.int32)
    faces = [part.faces + first for part, first in zip(parts, firsts, strict=True)]
    return TriangleMesh(np.concatenate([part.vertices for part in parts]), np.concatenate(faces))


def map_triangles(bodies: list[Body]) -> Array:
    """Triangles (k, 3, 3) of the colliding parts of static bodies, in the map."""
    triangles = []
    for body in bodies:
        mesh = body_mesh(body)
        if mesh is not None:
            triangles.append(body.map_from_body.apply(mesh.triangles))
    return np.concatenate(triangles) if triangles else np.zeros((0, 3, 3))


def _placed(part: Part) -> TriangleMesh:
    mesh, matrix = collision_mesh(part.geometry), part.body_from_part.matrix
    if np.abs(matrix - np.eye(4)).max() < _NOT_MOVED:
        return mesh
    padded = np.column_stack((mesh.vertices, np.ones(len(mesh.vertices))))
    return TriangleMesh((matrix @ padded.T).T[:, :3], mesh.faces)


def _cylinder(radius: float, height: float) -> TriangleMesh:
    """A prism with its axis along z: per side a slice of four points, from axis to axis."""
    turns = np.linspace(0.0, 2.0 * np.pi, CYLINDER_SIDES + 1)
    around = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    out = np.array([0.0, radius, radius, 0.0])
    up = np.array([-height, -height, height, height]) / 2.0
    ring = around[:, None, :] * out[:, None]
    slices = np.concatenate([ring, np.broadcast_to(up[:, None], (*ring.shape[:2], 1))], axis=2)
    vertices = slices.reshape(-1, 3) + 0.0  # no zeros with a sign
    first = np.array([(i + a, i + b, i + c) for i in range(3) for a, b, c in _QUAD], np.int32)
    edges = np.diff(vertices[first], axis=1)
    areas = np.sqrt((np.cross(edges[:, 0], edges[:, 1]) ** 2).sum(axis=1)) / 2.0
    first = first[areas > _NO_AREA]
    count = 4 * CYLINDER_SIDES
    faces = np.concatenate([first + 4 * side for side in range(CYLINDER_SIDES)]) % count
    return TriangleMesh(vertices[:count], faces)


_QUAD = ((0, 4, 1), (1, 4, 5))
"""The two triangles between two points of a slice and those of the next, four points later."""


def _data(hull: Hull) -> bytes:
    return np.ascontiguousarray(hull.vertices, dtype=np.float64).tobytes()


@lru_cache(maxsize=1024)
def _hull(data: bytes) -> tuple[TriangleMesh, float]:
    """The convex hull of points (n, 3), given as their bytes, and its volume, m3."""
    points = np.frombuffer(data).reshape(-1, 3)
    with suppress(QhullError):
        hull = hull_mesh(points)
        faces = hull.triangles.astype(np.int32)
        if _is_closed(faces):
            return TriangleMesh(hull.vertices, faces), hull.volume
    mesh = trimesh.convex.convex_hull(points)
    return _taken(mesh), float(mesh.volume)


def _is_closed(faces: NDArray[np.int32]) -> bool:
    """Whether each edge belongs to two triangles, which go along it in opposite directions."""
    begins, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    there, back = np.unique([begins, ends], axis=1), np.unique([ends, begins], axis=1)
    return there.shape == (2, faces.size) and np.array_equal(there, back)


def _taken(mesh: Any) -> TriangleMesh:
    return TriangleMesh(np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32))
