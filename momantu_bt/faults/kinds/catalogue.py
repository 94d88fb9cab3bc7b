"""Every kind of fault that is installed, by its name."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint
from types import MappingProxyType
from typing import Any

from momantu_bt.fault_kind import FaultKind, Where
from momantu_bt.plugins import Group, PluginClash, PluginError


def _objection(name: str, plugin: Any) -> str | None:
    if isinstance(plugin, tuple) and all(isinstance(each, FaultKind) for each in plugin):
        return None
    return f"{plugin!r} is not a tuple of momantu_bt.fault_kind.FaultKind"


FAULTS: Group[tuple[FaultKind, ...]] = Group("momantu_bt.faults", "list of faults", _objection)
"""Rows of faults."""


def kinds() -> Mapping[str, FaultKind]:
    """All kinds by `component.mode`, in the order of `Where`: those at the robot come first.

    A plug-in that cannot be loaded is left out; `momantu-bt doctor` says why.

    Raises:
        PluginClash: two plug-ins have a fault with the same name.
    """
    return _kinds(tuple(FAULTS.installed().values()))


@cache
def _kinds(entries: tuple[EntryPoint, ...]) -> Mapping[str, FaultKind]:
    found: dict[str, FaultKind] = {}
    whose: dict[str, EntryPoint] = {}
    for entry in entries:
        try:
            rows = FAULTS.load(entry.name)
        except PluginError:
            continue
        for kind in rows:
            if kind.name in found:
                raise PluginClash(
                    f"two plug-ins have a fault {kind.name!r}: {whose[kind.name].value} and "
                    f"{entry.value}; uninstall one of them or rename its fault"
                )
            found[kind.name], whose[kind.name] = kind, entry
    order = list(Where)
    return MappingProxyType(dict(sorted(found.items(), key=lambda e: order.index(e[1].place))))
