"""The floor of a world: the plane or slab that everything stands on; it becomes z = 0."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.sdf.body.frames import PlacedLink, PlacedModel
from momantu_worlds.sdf.body.parts import Rgb
from momantu_worlds.sdf.body.placing import placed_in_link
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.mesh.assets import mean_color, open_picture
from momantu_worlds.sdf.read.model import Box, Plane, Shape

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
    """A level upper face. area: m2; infinite for a plane."""

    height: float
    area: float
    placed: PlacedLink
    shape: Shape
    touched: bool


def find_ground(models: Iterable[PlacedModel], deviations: Deviations) -> Ground:
    """The floor of a world, listed; z = 0 when it has none."""
    owners = [one for model in models for one in model.everything()]
    levels = list(_levels(owners))
    slab = max(SLAB_SHARE * _area_of(owners), SLAB_LEAST)
    wide = [level for level in levels if level.touched and level.area >= slab]
    if not wide:
        return Ground()
    lowest = min(level.height for level in wide)
    height = max(level.height for level in wide if level.height <= lowest + STEP)
    floors = [
        level
        for level in levels
        if lowest - STEP <= level.height <= height + CLOSE and level.area >= slab
    ]
    for level in floors:
        if level.touched and (isinstance(level.shape.geometry, Box) or abs(height) > CLOSE):
            moved = f"; it is at z = {height:g} m and becomes z = 0" if abs(height) > CLOSE else ""
            subject = f"{level.placed.subject}/{level.shape.name}"
            kind = type(level.shape.geometry).__name__.lower()
            deviations.changed(level.shape.place, subject, f"a {kind}", f"it is the floor{moved}")
    seen = [_color(level.shape) for level in reversed(floors) if not level.touched]
    frictions = [level.shape.friction for level in floors if level.shape.friction is not None]
    return Ground(
        height,
        frozenset((id(level.placed), id(level.shape)) for level in floors),
        next((color for color in seen if color is not None), None),
        min(frictions, default=None),
    )


def _levels(owners: Iterable[PlacedModel]) -> Iterator[_Level]:
    """Upper faces of level planes and boxes of all static models."""
    for owner in owners:
        for placed in owner.links if owner.model.static else ():
            shapes = [(shape, True) for shape in placed.link.collisions]
            shapes += [(shape, False) for shape in placed.link.visuals]
            for shape, touched in shapes:
                at = placed_in_link(owner, placed, shape.pose)
                level = _upper_side(shape, at, placed)
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
