"""Asks every installed plug-in for its diagnoses; one that cannot be loaded is reported."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import EntryPoint
from typing import Any

from momantu_bt.diagnosis import Diagnosis
from momantu_bt.diagnosis.imports import fatal_imports
from momantu_bt.diagnosis.packages import DISTRIBUTION
from momantu_bt.errors import PLUGIN_ERRORS, words_of
from momantu_bt.importing import output_aside
from momantu_bt.plugins import PREFIX, Group, PluginClash, PluginError

PLUGIN_SECONDS = 30.0
"""Time for the imports of other packages' plug-ins; one that takes longer is named."""
Hook = Callable[[], Iterable[Diagnosis]]


def plugins(groups: Iterable[Group[Any]]) -> Iterator[Diagnosis]:
    """Load every plug-in, count those that load, and collect their diagnoses."""
    hooks: dict[int, tuple[str, Hook]] = {}
    known = list(groups)
    errors = fatal_imports(_others(known), PLUGIN_SECONDS)
    for group in known:
        loaded: list[str] = []
        for name, entry in group.installed().items():
            if entry.module in errors:
                detail = f"{entry.value} cannot be imported: {errors[entry.module]}"
                yield Diagnosis(f"{group.name} {name}", False, detail, _reinstall(entry))
                continue
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


def _others(groups: Iterable[Group[Any]]) -> list[str]:
    """Modules of other packages that are not imported yet, which may hang or end the process."""
    entries = [entry for group in groups for entry in group.installed().values()]
    own = {entry.module for entry in entries if _is_ours(entry)}
    return sorted({entry.module for entry in entries} - own - sys.modules.keys())


def _is_ours(entry: EntryPoint) -> bool:
    return entry.dist is not None and entry.dist.name == DISTRIBUTION


def asked(name: str, hook: Hook) -> Iterator[Diagnosis]:
    """The diagnoses of one plug-in; a hook that raises is itself a finding."""
    found: list[Diagnosis] = []
    try:
        with output_aside():
            found.extend(hook())
    except PLUGIN_ERRORS as error:
        detail = f"its diagnose() raised {words_of(error)}"
        found.append(Diagnosis(name, False, detail, "tell its authors"))
    yield from found


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
