"""Bodies that a world file gives part by part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

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
from momantu_worlds.scenes.geometry.prisms import body_points


def given_bodies(world: WorldFile) -> Iterator[Body]:
    """Every body of the section `bodies`.

    Raises:
        WorldError: a mesh file cannot be read.
    """
    for name, note in world.bodies.items():
        yield _body(world, name, note)


def _body(world: WorldFile, name: str, note: BodyNote) -> Body:
    map_from_body = transform(note.at)
    body = Body(
        name,
        note.category,
        map_from_body,
        tuple(part for given in note.parts for part in _parts(world, given)),
        static=note.static,
        mass=note.mass or 0.0,
        friction=note.friction,
        top=_top(note, map_from_body),
    )
    return body if note.static else replace(body, foot=_foot(body))


def _foot(body: Body) -> Transform | None:
    """`body_from_foot`: its file may put the origin anywhere, so the box around it says it."""
    points = body_points(body)
    if points is None:
        return None
    (x, y, z), (far_x, far_y, _) = points.min(axis=0), points.max(axis=0)
    return Transform(((x + far_x) / 2, (y + far_y) / 2, z))


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
