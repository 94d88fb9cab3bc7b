"""Finding what is installed: skills, services, robots, worlds, trees and verbs by entry point."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

SKILLS = "momantu_bt.skills"
SERVICES = "momantu_bt.services"
ROBOTS = "momantu_bt.robots"
WORLDS = "momantu_bt.worlds"
TREES = "momantu_bt.trees"
COMMANDS = "momantu_bt.commands"

_WHAT = {SKILLS: "skill", SERVICES: "service", ROBOTS: "robot", WORLDS: "world", TREES: "tree"}


class PluginError(Exception):
    """A plug-in is missing, broken, or named twice; the message says which and what to do."""


def installed(group: str) -> dict[str, EntryPoint]:
    """Entry points of a group by name, in the order of their names.

    Raises:
        PluginError: two packages give the same name different things; both are named.
    """
    return dict(_installed(entry_points, group))


@cache
def _installed(find: Callable[..., Iterable[EntryPoint]], group: str) -> dict[str, EntryPoint]:
    """As `installed`. What is installed does not change while a process runs; asking is slow."""
    found: dict[str, EntryPoint] = {}
    for entry in sorted(find(group=group), key=lambda e: (e.name, e.value)):
        other = found.get(entry.name)
        if other is not None and other.value != entry.value:
            raise PluginError(
                f"two plug-ins are called {entry.name!r}: {_origin(other)} and {_origin(entry)}; "
                "uninstall one of them or rename its entry point"
            )
        found[entry.name] = entry
    return found


def load(group: str, name: str) -> Any:
    """Import one plug-in by name.

    Raises:
        PluginError: there is none of that name (with the nearest ones), or it cannot be imported.
    """
    having = installed(group)
    what = _WHAT.get(group, "plug-in")
    if name not in having:
        near = difflib.get_close_matches(name, having, n=1)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        names = ", ".join(having) or "none"
        raise PluginError(f"no {what} is called {name!r}{hint}; installed: {names}")
    try:
        return having[name].load()
    except Exception as error:
        raise PluginError(
            f"the {what} {name!r} ({_origin(having[name])}) cannot be loaded: "
            f"{type(error).__name__}: {error}"
        ) from error


def _origin(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist is not None else "an unknown package"
    return f"{entry.value} of {package}"
