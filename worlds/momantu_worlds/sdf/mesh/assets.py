"""Meshes as GLB files beside the world file, named after their content."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image

from momantu_bt.formats.files import write_whole
from momantu_bt.geometry import Array
from momantu_worlds.scenes.geometry.hulls import hull_mesh
from momantu_worlds.sdf.mesh.files import Piece

MOST_PIXELS = 1024
"""Longest edge of a picture, pixels: more is not visible to a camera of 640 x 480."""
MOST_PIECES = 200
"""Most convex pieces of one file; the reader of world files merges more into one."""
_STEM = 40


_untyped: Any = trimesh
"""trimesh without types, for attributes that it does not declare."""


@dataclass(slots=True)
class Assets:
    """The files of one import, kept in memory until the whole import has succeeded.

    folder: its name in the world file, relative to that file.
    """

    folder: str
    _files: dict[str, bytes] = field(default_factory=dict)

    def look(self, name: str, pieces: Sequence[Piece], color: tuple[float, ...] | None) -> str:
        """Add a visual file; color: instead of the pieces' own. Returns its path."""
        return self._keep(name, [_seen(piece, color) for piece in pieces])

    def touch(self, name: str, hulls: Sequence[Array]) -> str:
        """Add a collision file of at most MOST_PIECES convex pieces, each of points (n, 3)."""
        return self._keep(f"{name}_touch", [_touched(hull) for hull in hulls])

    def write(self, beside: Path) -> int:
        """Write everything below the folder of `beside`; returns how many files.

        Raises:
            OutputError: it cannot be written there.
        """
        for path, content in self._files.items():
            write_whole(beside.parent / path, content, folders=True)
        return len(self._files)

    def _keep(self, name: str, meshes: Sequence[Any]) -> str:
        scene = _untyped.Scene()
        for number, mesh in enumerate(meshes):
            scene.add_geometry(mesh, node_name=f"piece_{number:04}", geom_name=f"piece_{number:04}")
        content = bytes(scene.export(file_type="glb"))
        digest = hashlib.blake2b(content, digest_size=8).hexdigest()
        stem = re.sub(r"[^a-z0-9_]+", "_", name.lower()).strip("_")[:_STEM] or "mesh"
        path = f"{self.folder}/{stem}-{digest}.glb"
        self._files[path] = content
        return path


def _touched(points: Array) -> Any:
    hull = hull_mesh(points)
    return trimesh.Trimesh(hull.vertices, hull.triangles, process=False)


def _seen(piece: Piece, color: tuple[float, ...] | None) -> Any:
    chosen = color or piece.color
    material = _untyped.visual.material.PBRMaterial(metallicFactor=0.0, roughnessFactor=1.0)
    if color is None and piece.picture is not None:
        material.baseColorTexture = small_picture(piece.picture)
    elif chosen is not None:
        material.baseColorFactor = np.array([*(round(255 * c) for c in chosen[:3]), 255], np.uint8)
    uv = None if piece.uv is None else piece.uv
    visual = _untyped.visual.TextureVisuals(uv=uv, material=material)
    return trimesh.Trimesh(piece.vertices, piece.triangles, visual=visual, process=False)


def small_picture(picture: Any) -> Any:
    """A picture (PIL) in RGB, reduced to the largest useful size."""
    small = picture.convert("RGB")
    small.thumbnail((MOST_PIXELS, MOST_PIXELS))
    return small


def open_picture(file: Path) -> Any:
    """Open a picture file; None if it cannot be read as a picture."""
    try:
        with Image.open(file) as picture:
            return small_picture(picture)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None


def mean_color(picture: Any) -> tuple[float, float, float]:
    """The mean colour of a picture, 0..1."""
    red, green, blue = np.asarray(picture, dtype=np.float64).reshape(-1, 3).mean(axis=0) / 255.0
    return float(red), float(green), float(blue)
