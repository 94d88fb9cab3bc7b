"""Asks every installed plug-in for its diagnoses; one that cannot be loaded is reported."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import EntryPoint
from typing import Any

from momantu_bt.diagnosis import Diagnosis
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.plugins import PREFIX, Group, PluginClash, PluginError

Hook = Callable[[], Iterable[Diagnosis]]


def plugins(groups: Iterable[Group[Any]]) -> Iterator[Diagnosis]:
    """Load every plug-in, count those that load, and collect their diagnoses."""
    hooks: dict[int, tuple[str, Hook]] = {}
    for group in groups:
        loaded: list[str] = []
        for name, entry in group.installed().items():
            try:
                hook = _hook(group.load(name), entry)
            except PluginClash as error:
                cure = "uninstall or rename one of them"
                yield Diagnosis(f"{group.name} {name}", False, str(error), cure)
                continue
            except PluginError as error:
                yield Diagnosis(f"{group.name} {name}", False, str(error), _reinstall(entry))
                continue
            loaded.append(name)
            if hook is not None:
                hooks.setdefault(id(hook), (name, hook))
        if loaded:
            yield Diagnosis(group.name.removeprefix(PREFIX), True, ", ".join(loaded))
    for name, hook in hooks.values():
        yield from asked(name, hook)


def asked(name: str, hook: Hook) -> Iterator[Diagnosis]:
    """The diagnoses of one plug-in; a hook that raises is itself a finding."""
    try:
        yield from hook()
    except PLUGIN_ERRORS as error:
        detail = f"its diagnose() raised {words_of(error)}"
        yield Diagnosis(name, False, detail, "tell its authors")


def _hook(plugin: Any, entry: EntryPoint) -> Hook | None:
    """`diagnose` of the plug-in, of its module, or of its package: the first that exists."""
    module = entry.module
    for owner in (plugin, sys.modules.get(module), sys.modules.get(module.partition(".")[0])):
        hook: Hook | None = getattr(owner, "diagnose", None)
        if callable(hook):
            return hook
    return None


def _reinstall(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist is not None else entry.module.partition(".")[0]
    return f"`pip install --force-reinstall {package}`, or tell its authors"
