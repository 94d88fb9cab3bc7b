"""Finding what is installed: skills, services, robots, worlds, trees and verbs by entry point.

A plug-in is checked when it is loaded. One that is broken, or whose name two packages give, is
told by `load`; all the others go on working.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeAlias

from momantu_bt.errors import MomantuError
from momantu_bt.formats.names import nearest

SKILLS = "momantu_bt.skills"
SERVICES = "momantu_bt.services"
ROBOTS = "momantu_bt.robots"
WORLDS = "momantu_bt.worlds"
TREES = "momantu_bt.trees"
COMMANDS = "momantu_bt.commands"
WORLD_FILES = "momantu_bt.world_files"
"""Functions that give a world from the path of its file, by the file's ending."""

_WHAT = {
    SKILLS: "skill",
    SERVICES: "service",
    ROBOTS: "robot",
    WORLDS: "world",
    WORLD_FILES: "reader of world files",
    TREES: "tree",
    COMMANDS: "verb",
}

_Found: TypeAlias = Mapping[str, tuple[EntryPoint, ...]]


class PluginError(MomantuError):
    """A plug-in is missing, broken, or named twice; the message says which and what to do."""


class PluginClash(PluginError):
    """Two packages give one name different things; the message names both."""


def installed(group: str) -> dict[str, EntryPoint]:
    """Entry points of a group by name, in the order of their names; nothing is imported.

    Of a name that two packages give different things it holds the first; `load` refuses it.
    """
    return {name: entries[0] for name, entries in _installed(entry_points, group).items()}


@cache
def _installed(find: Callable[..., Iterable[EntryPoint]], group: str) -> _Found:
    """All that is called so, by name. It does not change while a process runs; asking is slow."""
    found: dict[str, dict[str, EntryPoint]] = {}
    for entry in sorted(find(group=group), key=lambda e: (e.name, e.value)):
        found.setdefault(entry.name, {}).setdefault(entry.value, entry)
    return {name: tuple(entries.values()) for name, entries in found.items()}


def load(group: str, name: str) -> Any:
    """Import one plug-in by name and check it; of a robot or a world, read the file at a path.

    Raises:
        PluginError: there is none of that name (with the nearest ones), it cannot be imported,
            or it is not what a plug-in of this group has to be.
        PluginClash: two packages give this name different things.
    """
    from momantu_bt.plugin_files import by_path, from_file, near_file

    if by_path(group, name):
        return from_file(group, name)
    having = _installed(entry_points, group)
    what = _WHAT.get(group, "plug-in")
    if name not in having:
        near = nearest(name, having)
        meant = near_file(group, name) or (f"did you mean {near!r}?" if near else "")
        hint = f" ({meant})" if meant else ""
        names = ", ".join(having) or "none"
        raise PluginError(f"no {what} is called {name!r}{hint}; installed: {names}")
    entry, *others = having[name]
    if others:
        raise PluginClash(
            f"two plug-ins are called {name!r}: {_origin(entry)} and {_origin(others[0])}; "
            "uninstall one of them or rename its entry point"
        )
    try:
        plugin = entry.load()
    except (Exception, SystemExit) as error:  # other people's code: it may raise anything
        reason = f"cannot be loaded: {type(error).__name__}: {error}"
    else:
        from momantu_bt.plugin_checks import objection

        found = objection(group, name, plugin)
        if found is None:
            return plugin
        reason = f"is broken: {found}"
    raise PluginError(f"the {what} {name!r} ({_origin(entry)}) {reason}")


def _origin(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist is not None else "an unknown package"
    return f"{entry.value} of {package}"
