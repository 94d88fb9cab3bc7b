"""Convert shapes to parts: simple ones directly, the others through assets."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import trimesh

from momantu_bt.geometry import Array, Transform
from momantu_worlds.scenes.geometry.bodies import GREY
from momantu_worlds.sdf.body.parts import (
    MeshPart,
    Part,
    Rgb,
    corners_around,
    hull_of,
    plane_slab,
    simple,
)
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.mesh.assets import MOST_PIECES, Assets, mean_color, open_picture
from momantu_worlds.sdf.mesh.collada import BadMesh
from momantu_worlds.sdf.mesh.convex import convex_pieces
from momantu_worlds.sdf.mesh.files import Piece, ReadMesh, read_mesh
from momantu_worlds.sdf.mesh.reducing import count, reduced
from momantu_worlds.sdf.read.model import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    Geometry,
    MeshFile,
    Plane,
    Shape,
    Sphere,
    Vector,
)

ROUND_SIDES = 32
"""Sides of round shapes that become meshes."""
HIDDEN = 1e-4
"""Distance of a picture above the side of its box, m."""


@dataclass(slots=True)
class Shaping:
    """Converts the shapes of one import to parts. heed_up: use COLLADA's <up_axis>."""

    assets: Assets
    deviations: Deviations
    heed_up: bool = False
    _meshes: dict[MeshFile, ReadMesh | BadMesh] = field(default_factory=dict)
    _hulls: dict[tuple[Geometry, bool], tuple[list[Array], bool]] = field(default_factory=dict)

    def seen(self, shape: Shape, at: Transform, scale: Vector, subject: str) -> Iterator[Part]:
        """The parts of a visual."""
        geometry, color, picture = shape.geometry, self._color(shape), self._picture(shape, subject)
        if isinstance(geometry, Plane):
            slab, lowered = plane_slab(geometry)
            geometry, at = slab, at @ lowered
        if isinstance(geometry, Box | Cylinder | Sphere):
            solid = simple(geometry, scale)
            mean = mean_color(picture) if picture is not None else None
            yield Part(solid, at, mean or color or GREY, collision=False)
            if picture is None:
                return
            if isinstance(solid, Box):
                yield self._pictures(solid, at, picture, subject)
            else:
                self.deviations.changed(
                    shape.place, subject, "a picture on a round shape", "its mean colour is kept"
                )
            return
        pieces = self._pieces(geometry, scale, shape, subject)
        if pieces:
            if picture is not None:
                color = mean_color(picture)
                self.deviations.changed(
                    shape.place, subject, "a picture given for a mesh", "its mean colour is kept"
                )
            path = self.assets.look(_stem(geometry), self._few(pieces, shape, subject), color)
            around = corners_around(np.concatenate([piece.vertices for piece in pieces]))
            faces = np.concatenate([piece.vertices[piece.triangles] for piece in pieces])
            yield Part(MeshPart(path), at, None, collision=False, seen=around, faces=faces)

    def touched(
        self,
        shape: Shape,
        at: Transform,
        scale: Vector,
        subject: str,
        *,
        still: bool,
    ) -> Iterator[Part]:
        """The parts of a collision. still: it belongs to a static body."""
        geometry = shape.geometry
        if isinstance(geometry, Plane):
            self.deviations.changed(
                shape.place,
                subject,
                "a plane that is not the floor",
                "it ends where it is drawn to",
            )
            slab, lowered = plane_slab(geometry)
            geometry, at = slab, at @ lowered
        if isinstance(geometry, Box | Cylinder | Sphere):
            solid = simple(geometry, scale)
            assert not isinstance(solid, MeshPart)
            yield Part(solid, at, visual=False, hulls=(hull_of(solid),))
            return
        hulls = self._convex(geometry, scale, shape, subject, still)
        for first in range(0, len(hulls), MOST_PIECES):
            own = hulls[first : first + MOST_PIECES]
            path = self.assets.touch(_stem(geometry), own)
            yield Part(MeshPart(path), at, None, visual=False, hulls=tuple(own))

    def _color(self, shape: Shape) -> Rgb | None:
        color = shape.material.color
        return None if color is None else color[:3]

    def _picture(self, shape: Shape, subject: str) -> Any:
        file = shape.material.texture
        if file is None:
            return None
        picture = open_picture(file)
        if picture is None:
            self.deviations.dropped(
                shape.place, subject, f"the picture {file}", "it cannot be read; drawn in plain"
            )
        return picture

    def _pictures(self, box: Box, at: Transform, picture: Any, subject: str) -> Part:
        """The sides of a box with a picture on each, just above the box itself."""
        sides = [_side(box, axis, sign, picture) for axis in range(3) for sign in (-1, 1)]
        path = self.assets.look(subject.rpartition("/")[0], sides, None)
        return Part(MeshPart(path), at, None, collision=False)

    def _pieces(
        self, geometry: Geometry, scale: Vector, shape: Shape, subject: str
    ) -> tuple[Piece, ...]:
        """Triangles of a shape that is not simple; a deviation if there are none."""
        if not isinstance(geometry, MeshFile):
            return (_rounded(geometry, scale),)
        mesh = replace(geometry, scale=_product(geometry.scale, scale))
        found = self._read(mesh)
        if isinstance(found, BadMesh):
            self.deviations.dropped(
                shape.place, subject, f"{mesh.file}: {found}", "this shape is left out"
            )
            return ()
        if found.up:
            how = "its z is up, as in Gazebo; --heed-up-axis turns it upright"
            self.deviations.changed(
                shape.place,
                subject,
                f"{mesh.file.name} says {found.up}",
                "it is turned upright" if self.heed_up else how,
            )
        for name in found.missing:
            self.deviations.dropped(
                shape.place,
                subject,
                f"{mesh.file.name} names {name!r}, which is not there",
                "what it colours is drawn in plain",
            )
        return found.pieces

    def faces(self, geometry: MeshFile, scale: Vector) -> Array:
        """Triangles (n, 3, 3) of a mesh; none of a broken one. Nothing is listed."""
        found = self._read(replace(geometry, scale=_product(geometry.scale, scale)))
        pieces = () if isinstance(found, BadMesh) else found.pieces
        corners = [piece.vertices[piece.triangles] for piece in pieces]
        return np.concatenate(corners) if corners else np.zeros((0, 3, 3))

    def _read(self, mesh: MeshFile) -> ReadMesh | BadMesh:
        if mesh not in self._meshes:
            try:
                self._meshes[mesh] = read_mesh(mesh, heed_up=self.heed_up)
            except BadMesh as error:
                self._meshes[mesh] = error
        return self._meshes[mesh]

    def _few(self, pieces: Sequence[Piece], shape: Shape, subject: str) -> Sequence[Piece]:
        few = reduced(pieces)
        if count(few) < count(pieces):
            what = f"{count(pieces)} triangles"
            self.deviations.changed(shape.place, subject, what, f"{count(few)} are kept")
        return few

    def _convex(
        self,
        geometry: Geometry,
        scale: Vector,
        shape: Shape,
        subject: str,
        still: bool,
    ) -> list[Array]:
        pieces = self._pieces(geometry, scale, shape, subject)
        if not pieces:
            return []
        key = (
            replace(geometry, scale=scale) if isinstance(geometry, MeshFile) else geometry,
            still,
        )
        if key not in self._hulls:
            self._hulls[key] = convex_pieces(pieces, still=still)
        hulls, plain = self._hulls[key]
        if isinstance(geometry, MeshFile):
            what = f"the triangles of {geometry.file.name}"
            how = "one convex hull" if len(hulls) == 1 else f"{len(hulls)} convex pieces"
            self.deviations.changed(
                shape.place, subject, what, how if plain else f"{how}, hollow as the mesh is"
            )
        return hulls


