"""What the physics takes the parts of a body for.

A loose thing that leans on the edge of its bottom comes to stand on a box. On a convex mesh it may
rock ever more: of 150 cans that were let go leaning by 2 to 7 degrees, 17 or 18 still rocked after
eight seconds, none on boxes. PhysX takes cylinders for convex meshes. So what things may stand on
is made of boxes where that is possible.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
import sapien

from momantu_bt.geometry import Array, Transform
from momantu_worlds.sapien.poses import pose_for_sapien, pose_of
from momantu_worlds.scenes.geometry.bodies import Box, Cylinder, Hull, Part, Sphere

DISC_BOXES = 8
"""Boxes that make up a disc; each has its corners on the edge, which is 2 % of the radius farther
out than where two boxes meet."""
EXACT = 1e-5
"""Largest distance of a hull's corners from those of a box that it is taken for, m."""


def collision_shapes(part: Part, material: Any, *, static: bool) -> list[Any]:
    """SAPIEN's shapes for one part, each placed in the body.

    static: things may stand on the part, and it never moves.
    """
    geometry = part.geometry
    if isinstance(geometry, Box):
        return [_box(part.body_from_part, geometry.size, material)]
    if static and isinstance(geometry, Cylinder) and geometry.height < geometry.radius:
        return [_box(part.body_from_part @ turn, size, material) for turn, size in _disc(geometry)]
    if static and isinstance(geometry, Hull) and (found := box_of(geometry.vertices)) is not None:
        middle, size = found
        return [_box(part.body_from_part @ middle, size, material)]
    shape = _shape(part, material)
    shape.local_pose = pose_of(pose_for_sapien(part))
    return [shape]


def _disc(disc: Cylinder) -> list[tuple[Transform, Array]]:
    """Boxes (part_from_box, edges (3,) in m) whose corners lie on a disc's edge."""
    half = math.pi / DISC_BOXES / 2
    long, short = 2 * disc.radius * math.cos(half), 2 * disc.radius * math.sin(half)
    turns = np.arange(DISC_BOXES) * math.pi / DISC_BOXES
    size = np.array([long, short, disc.height])
    return [(Transform.from_rpy((0, 0, 0), (0, 0, float(turn))), size) for turn in turns]


def box_of(vertices: Array) -> tuple[Transform, Array] | None:
    """The box (part_from_box, edges (3,) in m) whose corners points (n, 3) are; None if none."""
    _, kept = np.unique(np.round(vertices / EXACT), axis=0, return_index=True)
    if len(kept) != 8:
        return None
    corners = np.asarray(vertices, dtype=float)[kept]
    first = corners[0]
    away = corners - first
    order = np.argsort(np.linalg.norm(away, axis=1))
    a, b = away[order[1]], away[order[2]]
    across = np.cross(a, b)
    c = max(away, key=lambda each: abs(float(across @ each)) / (np.linalg.norm(each) + 1e-12))
    axes = np.array([a, b, c])
    size = np.linalg.norm(axes, axis=1)
    if size.min() < EXACT:
        return None
    unit = axes / size[:, None]
    rotation = np.column_stack([unit[0], unit[1], np.cross(unit[0], unit[1])])
    middle = first + axes.sum(axis=0) / 2
    local = np.abs((corners - middle) @ rotation)
    if np.abs(local - size / 2).max() > EXACT:
        return None
    return Transform.from_rotation(rotation, middle), size


def _box(body_from_box: Transform, size: Iterable[float], material: Any) -> Any:
    """A box with edges (3,) in m."""
    half = [float(edge) / 2 for edge in size]
    shape = sapien.physx.PhysxCollisionShapeBox(half_size=half, material=material)
    shape.local_pose = pose_of(body_from_box)
    return shape


def _shape(part: Part, material: Any) -> Any:
    """SAPIEN's own shape for a part that is no box, not placed yet."""
    geometry, physx = part.geometry, sapien.physx
    if isinstance(geometry, Cylinder):
        return physx.PhysxCollisionShapeCylinder(
            radius=geometry.radius, half_length=geometry.height / 2, material=material
        )
    if isinstance(geometry, Sphere):
        return physx.PhysxCollisionShapeSphere(radius=geometry.radius, material=material)
    if isinstance(geometry, Hull):
        vertices = np.asarray(geometry.vertices, dtype=np.float32)
        return physx.PhysxCollisionShapeConvexMesh(
            vertices=vertices, scale=[1, 1, 1], material=material
        )
    raise TypeError(
        f"a {type(geometry).__name__} cannot collide; use Box, Cylinder, Sphere or Hull"
    )
