"""The inputs of an episode (versions, tree files, code, values) and the key made of them.

The inputs include a digest of the code, because edits to a package under development do not change
its version.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import os.path
import platform
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from momantu_bt.engine.build import skills_in
from momantu_bt.faults.tree_file import faults_source
from momantu_bt.plugins import Group
from momantu_bt.record.versions import LIBRARIES
from momantu_bt.robots.meshes import MESHES
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.running.told import NO_MAP, told_files
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.catalogue.nodes import BEHAVIOURS, PLUGINS
from momantu_bt.tree.check.named_world import WITHOUT_WORLD, world_of
from momantu_bt.tree.files.settings import Given
from momantu_bt.tree.goals import OPTION
from momantu_bt.tree.model import Document
from momantu_bt.tree.plugins import SERVICES, SKILLS
from momantu_bt.tree.registry import Registry
from momantu_bt.version import __version__
from momantu_bt.world_plugins import WORLDS

DIGITS = 16
_CODE = "the code of "
_BESIDE = {
    "momantu_bt": (
        *("bench", "cli", "diagnosis", "drawing", "page", "replay", "scaffold"),
        *("trees", "problems", "constraints.txt", "pytest_plugin.py"),
    )
}
"""Parts of a package that no episode depends on; a tree's own files are counted separately."""


def made_of(
    document: Document,
    registry: Registry,
    *,
    world: str | None = None,
    robot: str | None = None,
    values: Mapping[str, Any] | None = None,
    max_time: float = 600.0,
    referee: bool = True,
    goal: Any = None,
    map_: str | None = None,
    names: str | None = None,
) -> dict[str, str]:
    """All that decides an episode except its seed and its fault, by readable names.

    Files count by their text and by their name relative to the main file, so that another
    machine gets the same result.
    """
    world = world_of(document, world) or WITHOUT_WORLD
    if robot is None and world != WITHOUT_WORLD:
        robot = registry.worlds[world].default_robot
    found = _of_machine(_packages(document, world, robot))
    given = values.source if isinstance(values, Given) else {}
    folder = Path(document.file).parent
    for file, text in {**document.source, **faults_source(document)}.items():
        if file not in given and file != OPTION:
            found[f"the file {os.path.relpath(file, folder)}"] = _digest(text.encode())
    found["the world"] = world
    found["the robot"] = robot or "none"
    if WORLDS.is_path(world):
        found |= _digests("world", _files_of_world(registry.worlds[world]))
        found["the world"] = registry.worlds[world].name
    if robot is not None and (ROBOTS.is_path(robot) or MESHES in os.environ):
        description = registry.description(robot)
        found |= _digests("robot", description.files)
        found["the robot"] = description.name
    found["the values"] = json.dumps(dict(values or {}), sort_keys=True, default=str)
    found["the time limit"] = f"{max_time:g} s"
    if goal is not None:
        found["the goal"] = json.dumps(goal, sort_keys=True, default=str)
    found |= _digests("told", told_files(map_, names))
    if map_ == NO_MAP:
        found["the map"] = NO_MAP
    if not referee:
        found["the referee"] = "none"
    return found


@runtime_checkable
class FiledWorld(Protocol):
    """A world entry that is made from files."""

    def files(self) -> Iterable[Path]:
        """The world file, and all files that it names."""
        ...


def _files_of_world(entry: Any) -> dict[str, Path]:
    files = tuple(entry.files()) if isinstance(entry, FiledWorld) else ()
    return {os.path.relpath(file, files[0].parent): file for file in files}


def _digests(what: str, files: Mapping[str, Path]) -> dict[str, str]:
    return {f"the {what}'s file {name}": _digest(path.read_bytes()) for name, path in files.items()}


def foreign(made: Mapping[str, str]) -> tuple[str, ...]:
    """The differences between this machine and `made`, a sentence each."""
    packages = [name.removeprefix(_CODE) for name in made if name.startswith(_CODE)]
    here = _of_machine(packages)
    there = {name: made[name] for name in made if name in here or name in LIBRARIES.values()}
    return tuple(
        f"{name} is {here.get(name, 'missing')}, not {there.get(name, 'missing')}"
        for name in difference(there, here)
    )


def key_of(made: Mapping[str, str], seed: int, fault: str | None) -> str:
    """The name of one episode: equal when and only when all that decides it is."""
    return _digest(json.dumps([dict(made), seed, fault], sort_keys=True).encode())


def difference(made: Mapping[str, str], other: Mapping[str, str]) -> tuple[str, ...]:
    """The names of differing inputs, such as `the file bring_object.yaml`."""
    names = {**made, **other}
    return tuple(name for name in names if made.get(name) != other.get(name))


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:DIGITS]


def _of_machine(packages: Iterable[str]) -> dict[str, str]:
    """Versions, and digests of the code of these packages."""
    found = {"momantu-bt": __version__, "python": platform.python_version()}
    found |= _libraries()
    return found | {f"{_CODE}{package}": _code(package) for package in packages}


def _libraries() -> dict[str, str]:
    """Versions of the libraries that a run may load; whether it will is not known yet."""
    found = {}
    for distribution in LIBRARIES.values():
        with suppress(metadata.PackageNotFoundError):
            found[distribution] = metadata.version(distribution)
    return found


def _packages(document: Document, world: str, robot: str | None) -> Iterator[str]:
    """Packages with code that takes part: this one, and those of the plug-ins."""
    wanted: dict[Group[Any], Iterable[str | None]] = {
        SKILLS: skills_in(document),
        PLUGINS: _spellings(document),
        BEHAVIOURS: _spellings(document),
        WORLDS: (world,),
        ROBOTS: (robot,),
        SERVICES: SERVICES,
    }
    found = {"momantu_bt"}
    for group, names in wanted.items():
        having = group.installed()
        found |= {
            having[name].module.partition(".")[0]
            for name in names
            if name is not None and name in having
        }
    yield from sorted(found)


def _spellings(document: Document) -> set[str]:
    """Nodes of the language that a document has, by their spellings."""
    nodes = (node for tree in document.trees.values() for node in tree.root.walk())
    return {NODES[node.type].yaml[0] for node in nodes if node.type in NODES}


@cache
def _code(package: str) -> str:
    """Digest of all files of a top-level package, or of a module that is one file."""
    spec = importlib.util.find_spec(package)
    if spec is None:
        return "not found"
    hashed = hashlib.sha256()
    folders = [Path(folder) for folder in spec.submodule_search_locations or ()]
    for folder in folders:
        for path in _files(folder, _BESIDE.get(package, ())):
            name = path.relative_to(folder).as_posix()
            hashed.update(f"{name} {path.stat().st_size}\n".encode() + path.read_bytes())
    if not folders and spec.origin is not None:
        hashed.update(Path(spec.origin).read_bytes())
    return hashed.hexdigest()[:DIGITS]


def _files(folder: Path, beside: tuple[str, ...]) -> list[Path]:
    """The files of a package, without those that Python and editors leave behind."""
    found = []
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        hidden = any(part.startswith(".") or part == "__pycache__" for part in parts)
        if path.is_file() and not hidden and parts[0] not in beside:
            found.append(path)
    return found
