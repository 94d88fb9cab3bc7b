"""The meshes that `--meshes` names: of a folder, of a folder for each mesh, or of a pattern."""

from __future__ import annotations

import os
from pathlib import Path

from momantu_bt.errors import InputError
from momantu_worlds.scenes.file.furniture import MESH_ENDINGS


def named_meshes(named: Path) -> list[tuple[str, Path]]:
    """The meshes with their names, in the order of their files.

    named: a folder of meshes; one of folders that hold a mesh each, as collections of scanned
    things have it; or a pattern such as `ycb/*/textured.obj`.

    Raises:
        InputError: there is no such folder or mesh, or a folder for one mesh holds several.
    """
    if not named.is_dir() and any(sign in str(named) for sign in "*?["):
        found = [file for file in _matching(named) if _is_mesh(file)]
        if not found:
            raise InputError(f"--meshes {named}: the pattern matches no mesh; {_endings()}")
        return _named(found)
    if not named.is_dir():
        raise InputError(f"--meshes {named}: there is no such folder")
    found = [file for file in sorted(named.iterdir()) if _is_mesh(file)]
    if found:
        return _named(found)
    folders = [folder for folder in sorted(named.iterdir()) if folder.is_dir()]
    within = {folder: sorted(filter(_is_mesh, folder.rglob("*"))) for folder in folders}
    for folder, files in within.items():
        if len(files) > 1:
            names = ", ".join(str(file.relative_to(folder)) for file in files[:4])
            raise InputError(
                f"--meshes {named}: {folder.name} holds {len(files)} meshes ({names}"
                f"{', ...' if len(files) > 4 else ''}); say which of each folder is meant by a "
                f"pattern in quotes, such as '{named}/*/{files[0].relative_to(folder)}'"
            )
    found = [files[0] for files in within.values() if files]
    if not found:
        raise InputError(f"--meshes {named} holds no mesh; {_endings()}")
    return _named(found)


def _matching(pattern: Path) -> list[Path]:
    root = Path(pattern.anchor) if pattern.is_absolute() else Path()
    return sorted(root.glob(str(pattern.relative_to(pattern.anchor))))


def _is_mesh(file: Path) -> bool:
    return file.is_file() and file.name.lower().endswith(MESH_ENDINGS)


def _named(files: list[Path]) -> list[tuple[str, Path]]:
    """Each with where it lies below the folder that all share, without its ending."""
    root = os.path.commonpath([file.parent for file in files])
    return [(str(file.relative_to(root).with_suffix("")), file) for file in files]


def _endings() -> str:
    return f"endings: {', '.join(MESH_ENDINGS)}"
