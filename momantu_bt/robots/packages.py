"""Find ROS packages by their names: for `$(find …)` of xacro and `package://` of meshes alike."""

from __future__ import annotations

import importlib.util
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

MANIFEST = "package.xml"
"""The file in the root of a ROS package; it has the package's name."""
MESH_SUFFIXES = (".stl", ".obj", ".dae", ".glb", ".gltf", ".ply")
"""Suffixes of mesh files."""
UP = 3
"""Folders above a file's own package in which its neighbours are looked for."""
SCHEME = "package://"
"""What a mesh's address in a package begins with."""
_NAME = re.compile(r"<name>\s*([\w.-]+)\s*</name>")


class Packages:
    """The packages around a file of a robot.

    They are looked for, in this order: in the given folders, beside the robot file, above the file,
    beside its own package in a workspace, in ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and among
    installed Python packages. A given folder is a package, or has packages in it.
    """

    def __init__(self, path: Path, folder: Path, given: Sequence[Path] = ()) -> None:
        """path: of the URDF or xacro file. folder: of the robot file."""
        self.path, self.folder, self.given = path.resolve(), folder.resolve(), tuple(given)
        self._found: dict[str, Path | None] = {}

    def find(self, name: str) -> Path | None:
        """The folder of a package; None if there is none."""
        if name not in self._found:
            self._found[name] = next(self._candidates(name), None)
        return self._found[name]

    def mesh(self, address: str) -> Path | None:
        """The file that a mesh's address means; None if there is none.

        Where the address ends in no suffix of meshes, a mesh of the same name beside it is meant.
        """
        found = self.file(address)
        if found is not None or Path(address).suffix.lower() in MESH_SUFFIXES:
            return found
        named = (each for each in self.mesh_candidates(address) if each.name)
        beside = (each.with_suffix(suffix) for each in named for suffix in MESH_SUFFIXES)
        return next((each for each in beside if each.is_file()), None)

    def file(self, address: str) -> Path | None:
        """The file that an address of a URDF means; None if there is none."""
        return next((each for each in self.mesh_candidates(address) if each.is_file()), None)

    def mesh_candidates(self, address: str) -> Iterator[Path]:
        """Where the file of a mesh's address may lie, the best place first."""
        plain = address.removeprefix("file://")
        if not plain.startswith(SCHEME):
            yield self.path.parent / plain
            yield self.folder / plain
            if not Path(plain).is_absolute():
                yield from (parent / plain for parent in self.path.parents)
            return
        plain = plain.removeprefix(SCHEME).lstrip("/")
        package, _, inside = plain.partition("/")
        for root in (self.path.parent, self.folder):
            yield root / plain
        found = self.find(package)
        if found is not None:
            yield found / inside
        # a package's folder may have another name, as an unpacked archive has
        yield from (parent / inside for parent in self.path.parents if inside)

    def searched(self) -> str:
        """Where packages were looked for, and what to do, for messages."""
        given = ", ".join(str(each) for each in self.given)
        where = f"{given}, " if given else ""
        return (
            f"looked in {where}{self.folder}, above {self.path.parent} and beside its package, in "
            "ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and installed Python packages; give the folder "
            "that has it with `packages: [FOLDER]` in the robot file, or to `robots setup` with "
            "--package-path"
        )

    def _candidates(self, name: str) -> Iterator[Path]:
        for folder in self.given:
            yield from _at(folder, name)
        for folder in (self.folder, self.folder.parent, *self.path.parents):
            if folder.name == name:
                yield folder
            if (folder / name).is_dir():
                yield folder / name
        for folder in _workspace(self.path):
            yield from _below(folder, name)
        for folder in _environment(name):
            yield from _at(folder, name)
        spec = importlib.util.find_spec(name) if name.isidentifier() else None
        if spec is not None and spec.submodule_search_locations:
            yield Path(next(iter(spec.submodule_search_locations)))


def _at(folder: Path, name: str) -> Iterator[Path]:
    """The package in a folder that is it, or that has it one or two folders further down."""
    if (folder / MANIFEST).is_file() and _is_package(folder, name):
        yield folder
    if (folder / name).is_dir():
        yield folder / name
    yield from _below(folder, name)
    if folder.name == name and folder.is_dir():
        yield folder


def _is_package(folder: Path, name: str) -> bool:
    if folder.name == name and folder.is_dir():
        return True
    try:
        found = _NAME.search((folder / MANIFEST).read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return False
    return found is not None and found[1] == name


def _below(folder: Path, name: str) -> Iterator[Path]:
    """The package of this name one or two folders further down."""
    for level in ("*", "*/*"):
        for each in sorted(folder.glob(f"{level}/{MANIFEST}")):
            if _is_package(each.parent, name):
                yield each.parent


def _workspace(path: Path) -> Iterator[Path]:
    """Folders above the package that a file belongs to, which may hold its neighbours."""
    own = next((parent for parent in path.parents if (parent / MANIFEST).is_file()), None)
    if own is None:
        return
    large = {Path.home(), Path(tempfile.gettempdir()).resolve(), Path(path.anchor)}
    for parent in own.parents[:UP]:
        if parent in large:
            return
        yield parent


def _environment(name: str) -> Iterator[Path]:
    """The folders that ROS names in the environment."""
    for folder in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        if folder:
            yield Path(folder)
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            yield Path(prefix) / "share" / name
