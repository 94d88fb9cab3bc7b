"""Mesh files as SDF uses them: COLLADA, STL, OBJ and glTF, upright, in metres, at their scale."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_worlds.sdf.mesh.collada import Z_FROM, BadMesh, ColladaNotes, collada_notes
from momantu_worlds.sdf.mesh.companions import Companions
from momantu_worlds.sdf.read.model import MeshFile

ENDINGS = (".dae", ".stl", ".obj", ".glb", ".gltf", ".ply")
MOST_BYTES = 64_000_000
MOST_TRIANGLES_READ = 5_000_000
FARTHEST = 1e4
"""Largest coordinate of a mesh, m; a larger one means a wrong unit."""
MOST_NAMED = 12


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """Triangles with one material. vertices (n, 3) m; triangles (m, 3); uv (n, 2) with its picture.

    color: red, green, blue in 0..1; None if the file gives none.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    color: tuple[float, float, float] | None = None
    uv: Array | None = None
    picture: Any = None


@dataclass(frozen=True, slots=True)
class ReadMesh:
    """A mesh as a shape uses it.

    up: the up axis in the file, if it is not z. missing: files that it names and that do not exist.
    """

    pieces: tuple[Piece, ...]
    up: str = ""
    missing: tuple[str, ...] = ()


def read_mesh(mesh: MeshFile, *, heed_up: bool = False) -> ReadMesh:
    """The pieces of a mesh in its shape's frame.

    heed_up: turn COLLADA upright by its <up_axis>. Gazebo does not, and many of the meshes made
    for it say Y_UP where z is up.

    Raises:
        BadMesh: the file is broken, too large, of a kind that is not read, or has no such submesh.
    """
    ending = mesh.file.suffix.lower()
    if ending not in ENDINGS:
        raise BadMesh(f"files that end with {ending!r} are not read; endings: {', '.join(ENDINGS)}")
    try:
        size = mesh.file.stat().st_size
        if size > MOST_BYTES:
            raise BadMesh(f"it has {size} bytes; at most {MOST_BYTES} are read")
        notes = collada_notes(mesh.file) if ending == ".dae" else ColladaNotes()
    except OSError as error:
        raise BadMesh(f"it cannot be read: {error.strerror}") from None
    companions = Companions(mesh.file)
    pieces = [piece for name, piece in _load(mesh, companions) if _wanted(name, mesh, notes)]
    if not pieces:
        raise BadMesh(_nothing(mesh, notes))
    up = "Z_UP"
    if ending in (".glb", ".gltf"):
        up = "Y_UP"  # glTF 2.0 knows no other, and Gazebo turns it
    elif heed_up and notes.up:
        up = notes.up
    other_up = notes.up if notes.up != "Z_UP" else ""
    return ReadMesh(
        _shaped(pieces, Z_FROM[up] * notes.meter, mesh), other_up, tuple(companions.missing)
    )


def _load(mesh: MeshFile, companions: Companions) -> list[tuple[str, Piece]]:
    options: dict[str, Any] = {"process": False, "resolver": companions}
    if mesh.file.suffix.lower() == ".obj" and mesh.submesh:
        options |= {"split_objects": True, "split_groups": True}
    try:
        scene = trimesh.load_scene(mesh.file, **options)
        found = [
            (str(name), _piece(scene.geometry[name], matrix))
            for node in scene.graph.nodes_geometry
            for matrix, name in (scene.graph[node],)
            if len(getattr(scene.geometry[name], "faces", ()))
        ]
    except Exception as error:  # readers of half a dozen formats raise what they like
        raise BadMesh(f"it cannot be read: {type(error).__name__}: {error}") from None
    triangles = sum(len(piece.triangles) for _, piece in found)
    if triangles > MOST_TRIANGLES_READ:
        raise BadMesh(f"it has {triangles} triangles; at most {MOST_TRIANGLES_READ} are read")
    return found


def _piece(mesh: Any, matrix: Array) -> Piece:
    vertices = np.asarray(mesh.vertices, dtype=np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    triangles = np.asarray(mesh.faces, dtype=np.int64)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    if not np.isfinite(vertices).all():
        raise ValueError("it has vertices that are not numbers")
    visual = mesh.visual
    material, uv = getattr(visual, "material", None), getattr(visual, "uv", None)
    picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if picture is not None and uv is not None and len(uv) == len(vertices):
        return Piece(vertices, triangles, None, np.asarray(uv, dtype=np.float64), picture)
    return Piece(vertices, triangles, _color(visual, material))


def _color(visual: Any, material: Any) -> tuple[float, float, float] | None:
    """The one colour of a piece; of coloured vertices, their mean."""
    if material is not None:
        main = getattr(material, "main_color", None)
    else:
        main = visual.vertex_colors.mean(axis=0) if visual.defined else None
    if main is None:
        return None
    red, green, blue = (float(np.clip(channel / 255.0, 0.0, 1.0)) for channel in main[:3])
    return red, green, blue


def _wanted(name: str, mesh: MeshFile, notes: ColladaNotes) -> bool:
    """Whether a geometry belongs to the submesh; second ones of a name carry a number behind it."""
    if not mesh.submesh:
        return True
    if mesh.file.suffix.lower() == ".obj":  # named object_group_material
        return f"_{mesh.submesh}_" in f"_{name}_"
    names = notes.names.get(mesh.submesh, {mesh.submesh})
    return name in names or name.rpartition("_")[0] in names


def _nothing(mesh: MeshFile, notes: ColladaNotes) -> str:
    if not mesh.submesh:
        return "it holds no triangles"
    having = ", ".join([name for name in notes.names if name][:MOST_NAMED])
    return f"it has no submesh {mesh.submesh!r}" + (f"; it has: {having}" if having else "")


def _shaped(pieces: list[Piece], turn: Array, mesh: MeshFile) -> tuple[Piece, ...]:
    """Pieces turned, centred and scaled."""
    vertices = [piece.vertices @ turn.T for piece in pieces]
    everything = np.concatenate(vertices)
    low, high = everything.min(axis=0), everything.max(axis=0)
    middle = (low + high) / 2 if mesh.center else np.zeros(3)
    scale = np.array(mesh.scale)
    if np.abs(np.stack([low, high]) * scale).max() > FARTHEST:
        raise BadMesh(f"it reaches farther than {FARTHEST:g} m; is its unit or its <scale> right?")
    shaped = []
    for piece, own in zip(pieces, vertices, strict=True):
        triangles = piece.triangles if scale.prod() > 0.0 else piece.triangles[:, ::-1]
        shaped.append(
            replace(copy.copy(piece), vertices=(own - middle) * scale, triangles=triangles)
        )
    return tuple(shaped)