def _product(a: Vector, b: Vector) -> Vector:
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


def _stem(geometry: Geometry) -> str:
    if isinstance(geometry, MeshFile):
        return geometry.submesh or geometry.file.stem
    return type(geometry).__name__


def _rounded(geometry: Geometry, scale: Vector) -> Piece:
    """Triangles of capsules, cones and ellipsoids, which world files do not have."""
    make = trimesh.creation
    if isinstance(geometry, Capsule):
        mesh = make.capsule(geometry.length, geometry.radius, count=(ROUND_SIDES, ROUND_SIDES))
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
    elif isinstance(geometry, Cone):
        mesh = make.cone(geometry.radius, geometry.length, sections=ROUND_SIDES)
        mesh.apply_translation(-mesh.bounds.mean(axis=0))
    elif isinstance(geometry, Ellipsoid):
        mesh = make.icosphere(subdivisions=3)
        mesh.apply_scale(geometry.radii)
    else:
        raise TypeError(f"a {type(geometry).__name__} is not a round shape")
    return Piece(np.asarray(mesh.vertices) * scale, np.asarray(mesh.faces, dtype=np.int64))


def _side(box: Box, axis: int, sign: int, picture: Any) -> Piece:
    """One side of a box as two triangles with a picture that stands upright on it."""
    normal = np.zeros(3)
    normal[axis] = sign
    up = np.array((0.0, 0.0, 1.0)) if axis < 2 else np.array((0.0, 1.0, 0.0))
    right = np.cross(up, normal)
    half = np.array(box.size) / 2.0
    middle = normal * (half[axis] + HIDDEN)
    x, y = right * (np.abs(right) @ half), up * (np.abs(up) @ half)
    corners = np.array([middle - x - y, middle + x - y, middle + x + y, middle - x + y])
    uv = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    return Piece(corners, np.array([(0, 1, 2), (0, 2, 3)]), None, uv, picture)
