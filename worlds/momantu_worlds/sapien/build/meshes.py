"""Parts of bodies as triangle meshes, for rays and cuts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import trimesh

from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Geometry, Hull, Part, Sphere

CYLINDER_SIDES = 24
"""Sides of the prism that replaces a cylinder: the error is at most 0.9 % of the radius."""
SPHERE_LEVEL = 2
"""Refinements of the icosahedron that replaces a sphere: the error is at most 2 % of the radius."""


def collision_mesh(geometry: Geometry) -> Any:
    """The geometry around its own origin, a trimesh.Trimesh.

    Raises:
        TypeError: a visual-only geometry.
    """
    if isinstance(geometry, Box):
        return trimesh.creation.box(extents=geometry.size)
    if isinstance(geometry, Cylinder):
        return trimesh.creation.cylinder(
            radius=geometry.radius, height=geometry.height, sections=CYLINDER_SIDES
        )
    if isinstance(geometry, Sphere):
        return trimesh.creation.icosphere(subdivisions=SPHERE_LEVEL, radius=geometry.radius)
    if isinstance(geometry, Hull):
        return trimesh.convex.convex_hull(np.asarray(geometry.vertices))
    raise TypeError(f"a {type(geometry).__name__} has no collision shape")


def volume(geometry: Geometry) -> float:
    """Volume of a colliding geometry, m3."""
    if isinstance(geometry, Box):
        return math.prod(geometry.size)
    if isinstance(geometry, Cylinder):
        return math.pi * geometry.radius**2 * geometry.height
    if isinstance(geometry, Sphere):
        return 4.0 / 3.0 * math.pi * geometry.radius**3
    return float(collision_mesh(geometry).volume)


def body_mesh(body: Body) -> Any:
    """All colliding parts of a body in its own frame, a trimesh.Trimesh; None without any."""
    parts = [_placed(part) for part in body.parts if part.collision]
    return trimesh.util.concatenate(parts) if parts else None


def map_triangles(bodies: list[Body]) -> Array:
    """Triangles (k, 3, 3) of the colliding parts of static bodies, in the map."""
    triangles = []
    for body in bodies:
        mesh = body_mesh(body)
        if mesh is not None:
            triangles.append(body.map_from_body.apply(mesh.triangles))
    return np.concatenate(triangles) if triangles else np.zeros((0, 3, 3))


def _placed(part: Part) -> Any:
    mesh = collision_mesh(part.geometry)
    mesh.apply_transform(part.body_from_part.matrix)
    return mesh
