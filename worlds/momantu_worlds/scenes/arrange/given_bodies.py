"""Bodies that a world file gives part by part."""

from __future__ import annotations

from collections.abc import Iterator

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.arrange.mesh_files import mesh_parts
from momantu_worlds.scenes.file.bodies import BodyNote, BodyPart
from momantu_worlds.scenes.file.values import pose2d, transform
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.geometry.bodies import (
    Body,
    BodyTop,
    Box,
    Cylinder,
    Geometry,
    Part,
    Sphere,
)


def given_bodies(world: WorldFile) -> Iterator[Body]:
    """Every body of the section `bodies`.

    Raises:
        WorldError: a mesh file cannot be read.
    """
    for name, note in world.bodies.items():
        yield _body(world, name, note)


def _body(world: WorldFile, name: str, note: BodyNote) -> Body:
    map_from_body = transform(note.at)
    return Body(
        name,
        note.category,
        map_from_body,
        tuple(part for given in note.parts for part in _parts(world, given)),
        static=note.static,
        mass=note.mass or 0.0,
        friction=note.friction,
        top=_top(note, map_from_body),
    )


def _top(note: BodyNote, map_from_body: Transform) -> BodyTop | None:
    if note.surface is None:
        return None
    map_from_top = pose2d(note.surface.at).transform(note.surface.height)
    return BodyTop(map_from_body.inverse() @ map_from_top, note.surface.size, note.surface.round)


def _parts(world: WorldFile, given: BodyPart) -> Iterator[Part]:
    body_from_part = transform(given.at)
    if given.mesh is None:
        yield Part(_shape(given), body_from_part, given.color, given.visual, given.collision)
        return
    color = given.color if "color" in given.model_fields_set else None
    for part in mesh_parts(given.mesh, world.beside(given.mesh.file), standing=False, color=color):
        if (part.visual and given.visual) or (part.collision and given.collision):
            at = body_from_part @ part.body_from_part
            yield Part(part.geometry, at, part.color, part.visual, part.collision)


def _shape(given: BodyPart) -> Geometry:
    if given.box is not None:
        return Box(given.box)
    if given.cylinder is not None:
        return Cylinder(given.cylinder.radius, given.cylinder.height)
    assert given.sphere is not None
    return Sphere(given.sphere)
