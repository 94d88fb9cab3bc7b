"""Convex hulls of links: what collision checks, masks and footprints all work on."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from itertools import product

import coal
import numpy as np
from scipy.spatial import ConvexHull

from momantu_bt.geometry import Array
from momantu_skills.manipulation.urdf import CollisionPart

MOST_CORNERS = 80
"""Hulls are reduced to about this many corners, the price of quick checks: an arm's link of usual
size shrinks by up to 7 mm, a hand by 2 mm, a torso or base by up to 27 mm."""
ROUND = 16
"""Corners of a circle when a cylinder becomes a prism."""
SPHERE = 64
"""Directions in which a sphere's hull has corners."""


def hull_points(points: Array, most: int = MOST_CORNERS) -> Array:
    """Corners (k, 3) of the convex hull of points (n, 3), thinned to the extreme ones.

    Thinning keeps, for `most` evenly spread directions, the farthest corner.
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
    """The mesh of a collision element, in its own frame."""
    return coal.MeshLoader().load(str(part.mesh), np.array(part.size))


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
