"""Convex hulls of links and objects: for collision checks, self-filtering and footprints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from itertools import product

import coal
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject
from momantu_skills.manipulation.model.urdf import CollisionPart

MOST_CORNERS = 80
"""Hulls are reduced to about this many corners, to keep checks fast. An arm link of usual size
shrinks by up to 7 mm, a hand by 2 mm, a torso or base by up to 27 mm."""
ROUND = 16
"""Corners of the polygon that replaces a cylinder's circle."""
SPHERE = 64
"""Number of hull corners of a sphere."""


_SIDES = np.array(
    [
        *((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        *((1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)),
        *((1, 1, 1), (1, 1, -1), (1, -1, 1), (-1, 1, 1)),
    ],
    dtype=np.float64,
)
DIRECTIONS = _SIDES / np.linalg.norm(_SIDES, axis=1, keepdims=True)
"""(13, 3): the normals of the slabs that enclose a link (a 26-DOP, Klosowski et al. 1998)."""


def hull_points(points: Array, most: int = MOST_CORNERS) -> Array:
    """Corners (k, 3) of the convex hull of points (n, 3), reduced to the extreme ones.

    The reduction keeps the farthest corner in each of `most` evenly distributed directions.
    """
    corners = points[ConvexHull(points).vertices]
    if len(corners) <= most:
        return np.ascontiguousarray(corners)
    keep = np.unique(np.argmax(corners @ _directions(most).T, axis=0))
    return np.ascontiguousarray(corners[keep])


def _directions(count: int) -> Array:
    """Unit vectors (count, 3) spread over the sphere (Fibonacci lattice) and the axes' ends."""
    i = np.arange(count) + 0.5
    polar, turn = np.arccos(1 - 2 * i / count), np.pi * (1 + 5**0.5) * i
    spread = np.stack(
        [np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)], axis=1
    )
    return np.vstack([spread, np.eye(3), -np.eye(3)])


def convex(points: Array) -> coal.Convex:
    """A coal shape of the convex hull of points (n, 3); the same points give the same shape."""
    return _convex(np.ascontiguousarray(points, dtype=np.float64).tobytes())


@lru_cache(maxsize=256)
def _convex(data: bytes) -> coal.Convex:
    points = np.frombuffer(data).reshape(-1, 3)
    hull = ConvexHull(points)
    order = {int(v): i for i, v in enumerate(hull.vertices)}
    vertices, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for v in hull.vertices:
        vertices.append(points[v])
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = (int(i) for i in simplex)
        outward = np.cross(points[b] - points[a], points[c] - points[a]) @ equation[:3] > 0
        triangles.append(
            coal.Triangle(order[a], *((order[b], order[c]) if outward else (order[c], order[b])))
        )
    return coal.Convex(vertices, triangles)


def part_points(part: CollisionPart) -> Array:
    """Points (n, 3) in the link's frame whose hull covers a collision element."""
    if part.kind == "mesh":
        points = np.unique(np.asarray(load_mesh(part).vertices()), axis=0)
    elif part.kind == "box":
        points = np.array(list(product((-0.5, 0.5), repeat=3))) * np.array(part.size)
    elif part.kind == "cylinder":
        points = prism(part.size[0], part.size[1])
    else:
        points = _sphere(part.size[0])
    return part.link_from_part.apply(points)


def load_mesh(part: CollisionPart) -> coal.BVHModelBase:
    """The mesh of a collision element, in its own frame.

    Raises:
        ValueError: its file cannot be read.
    """
    try:
        return coal.MeshLoader().load(str(part.mesh), np.array(part.size))
    except (RuntimeError, ValueError):
        raise ValueError(
            f"the mesh {part.mesh} of the link {part.link!r} cannot be read; write it anew as STL, "
            "OBJ or DAE, or take it out of the robot's URDF"
        ) from None


def prism(radius: float, height: float) -> Array:
    """Corners of a prism around an upright cylinder at the origin, (2 * ROUND, 3)."""
    angles = 2 * np.pi * np.arange(ROUND) / ROUND
    outer = radius / np.cos(np.pi / ROUND)
    ring = np.stack([outer * np.cos(angles), outer * np.sin(angles)], axis=1)
    low = np.column_stack([ring, np.full(ROUND, -height / 2)])
    return np.vstack([low, low * (1.0, 1.0, -1.0)])


def _sphere(radius: float) -> Array:
    """Corners (n, 3) of a polyhedron around a sphere at the origin."""
    inside = _directions(SPHERE)
    touched = -float(ConvexHull(inside).equations[:, 3].max())
    return inside * (radius / touched)


def link_hulls(parts: Iterable[CollisionPart]) -> dict[str, Array]:
    """Corners of one hull per link, in the link's frame."""
    points: dict[str, list[Array]] = {}
    for part in parts:
        points.setdefault(part.link, []).append(part_points(part))
    return {link: hull_points(np.vstack(some)) for link, some in points.items()}


class LinkMask:
    """Encloses hulls in slabs, for a fast test of which points lie inside."""

    def __init__(self, hulls: Mapping[str, Array], padding: float) -> None:
        self.names = tuple(hulls)
        self._low = np.array([(h @ DIRECTIONS.T).min(axis=0) for h in hulls.values()]) - padding
        self._high = np.array([(h @ DIRECTIONS.T).max(axis=0) for h in hulls.values()]) + padding
        self._centres = np.array([(h.min(axis=0) + h.max(axis=0)) / 2 for h in hulls.values()])
        spread = zip(hulls.values(), self._centres, strict=True)
        self._radii = np.array([np.linalg.norm(h - c, axis=1).max() for h, c in spread])
        self._radii += padding

    def covers(self, points: Array, poses: Mapping[str, Array]) -> NDArray[np.bool_]:
        """Which of points (n, 3) lie within a link at its pose base_from_link (4, 4): (n,)."""
        inside = np.zeros(len(points), dtype=bool)
        x = np.ascontiguousarray(points[:, 0])
        for i, name in enumerate(self.names):
            pose = poses[name]
            centre = pose[:3, :3] @ self._centres[i] + pose[:3, 3]
            candidates = np.flatnonzero(np.abs(x - centre[0]) < self._radii[i])
            candidates = candidates[~inside[candidates]]
            offsets = points[candidates] - centre
            near = np.einsum("ij,ij->i", offsets, offsets) < self._radii[i] ** 2
            candidates = candidates[near]
            if not len(candidates):
                continue
            local = (points[candidates] - pose[:3, 3]) @ pose[:3, :3]
            along = local @ DIRECTIONS.T
            inside[candidates] = ((along >= self._low[i]) & (along <= self._high[i])).all(axis=1)
        return inside


def floor_outline(corners: Array) -> Array:
    """Convex outline (k, 2), counter-clockwise, of corners (n, 3) projected onto the floor."""
    flat = corners[:, :2]
    return np.asarray(flat[ConvexHull(flat).vertices])


def placed(points: Array, pose: Array) -> Array:
    """Points (n, 3) of a frame whose pose is (4, 4), in the frame in which the pose is."""
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


def object_corners(thing: DetectedObject, padding: float = 0.0) -> Array:
    """Corners (n, 3) of an object's hull in its frame, enlarged by `padding` m on every side."""
    x, y, z = (edge + 2 * padding for edge in thing.size)
    if thing.shape == "cylinder":
        return prism(max(x, y) / 2, z)
    return np.array(list(product((-0.5, 0.5), repeat=3))) * (x, y, z)
