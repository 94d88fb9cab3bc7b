"""Files that a mesh file names: pictures and materials, searched where Gazebo searches them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import trimesh

from momantu_worlds.sdf.read.uris import is_there

MOST_BYTES = 64_000_000
TEXTURES = Path("materials", "textures")
"""Folder in a model's folder where Gazebo searches pictures that are not where the mesh says."""

_Resolver: Any = trimesh.resolvers.Resolver


class Companions(_Resolver):  # type: ignore[misc]
    """Reads files for trimesh, from the model's folder only.

    missing: names of files that were not found.
    """

    def __init__(self, mesh: Path) -> None:
        self._folder = Path(os.path.normpath(mesh.parent.absolute()))
        self.missing: dict[str, None] = {}

    def get(self, name: str) -> bytes:
        """The content of a file; raises OSError."""
        for candidate in self._candidates(name):
            if not is_there(candidate) or not candidate.is_file():
                continue
            if candidate.stat().st_size <= MOST_BYTES:
                return candidate.read_bytes()
        self.missing[name] = None
        raise FileNotFoundError(name)

    def _candidates(self, name: str) -> Iterator[Path]:
        plain = unquote(name.removeprefix("file://")).replace("\\", "/")
        model, last = self._folder.parent, Path(plain).name
        for path in (
            self._folder / plain,
            model / TEXTURES / last,
            self._folder / last,
            self._folder / TEXTURES / last,
        ):
            candidate = Path(os.path.normpath(path))
            if candidate.is_relative_to(model):
                yield candidate

    def write(self, name: str, data: Any) -> None:
        """Nothing is written."""
        raise NotImplementedError

    def namespaced(self, namespace: str) -> Companions:
        """There are no folders within."""
        raise NotImplementedError

    def keys(self) -> list[str]:
        """Names are asked for, not listed."""
        return []
