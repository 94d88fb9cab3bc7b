"""Convex solids of bodies: how deep two overlap, and where rays meet them.

Two convex polyhedra overlap when no axis separates them, and the axes that matter are the normals
of both and the cross products of their edges (Gottschalk, Lin and Manocha, OBBTree, SIGGRAPH 1996);
the least overlap along any of these is how far one must be moved to be free of the other. Coal's
penetration depth (EPA) is not used: for solids that touch exactly, as boards and posts of furniture
do, it may be the largest double.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Part
from momantu_worlds.scenes.geometry.hulls import hull_mesh
from momantu_worlds.scenes.geometry.solids import SIDES, outline

MOST_AXES = 3000
"""Limit of the edge cross products that are tested: finer hulls have more, nearly parallel ones."""
HALF = np.array([1.0, 1e-3, 1e-6])
"""Directions on its side count, of each direction and its opposite."""
PARALLEL = 1e-9
"""Length of a cross product, of unit vectors, below which they count as parallel."""


@dataclass(frozen=True, eq=False)
class Convex:
    """A convex solid in the map.

    vertices: (n, 3) m. normals: (k, 3) unit, outward, of its faces. edges: (m, 3) unit
    directions, each once.
    """

    vertices: Array
    normals: Array
    edges: Array

    @cached_property
    def offsets(self) -> Array:
        """(k,) m; a point p is inside when `normals @ p <= offsets`."""
        return np.asarray((self.vertices @ self.normals.T).max(axis=0))

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """Least and greatest coordinates (3,)."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    def near(self, other: Convex, least: float) -> bool:
        """Whether the boxes around both overlap by more than `least` m."""
        low, high = self.box
        other_low, other_high = other.box
        return bool(((high - least > other_low) & (other_high - least > low)).all())

    def depth(self, other: Convex) -> float:
        """How far one must be moved to be free of the other, m; 0 when they are apart."""
        axes = np.concatenate([self.normals, other.normals, _crossed(self.edges, other.edges)])
        ours, theirs = self.vertices @ axes.T, other.vertices @ axes.T
        overlap = np.minimum(
            ours.max(axis=0) - theirs.min(axis=0), theirs.max(axis=0) - ours.min(axis=0)
        )
        return max(0.0, float(overlap.min()))

    def inside(self, points: Array) -> NDArray[np.bool_]:
        """Which of points (n, 3) lie in it."""
        return np.asarray((points @ self.normals.T <= self.offsets).all(axis=1))

    def hits(self, origins: Array, rays: Array) -> Array:
        """Where rays (n, 3) from origins (n, 3) enter it, in lengths of the ray; inf: never.

        A ray that begins inside enters at 0.
        """
        towards = rays @ self.normals.T
        room = self.offsets - origins @ self.normals.T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = room / towards
        enter = np.where(towards < 0, at, -np.inf).max(axis=1)
        leave = np.where(towards > 0, at, np.inf).min(axis=1)
        beside = ((towards == 0) & (room < 0)).any(axis=1)
        enter = np.maximum(enter, 0.0)
        return np.asarray(np.where(beside | (enter > leave), np.inf, enter))


def solids_of(body: Body) -> tuple[Convex, ...]:
    """The colliding parts of a body, where it stands."""
    return tuple(
        convex(part, body.map_from_body @ part.body_from_part)
        for part in body.parts
        if part.collision
    )


def convex(part: Part, map_from_part: Transform) -> Convex:
    """A part as a convex solid; a cylinder is the prism that stands for it."""
    turn = map_from_part.rotation
    points = outline(part)
    if isinstance(part.geometry, Box):
        normals, edges = np.concatenate([np.eye(3), -np.eye(3)]), np.eye(3)
    elif isinstance(part.geometry, Cylinder):
        normals, edges = _prism()
    else:
        points, normals, edges = _hull(points)
    return Convex(map_from_part.apply(points), normals @ turn.T, edges @ turn.T)


def hull_of(points: Array) -> Convex:
    """The convex hull of points (n, 3) in the map."""
    return Convex(*_hull(points))


def _prism() -> tuple[Array, Array]:
    """Normals and edge directions of the upright prism that stands for cylinders."""
    turns = (np.arange(SIDES) + 0.5) * (2.0 * math.pi / SIDES)
    around = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(SIDES)])
    up = np.array([(0.0, 0.0, 1.0)])
    rims = np.column_stack(
        [-around[: SIDES // 2, 1], around[: SIDES // 2, 0], np.zeros(SIDES // 2)]
    )
    return np.concatenate([around, up, -up]), np.concatenate([rims, up])


def _hull(points: Array) -> tuple[Array, Array, Array]:
    """Vertices, normals and edge directions of the convex hull of points."""
    hull = hull_mesh(points)
    ends = hull.vertices[np.concatenate([hull.triangles[:, [i, (i + 1) % 3]] for i in range(3)])]
    edges = ends[:, 1] - ends[:, 0]
    edges = edges / np.linalg.norm(edges, axis=1, keepdims=True)
    # each edge is there twice, once in either direction
    edges *= np.where(edges @ HALF < 0.0, -1.0, 1.0)[:, None]
    normals = np.unique(np.round(hull.normals, 6), axis=0)
    return hull.vertices, normals, np.unique(np.round(edges, 6), axis=0)


def _crossed(a: Array, b: Array) -> Array:
    """Unit cross products (n, 3) of two sets of directions; at most about `MOST_AXES`."""
    stride = math.ceil(len(a) * len(b) / MOST_AXES)
    axes = np.cross(a[:, None], b[None, ::stride]).reshape(-1, 3)
    length = np.linalg.norm(axes, axis=1)
    keep = length > PARALLEL
    return np.asarray(axes[keep] / length[keep, None])
