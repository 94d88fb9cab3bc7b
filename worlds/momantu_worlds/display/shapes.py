"""Bodies and robot links as coloured triangle meshes, for viewers that know no simulator."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import sapien
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sapien.build.meshes import collision_mesh
from momantu_worlds.sapien.build.render_shapes import GAMMA, drawn_vertices
from momantu_worlds.scenes.geometry.bodies import Body, Mesh, Part, Picture

Rgb: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class ColoredMesh:
    """Triangles of one colour. vertices: (n, 3) m. faces: (m, 3)."""

    vertices: Array
    faces: NDArray[np.int32]
    color: Rgb


def still_meshes(bodies: Iterable[Body]) -> list[ColoredMesh]:
    """All static bodies, in the map's frame, one mesh for each colour."""
    found = []
    for body in bodies:
        for mesh in body_meshes(body):
            vertices = body.map_from_body.apply(mesh.vertices)
            found.append(ColoredMesh(vertices, mesh.faces, mesh.color))
    return merged(found)


def body_meshes(body: Body) -> list[ColoredMesh]:
    """The visual shapes of a body, in its own frame, without pictures."""
    return merged([_part_mesh(part) for part in body.parts if _has_mesh(part)])


def link_meshes(link: Any) -> list[ColoredMesh]:
    """The visual shapes of a robot's link, in the link's frame."""
    look = link.entity.find_component_by_type(sapien.render.RenderBodyComponent)
    return merged(list(_render_meshes(look))) if look is not None else []


def merged(meshes: Iterable[ColoredMesh]) -> list[ColoredMesh]:
    """The same triangles, merged into one mesh per colour."""
    by_color: dict[Rgb, list[ColoredMesh]] = {}
    for mesh in meshes:
        by_color.setdefault(mesh.color, []).append(mesh)
    return [_joined(color, group) for color, group in by_color.items()]


def _joined(color: Rgb, meshes: list[ColoredMesh]) -> ColoredMesh:
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + first for mesh, first in zip(meshes, firsts, strict=True)]
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    return ColoredMesh(vertices, np.concatenate(faces).astype(np.int32), color)


def _has_mesh(part: Part) -> bool:
    return part.visual and not isinstance(part.geometry, Picture)


def _part_mesh(part: Part) -> ColoredMesh:
    geometry = part.geometry
    if isinstance(geometry, Mesh):
        vertices, faces = geometry.vertices, geometry.triangles
    else:
        vertices, faces = collision_mesh(geometry)
    return ColoredMesh(part.body_from_part.apply(vertices), faces, _rgb(part.color))


def _render_meshes(look: Any) -> Iterator[ColoredMesh]:
    for shape in look.render_shapes:
        for part, vertices in zip(shape.parts, drawn_vertices(shape), strict=True):
            # the shader's colours are of light, a browser's of a screen
            light = [float(channel) ** (1 / GAMMA) for channel in part.material.base_color[:3]]
            yield ColoredMesh(vertices, np.asarray(part.triangles), _rgb(light))


def _rgb(color: Iterable[float]) -> Rgb:
    red, green, blue = (round(255 * min(1.0, max(0.0, channel))) for channel in color)
    return red, green, blue
