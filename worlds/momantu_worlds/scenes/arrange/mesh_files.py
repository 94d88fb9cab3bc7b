"""Mesh files as parts of bodies: their visual and collision shapes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_bt.world import WorldError
from momantu_worlds.scenes.file.furniture import MeshUse
from momantu_worlds.scenes.geometry.bodies import GREY, Box, Color, Hull, Mesh, Part

with lazily():
    import trimesh

MOST_BYTES = 100_000_000
MOST_TRIANGLES = 1_000_000
MOST_PIECES = 200
"""Most convex pieces from one file; with more parts the whole file becomes one piece."""
HULL_POINTS = 60
"""Most points of a convex piece; few, so that collision detection is fast."""
CACHED = 256
"""Number of meshes in the memory cache: a world uses each several times in one episode."""
FLAT = 1e-4
"""Least thickness of a piece, m; a thinner one is thickened, as a convex body needs a volume."""
Z_FROM_Y = np.array([(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)])
"""Rotation from a mesh with y up to z up."""


class MeshError(WorldError):
    """A mesh file of a world cannot be used; the message says why."""


@dataclass(frozen=True, slots=True, eq=False)
class MeshPiece:
    """One part of a mesh file with its own colour; texture: (h, w, 3) uint8 with uv (n, 2)."""

    vertices: Array
    triangles: NDArray[np.int32]
    color: Color
    uv: Array | None = None
    texture: NDArray[np.uint8] | None = None


def mesh_parts(
    use: MeshUse, file: Path, *, standing: bool, color: Color | None
) -> tuple[Part, ...]:
    """The parts that a mesh is made of.

    standing: it is moved so that it stands on z = 0 with its middle above the origin, as furniture
    does. color: instead of its own.

    Raises:
        MeshError: the file cannot be read, is too large, or holds no triangles.
    """
    return _parts(use, _state(file), standing, color)


def mesh_size(use: MeshUse, file: Path) -> tuple[float, float, float]:
    """Extents of the mesh as used, m; raises as `mesh_parts`."""
    return use.size if use.size is not None else _size(use, _state(file))


@dataclass(frozen=True, slots=True)
class _State:
    """Cache key of a mesh file; it changes when the file is edited."""

    file: Path
    changed: int
    size: int


@lru_cache(maxsize=CACHED)
def _parts(use: MeshUse, state: _State, standing: bool, color: Color | None) -> tuple[Part, ...]:
    pieces = _placed(use, state, standing)
    seen = [
        Part(Mesh(vertices, p.triangles, p.uv, p.texture), color=color or p.color, collision=False)
        for p, vertices in pieces
    ]
    points = [vertices for _, vertices in pieces]
    return (*seen, *_touched(use.collision, points))


@lru_cache(maxsize=CACHED)
def _size(use: MeshUse, state: _State) -> tuple[float, float, float]:
    x, y, z = np.ptp(np.concatenate([v for _, v in _placed(use, state, standing=True)]), axis=0)
    return float(x), float(y), float(z)


def _touched(how: str, points: list[Array]) -> list[Part]:
    everything = np.concatenate(points)
    if how == "none":
        return []
    if how == "box":
        low, high = everything.min(axis=0), everything.max(axis=0)
        x, y, z = (max(float(edge), FLAT) for edge in high - low)
        return [Part(Box((x, y, z)), Transform((low + high) / 2), visual=False)]
    groups = points if how == "parts" and len(points) <= MOST_PIECES else [everything]
    return [Part(Hull(hull_points(group)), visual=False) for group in groups]


def hull_points(points: Array) -> Array:
    """At most HULL_POINTS (n, 3) with nearly the same convex hull as the points; never flat."""
    low, high = points.min(axis=0), points.max(axis=0)
    thin = high - low < FLAT
    if thin.any():
        points = np.concatenate([points - FLAT / 2 * thin, points + FLAT / 2 * thin])
    if len(points) <= HULL_POINTS:
        return points
    directions = _spread(HULL_POINTS)
    extent = np.maximum(high - low, FLAT)
    picked = np.unique(np.argmax((points / extent) @ directions.T, axis=0))
    return np.asarray(points[picked])


def _spread(count: int) -> Array:
    """Unit vectors (count, 3) spread evenly: the corners of a cube, then a spiral."""
    cube = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3.0)
    turns = np.arange(count - 8) + 0.5
    z = 1.0 - 2.0 * turns / (count - 8)
    angle = np.pi * (1.0 + np.sqrt(5.0)) * turns
    ring = np.sqrt(1.0 - z * z)
    return np.concatenate([cube, np.column_stack([ring * np.cos(angle), ring * np.sin(angle), z])])


def _placed(use: MeshUse, state: _State, standing: bool) -> list[tuple[MeshPiece, Array]]:
    """Each piece, and its vertices in the world, m."""
    pieces = _read(state)
    turn = Z_FROM_Y if use.up == "y" else np.eye(3)
    turned = [use.scale * (piece.vertices @ turn.T) for piece in pieces]
    everything = np.concatenate(turned)
    low, high = everything.min(axis=0), everything.max(axis=0)
    factor = np.ones(3)
    if use.size is not None:
        factor = np.array(use.size) / np.maximum(high - low, FLAT)
    foot = np.array([*((low + high) / 2)[:2], low[2]]) if standing else np.zeros(3)
    return [(p, (v - foot) * factor) for p, v in zip(pieces, turned, strict=True)]


def _state(file: Path) -> _State:
    try:
        stat = file.stat()
    except OSError as error:
        raise MeshError(f"the mesh file {file} cannot be read: {error.strerror}") from error
    if stat.st_size > MOST_BYTES:
        raise MeshError(f"the mesh file {file} has {stat.st_size} bytes; at most {MOST_BYTES}")
    return _State(file, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=CACHED)
def _read(state: _State) -> tuple[MeshPiece, ...]:
    """The pieces of a mesh file, in its own frame and units."""
    file = state.file
    try:
        scene = trimesh.load_scene(file, process=False)
        pieces = tuple(_pieces(scene))
    except Exception as error:  # readers of a dozen formats, which raise what they like
        message = f"the mesh file {file} cannot be read: {type(error).__name__}: {error}"
        raise MeshError(message) from error
    triangles = sum(len(piece.triangles) for piece in pieces)
    if triangles == 0:
        raise MeshError(f"the mesh file {file} holds no triangles")
    if triangles > MOST_TRIANGLES:
        raise MeshError(f"the mesh file {file} has {triangles} triangles; at most {MOST_TRIANGLES}")
    return pieces


def _pieces(scene: Any) -> list[MeshPiece]:
    found = []
    for node in sorted(scene.graph.nodes_geometry):
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        faces = getattr(mesh, "faces", None)
        if faces is None or len(faces) == 0:
            continue
        vertices = np.asarray(mesh.vertices) @ matrix[:3, :3].T + matrix[:3, 3]
        if not np.isfinite(vertices).all():
            raise ValueError("it has vertices that are not numbers")
        mirrored = np.linalg.det(matrix[:3, :3]) < 0
        triangles = np.asarray(faces[:, ::-1] if mirrored else faces, dtype=np.int32)
        color, uv, texture = _look(mesh)
        found.append(MeshPiece(vertices, triangles, color, uv, texture))
    return found


def _look(mesh: Any) -> tuple[Color, Array | None, NDArray[np.uint8] | None]:
    """Colour, and texture coordinates with their image if there is one."""
    visual = mesh.visual
    uv = getattr(visual, "uv", None)
    material = getattr(visual, "material", None)
    picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if uv is not None and picture is not None and len(uv) == len(mesh.vertices):
        return GREY, np.asarray(uv), np.asarray(picture.convert("RGB"), dtype=np.uint8)
    main = getattr(material, "main_color", None)
    if main is None:
        main = getattr(visual, "main_color", None)
    if main is None:
        return GREY, None, None
    red, green, blue = (float(channel) / 255.0 for channel in main[:3])
    return (red, green, blue), None, None
