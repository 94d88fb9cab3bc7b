"""The floor of a world: the plane, slab or mesh that everything stands on; it becomes z = 0."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.sdf.body.frames import PlacedLink, PlacedModel
from momantu_worlds.sdf.body.parts import Rgb
from momantu_worlds.sdf.body.placing import placed_in_link
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.mesh.assets import mean_color, open_picture
from momantu_worlds.sdf.read.model import Box, MeshFile, Plane, Shape, Vector

LEVEL = 0.9998
"""Least cosine between a floor's normal and the world's vertical: one degree."""
SLAB_SHARE = 0.6
"""Least share of the world's area that a slab must cover to be the floor."""
SLAB_LEAST = 4.0
"""Least area of such a slab, m2."""
STEP = 0.5
"""A slab that is higher than this above the lowest floor is a ceiling or a stage, m."""
CLOSE = 0.002
"""Floors within this height difference are one, m."""
LAYER = 0.005
"""Level triangles of a mesh within this height difference are one floor, m."""
SHOWN = 0.005
"""How far a mesh that is the floor lies above z = 0, m, so that it is seen."""
Faces: TypeAlias = Callable[[MeshFile, Vector], Array]
"""Triangles (n, 3, 3) of a mesh at a scale."""


@dataclass(frozen=True, slots=True)
class Ground:
    """height: of the floor in the SDF world, m. shapes: the floor's shapes, by identity."""

    height: float = 0.0
    shapes: frozenset[tuple[int, int]] = frozenset()
    color: Rgb | None = None
    friction: float | None = None

    def is_floor(self, placed: PlacedLink, shape: Shape) -> bool:
        """Whether a shape of a link is part of the floor."""
        return (id(placed), id(shape)) in self.shapes


@dataclass(frozen=True, slots=True)
class _Level:
    """A level upper face. area: m2; infinite for a plane.

    Of a mesh it is the widest one; the mesh stays a body, as it may have walls too.
    """

    height: float
    area: float
    placed: PlacedLink
    shape: Shape
    touched: bool

    @property
    def meshed(self) -> bool:
        """Whether it is a mesh's."""
        return isinstance(self.shape.geometry, MeshFile)


def find_ground(models: Iterable[PlacedModel], faces: Faces, deviations: Deviations) -> Ground:
    """The floor of a world, listed; z = 0 when it has none. faces: reads meshes."""
    owners = [one for model in models for one in model.everything()]
    levels = list(_levels(owners, faces))
    slab = max(SLAB_SHARE * _area_of(owners), SLAB_LEAST)
    wide = [level for level in levels if level.touched and level.area >= slab]
    if not wide:
        return Ground()
    lowest = min(level.height for level in wide)
    height = _height([level for level in wide if level.height <= lowest + STEP])
    floors = [
        level
        for level in levels
        if lowest - STEP <= level.height <= height + CLOSE and level.area >= slab
    ]
    for level in floors:
        _list(level, height, deviations)
    floors = [level for level in floors if not level.meshed]
    seen = [_color(level.shape) for level in reversed(floors) if not level.touched]
    frictions = [level.shape.friction for level in floors if level.shape.friction is not None]
    return Ground(
        height,
        frozenset((id(level.placed), id(level.shape)) for level in floors),
        next((color for color in seen if color is not None), None),
        min(frictions, default=None),
    )


def _height(near: list[_Level]) -> float:
    """The height that becomes z = 0: of the highest floor; a mesh lies just above it."""
    plain = [level.height for level in near if not level.meshed]
    base = max(plain, default=0.0)
    meshed = max((level.height for level in near if level.meshed), default=base)
    above = meshed > base + CLOSE or (not plain and meshed < -CLOSE)
    return meshed - SHOWN if above else base


def _list(level: _Level, height: float, deviations: Deviations) -> None:
    """Say what becomes of a floor."""
    if not level.touched:
        return
    subject = f"{level.placed.subject}/{level.shape.name}"
    kind = type(level.shape.geometry).__name__.lower().replace("meshfile", "mesh")
    how = "it is the floor"
    if level.height < height - CLOSE:
        how = f"it is left out: the floor lies {height - level.height:.3f} m above it"
    elif abs(height) > CLOSE:
        how = f"it is the floor; it is at z = {level.height:g} m and becomes z = 0"
    elif not isinstance(level.shape.geometry, Box):
        return
    deviations.changed(level.shape.place, subject, f"a {kind}", how)


def _levels(owners: Iterable[PlacedModel], faces: Faces) -> Iterator[_Level]:
    """Upper faces of level planes and boxes, and of touched meshes, of all static models."""
    for owner in owners:
        for placed in owner.links if owner.model.static else ():
            shapes = [(shape, True) for shape in placed.link.collisions]
            shapes += [(shape, False) for shape in placed.link.visuals]
            for shape, touched in shapes:
                at = placed_in_link(owner, placed, shape.pose)
                level = _upper_side(shape, at, placed)
                if touched and isinstance(shape.geometry, MeshFile):
                    level = _widest(at.apply(faces(shape.geometry, placed.scale).reshape(-1, 3)))
                if level is not None:
                    yield _Level(*level, placed, shape, touched)


def _upper_side(shape: Shape, at: Transform, placed: PlacedLink) -> tuple[float, float] | None:
    """Height and area of a level upper face."""
    if isinstance(shape.geometry, Plane):
        normal = np.array(shape.geometry.normal) / np.linalg.norm(shape.geometry.normal)
        if float((at.rotation @ normal)[2]) < LEVEL:
            return None
        return float(at.position[2]), np.inf
    if isinstance(shape.geometry, Box):
        upright = np.abs(at.rotation[2])
        axis = int(np.argmax(upright))
        if upright[axis] < LEVEL:
            return None
        size = np.array(shape.geometry.size) * placed.scale
        return float(at.position[2] + size[axis] / 2), float(np.delete(size, axis).prod())
    return None


def _widest(corners: Array) -> tuple[float, float] | None:
    """Height and area of the widest level face among triangles, corners (3 n, 3); None if none."""
    triangles = corners.reshape(-1, 3, 3)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2
    level = normals[:, 2] > LEVEL * 2 * areas
    if not level.any():
        return None
    heights = triangles[level, :, 2].mean(axis=1)
    layers, layer = np.unique(np.round(heights / LAYER).astype(np.int64), return_inverse=True)
    sums = np.bincount(layer.ravel(), weights=areas[level], minlength=len(layers))
    widest = int(np.argmax(sums))
    return float(np.median(heights[layer.ravel() == widest])), float(sums[widest])


def _area_of(owners: Iterable[PlacedModel]) -> float:
    """Area of the rectangle around all links and boxes, m2."""
    points: list[Array] = []
    for owner in owners:
        for placed in owner.links:
            for shape in placed.link.collisions:
                if isinstance(shape.geometry, Plane):
                    continue
                at = placed_in_link(owner, placed, shape.pose)
                half = np.zeros(3)
                if isinstance(shape.geometry, Box):
                    half = np.abs(at.rotation) @ (np.array(shape.geometry.size) / 2)
                points += [at.position - half, at.position + half]
    return float(np.ptp(np.array(points)[:, :2], axis=0).prod()) if points else 0.0


def _color(shape: Shape) -> Rgb | None:
    if shape.material.texture is not None:
        picture = open_picture(shape.material.texture)
        if picture is not None:
            return mean_color(picture)
    return None if shape.material.color is None else shape.material.color[:3]
