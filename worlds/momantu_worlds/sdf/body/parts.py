"""Shapes of SDF as parts of a world file's bodies."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_worlds.scenes.geometry.bodies import GREY
from momantu_worlds.sdf.read.model import Box, Cylinder, Plane, Sphere

Rgb: TypeAlias = tuple[float, float, float]
SIDES = 24
"""Sides of the prism around a cylinder, and of rings around round shapes."""
THINNEST = 1e-5
"""Least size, m, as values are written with six decimals and must stay above zero."""
SLAB = 0.01
"""Thickness of a plane that is not the floor, m."""
_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SAME = 1e-6
"""Tolerance within which shapes are at the same pose, m and rad."""


@dataclass(frozen=True, slots=True)
class MeshPart:
    """A mesh of the assets. pieces: its collision shapes, points (n, 3) each."""

    path: str


Solid: TypeAlias = Box | Cylinder | Sphere | MeshPart


@dataclass(frozen=True, slots=True)
class Part:
    """One part of a body, in its own frame.

    hulls: convex points (n, 3) of all collision shapes. seen: corners (8, 3) around a visual mesh.
    faces: triangles (n, 3, 3) of a visual mesh.
    """

    solid: Solid
    body_from_part: Transform
    color: Rgb | None = GREY
    visual: bool = True
    collision: bool = True
    hulls: tuple[Array, ...] = field(default=(), compare=False)
    seen: Array | None = field(default=None, compare=False)
    faces: Array | None = field(default=None, compare=False)


def simple(shape: Box | Cylinder | Sphere, scale: tuple[float, float, float]) -> Solid:
    """A shape that world files have too, scaled; a round shape stays round."""
    x, y, z = scale
    if isinstance(shape, Box):
        a, b, c = shape.size
        return Box((max(a * x, THINNEST), max(b * y, THINNEST), max(c * z, THINNEST)))
    if isinstance(shape, Cylinder):
        radius, length = shape.radius * max(x, y), shape.length * z
        return Cylinder(max(radius, THINNEST), max(length, THINNEST))
    return Sphere(max(shape.radius * max(x, y, z), THINNEST))


def corners_around(points: Array) -> Array:
    """Corners (8, 3) of the box around points (n, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.asarray(np.where(_CORNERS > 0.0, high, low))


def hull_of(solid: Box | Cylinder | Sphere) -> Array:
    """Points (n, 3) around a simple solid."""
    if isinstance(solid, Box):
        return np.asarray(_CORNERS * solid.size / 2.0)
    if isinstance(solid, Cylinder):
        return np.concatenate(
            [_ring(solid.radius, z) for z in (-solid.length / 2, solid.length / 2)]
        )
    heights = np.linspace(-1.0, 1.0, 9) * solid.radius
    rings = [_ring(math.sqrt(max(solid.radius**2 - z * z, 0.0)), z) for z in heights]
    return np.concatenate(rings)


def _ring(radius: float, z: float) -> Array:
    turns = np.arange(SIDES) * (2.0 * math.pi / SIDES)
    return np.stack([radius * np.cos(turns), radius * np.sin(turns), np.full(SIDES, z)], axis=1)


def plane_slab(plane: Plane) -> tuple[Box, Transform]:
    """A plane as a thin box below it, and the pose of the box in the plane's frame."""
    normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
    axis = np.cross((0.0, 0.0, 1.0), normal)
    angle = math.atan2(float(np.linalg.norm(axis)), float(normal[2]))
    turn = quaternion_from_axis_angle(axis if np.linalg.norm(axis) > SAME else (1, 0, 0), angle)
    lowered = Transform((0, 0, 0), turn) @ Transform((0.0, 0.0, -SLAB / 2))
    return Box((*plane.size, SLAB)), lowered


def joined(parts: Iterable[Part]) -> Iterator[Part]:
    """The parts, with a visual and a collision part merged if their shapes agree."""
    waiting = list(parts)
    touched = [part for part in waiting if part.collision and not part.visual]
    for part in waiting:
        if part.visual and part.collision:
            yield part
        elif part.visual:
            twin = next((other for other in touched if _same(part, other)), None)
            if twin is not None:
                touched.remove(twin)
                part = replace(part, collision=True, hulls=twin.hulls)
            yield part
    yield from touched


def _same(a: Part, b: Part) -> bool:
    step = a.body_from_part.inverse() @ b.body_from_part
    near = float(np.abs(step.position).max()) < SAME and step.angle_to(Transform()) < SAME
    return near and not isinstance(a.solid, MeshPart) and a.solid == b.solid
