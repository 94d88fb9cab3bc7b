"""Robots and worlds by path: a file in the place of an installed plug-in's name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from momantu_bt.plugins import ROBOTS, WORLD_FILES, WORLDS, PluginError, installed, load

GEOMETRY = (".urdf", ".xacro")
"""How files end that a robot file names, and that somebody may take for one."""
ENDINGS = (".yaml", ".yml", *GEOMETRY)
"""A name that ends so, or has a slash in it, is a path."""
_USUAL = {ROBOTS: "robot.yaml", WORLDS: "world.yaml"}


def by_path(group: str, name: str) -> bool:
    """Whether a robot or a world is named by its file or folder."""
    return group in _USUAL and ("/" in name or name.endswith(ENDINGS))


def absolute(group: str, name: str | None) -> str | None:
    """The same robot or world, wherever the process that is told of it works."""
    return str(Path(name).absolute()) if name is not None and by_path(group, name) else name


def from_file(group: str, name: str) -> Any:
    """What the file at a path describes, as a plug-in of the group: ROBOTS or WORLDS.

    Raises:
        PluginError: there is no such file, or nothing that is installed reads its kind.
        WorldError: a world file is wrong.
    """
    path = Path(name)
    what = "robot" if group == ROBOTS else "world"
    if path.is_dir():
        path /= _USUAL[group]
    if not path.exists():
        beside = sorted(p.name for p in path.parent.glob("*.y*ml")) if path.parent.is_dir() else []
        there = f"; files there: {', '.join(beside)}" if beside else ""
        raise PluginError(f"there is no {what} file {path}{there}")
    if group == ROBOTS:
        if path.suffix in GEOMETRY:
            setup = f"momantu-bt robots setup {path}"
            raise PluginError(f"{path} is no robot file, but a URDF; `{setup}` makes one of it")
        from momantu_bt.robots import read_robot

        return lambda: read_robot(path)
    readers, ending = installed(WORLD_FILES), path.suffix.removeprefix(".")
    if ending not in readers:
        kinds = ", ".join(f".{each}" for each in readers) or "none"
        raise PluginError(f"nothing reads the world {path}; kinds of files that are read: {kinds}")
    read: Callable[[Path], Any] = load(WORLD_FILES, ending)
    return read(path)


def near_file(group: str, name: str) -> str | None:
    """What to write instead of a file's bare name; None when no such file is near."""
    if group in _USUAL:
        for file in (f"{name}.yaml", f"{name}.yml", f"{name}/{_USUAL[group]}"):
            if Path(file).is_file():
                return f"for the file that lies here write ./{file}"
    return None
