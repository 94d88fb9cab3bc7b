"""Convex cells of a concave mesh, cut along planes; they are kept in the user's cache.

Cutting loads trimesh, which takes longer than building a robot.
"""

from __future__ import annotations

import hashlib
import io
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.cache import cache_subfolder
from momantu_bt.formats.files import OutputError, write_whole
from momantu_bt.lazy import lazily
from momantu_bt.robot import Cuts

with lazily():
    import trimesh

CRUMB = 1e-5
"""Least volume of a hull, m3; smaller ones are slivers along a cut."""


def convex_cells(path: str, cuts: Cuts) -> list[NDArray[np.float32]]:
    """Vertices (n, 3) of the convex hull of each cell of the mesh in a file."""
    with suppress(OSError, ValueError, BadZipFile):
        return _read(_cache_file(path, cuts))
    cells = _cut(path, cuts)
    with suppress(OSError, OutputError):
        content = io.BytesIO()
        np.savez(content, *cells)
        write_whole(_cache_file(path, cuts), content.getvalue())
    return cells


def _cache_file(path: str, cuts: Cuts) -> Path:
    """A name for what the present code and libraries make of the present file."""
    hashed = hashlib.blake2b(Path(path).read_bytes(), digest_size=10)
    made_by = [f"{library} {version(library)}" for library in ("trimesh", "scipy", "numpy")]
    for part in (repr(cuts), *made_by, Path(__file__).read_text(encoding="utf-8")):
        hashed.update(f"\0{part}".encode())
    return cache_subfolder("cells") / f"{hashed.hexdigest()}.npz"


def _read(file: Path) -> list[NDArray[np.float32]]:
    """Cells in their order; ValueError for what is no such file."""
    with np.load(file, allow_pickle=False) as stored:
        return [stored[f"arr_{i}"] for i in range(len(stored.files))]


def _cut(path: str, cuts: Cuts) -> list[NDArray[np.float32]]:
    mesh: Any = trimesh.load(path, force="mesh")
    cells = [(mesh.vertices, mesh.faces)]
    for axis, places in enumerate((cuts.x, cuts.y, cuts.z)):
        for place in places:
            cells = [half for cell in cells for half in _halves(*cell, axis, place)]
    hulls = [trimesh.convex.convex_hull(vertices[np.unique(faces)]) for vertices, faces in cells]
    return [np.asarray(hull.vertices, dtype=np.float32) for hull in hulls if hull.volume > CRUMB]


def _halves(vertices: Any, faces: Any, axis: int, place: float) -> list[tuple[Any, Any]]:
    """The triangles on either side of a plane across an axis, with crossing ones cut."""
    origin, normal = np.zeros(3), np.zeros(3)
    origin[axis], normal[axis] = place, 1.0
    cut: Any = trimesh.intersections.slice_faces_plane
    sides = [cut(vertices, faces, n, origin) for n in (normal, -normal)]
    return [(side[0], side[1]) for side in sides if len(side[1])]
