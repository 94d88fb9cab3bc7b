"""Skills, services and worlds by name: the plug-ins that trees can name."""

from __future__ import annotations

from collections.abc import Callable
from inspect import getattr_static
from pathlib import Path
from typing import Any

from momantu_bt.plugins import Files, Group, PluginError
from momantu_bt.service import Service
from momantu_bt.skill import Skill
from momantu_bt.tree.skill_objection import skill_objection
from momantu_bt.world import WorldEntry

SKILLS: Group[type[Skill]] = Group("momantu_bt.skills", "skill", skill_objection)


def _service(name: str, plugin: Any) -> str | None:
    if isinstance(plugin, type) and issubclass(plugin, Service):
        return None
    return f"{plugin!r} is not a subclass of momantu_bt.Service"


SERVICES: Group[type[Service]] = Group("momantu_bt.services", "service", _service)

WORLD_FILES: Group[Callable[[Path], WorldEntry]] = Group(
    "momantu_bt.world_files", "reader of world files"
)
"""Functions that give a world from the path of its file, by the file's ending."""


def _world(name: str, plugin: Any) -> str | None:
    parts = ("name", "default_robot", "site", "open")
    lacking = [part for part in parts if not _has(plugin, part)]
    return f"{plugin!r} has no {' and no '.join(lacking)}" if lacking else None


def _has(plugin: Any, part: str) -> bool:
    """Whether it has an attribute, without asking for its value: that may read a file."""
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
