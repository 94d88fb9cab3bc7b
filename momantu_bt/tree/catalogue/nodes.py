"""Every node that a tree can have, built in or plugged in: by canonical type and by spelling."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint
from typing import Any, ClassVar, Protocol, TypeAlias, TypeVar

from momantu_bt.plugins import Group, PluginError
from momantu_bt.tree.catalogue.built_in import ADAPTERS, BUILT_IN
from momantu_bt.tree.catalogue.guarded import guarded
from momantu_bt.tree.catalogue.objection import node_objection, type_of
from momantu_bt.tree.catalogue.spec import Dialect, NodeSpec
from momantu_bt.tree.catalogue.words import CONDITIONS, NODE_KEYS

K = TypeVar("K")
V = TypeVar("V")
_Installed: TypeAlias = Mapping[str, EntryPoint]


class NodeClass(Protocol):
    """A node's class as the language knows it; the engine makes nodes of it."""

    spec: ClassVar[NodeSpec]


def _objection(name: str, plugin: object) -> str | None:
    return node_objection(name, plugin, _spellings())


PLUGINS: Group[type[NodeClass]] = Group("momantu_bt.nodes", "node", _objection)
"""Nodes that other packages bring, by YAML spelling."""


def _behaviour_objection(name: str, plugin: object) -> str | None:
    found: str | None = _bridge().behaviour_objection(name, plugin, _spellings())
    return found


DOCTOR = "run momantu-bt doctor"
"""What to do about a broken one."""

BEHAVIOURS: Group[object] = Group("momantu_bt.behaviours", "behaviour", _behaviour_objection)
"""Behaviours of py_trees that other packages bring, by their names in trees."""


@dataclass(frozen=True, slots=True)
class _Tables:
    """classes: by canonical type. The specs: by type, by YAML spelling, by number of cases."""

    classes: Mapping[str, type[NodeClass]]
    specs: Mapping[str, NodeSpec]
    spelled: Mapping[str, NodeSpec]
    switches: Mapping[int, NodeSpec]
    modifiers: Mapping[str, str]


class Table(Mapping[K, V]):
    """A table of nodes that is read, and its nodes imported, at its first use."""

    def __init__(self, read: Callable[[_Tables], Mapping[K, V]]) -> None:
        self._read = read

    def __getitem__(self, key: K) -> V:
        return self._read(_tables())[key]

    def __iter__(self) -> Iterator[K]:
        return iter(self._read(_tables()))

    def __len__(self) -> int:
        return len(self._read(_tables()))


NODES: Table[str, NodeSpec] = Table(lambda tables: tables.specs)
"""What each node says of itself, by canonical type."""
SPELLED: Table[str, NodeSpec] = Table(lambda tables: tables.spelled)
"""The same by YAML spelling."""
SWITCHES: Table[int, NodeSpec] = Table(lambda tables: tables.switches)
"""The switches by their number of cases; in YAML all are `switch`."""
NODE_CLASSES: Table[str, type[NodeClass]] = Table(lambda tables: tables.classes)
"""Classes by canonical type."""
MODIFIERS: Table[str, str] = Table(lambda tables: tables.modifiers)
"""Reserved modifier names of YAML, and what each one is: `key`, `condition` or `decorator`."""


def of_dialect(dialect: Dialect) -> list[str]:
    """Types of the built-in nodes of one dialect, sorted."""
    return sorted(name for name in BUILT_IN if NODES[name].dialect is dialect)


def plugged_in() -> list[str]:
    """Types of the nodes that other packages bring, sorted."""
    return sorted(NODES.keys() - BUILT_IN.keys())


def is_ours(name: str) -> bool:
    """Whether a node stands in our namespace in XML: BehaviorTree.CPP and Nav2 lack it."""
    return name in BUILT_IN and NODES[name].dialect is Dialect.OURS


def why_broken(name: str) -> str | None:
    """Why the node or behaviour of another package cannot be used; None where it can.

    name: its spelling in YAML or its type in XML; of no such node, None.
    """
    spelled = {type_of(spelling): spelling for spelling in PLUGINS}
    try:
        if name in PLUGINS or name in spelled:
            PLUGINS.load(spelled.get(name, name))
        elif name in BEHAVIOURS:
            BEHAVIOURS.load(name)
    except PluginError as error:
        return str(error)
    return None


def _tables() -> _Tables:
    """The tables of today's plug-ins; groups give the same mapping while these are the same."""
    global _newest
    found = PLUGINS.installed(), BEHAVIOURS.installed()
    if _newest is None or found[0] is not _newest[0] or found[1] is not _newest[1]:
        _newest = (*found, _read(*found))
    return _newest[2]


_newest: tuple[_Installed, _Installed, _Tables] | None = None
"""What the tables were read from, and the tables."""


def _bridge() -> Any:
    """The module that makes leaves of behaviours; py_trees is imported with it."""
    return _module(ADAPTERS[BEHAVIOURS.name])


def _module(name: str) -> Any:
    """A module of nodes; found by name, as plug-ins are, so that the language imports no node."""
    return import_module(f"momantu_bt.nodes.{name}")


def _spellings() -> frozenset[str]:
    """YAML spellings of the built-in nodes."""
    return frozenset(name for kind in _built_in().values() for name in kind.spec.yaml)


@cache
def _built_in() -> Mapping[str, type[NodeClass]]:
    found = {}
    for type_, module in BUILT_IN.items():
        found[type_] = getattr(_module(module), type_)
    return found


def _read(nodes: _Installed, behaviours: _Installed) -> _Tables:
    """All installed nodes without the broken ones; `load` of their group raises the reason."""
    classes = dict(_built_in())
    for name in nodes:
        with suppress(PluginError):
            plugin = PLUGINS.load(name)
            classes[plugin.spec.type] = plugin
    for name in behaviours:
        with suppress(PluginError):
            classes[name] = _bridge().node_class(name, BEHAVIOURS.load(name))
    specs = {
        type_: kind.spec if type_ in BUILT_IN else guarded(kind.spec)
        for type_, kind in classes.items()
    }
    return _Tables(
        classes=classes,
        specs=specs,
        spelled={name: spec for spec in specs.values() for name in spec.yaml},
        switches={spec.switch: spec for spec in specs.values() if spec.switch},
        modifiers={
            **dict.fromkeys(NODE_KEYS, "key"),
            **dict.fromkeys(CONDITIONS, "condition"),
            **{spec.yaml[0]: "decorator" for spec in specs.values() if spec.modifier},
            "force": "decorator",
        },
    )
