"""Worlds by name: installed ones, files in the place of a name, and `none`."""

from __future__ import annotations

from collections.abc import Callable
from inspect import getattr_static
from pathlib import Path
from typing import Any

from momantu_bt.plugins import Files, Group, PluginError
from momantu_bt.world import TICK, WorldEntry

WORLD_FILES: Group[Callable[[Path], WorldEntry]] = Group(
    "momantu_bt.world_files", "reader of world files"
)
"""Functions that give a world from the path of its file, by the file's ending."""


def _world(name: str, plugin: Any) -> str | None:
    parts = ("name", "default_robot", "site", "open")
    lacking = [part for part in parts if not _has(plugin, part)]
    return f"{plugin!r} has no {' and no '.join(lacking)}" if lacking else None


def _has(plugin: Any, part: str) -> bool:
    """Whether a plug-in has an attribute; does not get its value, as that may read a file."""
    try:
        getattr_static(plugin, part)
    except AttributeError:
        return False
    return True


def _read_world(path: Path) -> WorldEntry:
    ending = path.suffix.removeprefix(".")
    if ending not in WORLD_FILES:
        kinds = ", ".join(f".{each}" for each in WORLD_FILES) or "none"
        raise PluginError(f"nothing reads the world {path}; kinds of files that are read: {kinds}")
    return WORLD_FILES.load(ending)(path)


WORLDS: Group[WorldEntry] = Group(
    "momantu_bt.worlds", "world", _world, Files("world.yaml", _read_world)
)


class NoWorld:
    """The world `none`: a clock without a robot, a site and a referee."""

    def __init__(self) -> None:
        self._ticks = 0

    def now(self) -> float:
        """Seconds since the run began."""
        return self._ticks * TICK

    def step(self) -> None:
        """Advance by one tick."""
        self._ticks += 1
