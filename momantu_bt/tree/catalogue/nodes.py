"""Every node that a tree can have, built in or plugged in: by canonical type and by spelling."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint
from typing import Any, ClassVar, Protocol, TypeAlias, TypeVar

from momantu_bt.plugins import Group, PluginError, installed_names
from momantu_bt.tree.catalogue.built_in import ADAPTERS, BUILT_IN
from momantu_bt.tree.catalogue.guarded import guarded
from momantu_bt.tree.catalogue.objection import node_objection, type_of
from momantu_bt.tree.catalogue.spec import Dialect, NodeSpec
from momantu_bt.tree.catalogue.words import CONDITIONS, NODE_KEYS

K = TypeVar("K")
V = TypeVar("V")
_Installed: TypeAlias = Mapping[str, EntryPoint]


class NodeClass(Protocol):
    """The class of a node. The tree language uses only its `spec`; the engine makes instances."""

    spec: ClassVar[NodeSpec]


def _objection(name: str, plugin: object) -> str | None:
    return (
        _named_like_a_skill(name)
        or _named_like_a_node(name, type_of(name))
        or node_objection(name, plugin, _spellings())
    )


def _named_like_a_skill(name: str) -> str | None:
    """Why a node cannot have the name of an installed skill, or None. No skill is imported."""
    skills = installed_names("momantu_bt.skills")
    taken = next((each for each in (name, type_of(name)) if each in skills), None)
    if taken is None:
        return None
    return f"{taken!r} is an installed skill; give the entry point and the spec another name"


def _named_like_a_node(name: str, tag: str) -> str | None:
    """Why a plug-in cannot have this tag in XML, or None: another node has it already."""
    others = {type_of(each): each for each in PLUGINS.installed() if each != name}
    if tag not in others:
        return None
    return f"{others[tag]!r} is a node that XML calls {tag} too; give the entry point another name"


PLUGINS: Group[type[NodeClass]] = Group("momantu_bt.nodes", "node", _objection)
"""Nodes from plug-ins, by YAML name."""


def _behaviour_objection(name: str, plugin: object) -> str | None:
    if name in PLUGINS:
        return f"{name!r} is the node of another package; give the entry point another name"
    found: str | None = _bridge().behaviour_objection(name, plugin, _spellings())
    return _named_like_a_skill(name) or _named_like_a_node(name, name) or found


DOCTOR = "run momantu-bt doctor"
"""The hint for a broken plug-in."""

BEHAVIOURS: Group[object] = Group("momantu_bt.behaviours", "behaviour", _behaviour_objection)
"""py_trees behaviours from plug-ins, by their names in trees."""


@dataclass(frozen=True, slots=True)
class _Tables:
    """The tables of all nodes.

    classes: by canonical type. specs: by canonical type. spelled: specs by YAML name. switches:
    specs of switches by number of cases. modifiers: the kind of each modifier by its YAML name.
    """

    classes: Mapping[str, type[NodeClass]]
    specs: Mapping[str, NodeSpec]
    spelled: Mapping[str, NodeSpec]
    switches: Mapping[int, NodeSpec]
    modifiers: Mapping[str, str]


class Table(Mapping[K, V]):
    """A table of nodes. Its first use imports the nodes."""

    def __init__(self, read: Callable[[_Tables], Mapping[K, V]]) -> None:
        self._read = read

    def __getitem__(self, key: K) -> V:
        return self._read(_tables())[key]

    def __iter__(self) -> Iterator[K]:
        return iter(self._read(_tables()))

    def __len__(self) -> int:
        return len(self._read(_tables()))


NODES: Table[str, NodeSpec] = Table(lambda tables: tables.specs)
"""The spec of each node, by canonical type."""
SPELLED: Table[str, NodeSpec] = Table(lambda tables: tables.spelled)
"""The spec of each node, by YAML name."""
SWITCHES: Table[int, NodeSpec] = Table(lambda tables: tables.switches)
"""The specs of switches by number of cases; in YAML all of them are named `switch`."""
NODE_CLASSES: Table[str, type[NodeClass]] = Table(lambda tables: tables.classes)
"""The class of each node, by canonical type."""
MODIFIERS: Table[str, str] = Table(lambda tables: tables.modifiers)
"""Names of YAML modifiers, each with its kind: `key`, `condition` or `decorator`."""


def of_dialect(dialect: Dialect) -> list[str]:
    """Types of the built-in nodes of one dialect, sorted."""
    return sorted(name for name in BUILT_IN if NODES[name].dialect is dialect)


def plugged_in() -> list[str]:
    """Types of the nodes from plug-ins, sorted."""
    return sorted(NODES.keys() - BUILT_IN.keys())


def is_ours(name: str) -> bool:
    """Whether a node is in Momantu's namespace in XML, as BehaviorTree.CPP and Nav2 lack it."""
    return name in BUILT_IN and NODES[name].dialect is Dialect.OURS


FOREIGN = "other:"
"""Begins the type of another program's node that has the name of one of ours."""


def theirs(name: str) -> str:
    """The type of another program's node; XML writes our own nodes with a prefix."""
    return FOREIGN + name if is_ours(name) else name


def said_type(type_: str) -> str:
    """The name of a node's type in messages."""
    return type_.removeprefix(FOREIGN)


def why_broken(name: str) -> str | None:
    """Why a plug-in's node or behaviour cannot be used; None if it can or does not exist.

    name: its name in YAML or its type in XML.
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
    """The tables for the installed plug-ins; they are made again only when plug-ins change."""
    global _newest
    found = PLUGINS.installed(), BEHAVIOURS.installed()
    if _newest is None or found[0] is not _newest[0] or found[1] is not _newest[1]:
        _newest = (*found, _read(*found))
    return _newest[2]


_newest: tuple[_Installed, _Installed, _Tables] | None = None
"""The plug-ins from which the tables were made, and the tables."""


def _bridge() -> Any:
    """The module that turns behaviours into leaves; importing it imports py_trees."""
    return _module(ADAPTERS[BEHAVIOURS.name])


def _module(name: str) -> Any:
    """Import a module of nodes by name, so that the tree language does not depend on nodes."""
    return import_module(f"momantu_bt.nodes.{name}")


def _spellings() -> frozenset[str]:
    """YAML names of the built-in nodes."""
    return frozenset(name for kind in _built_in().values() for name in kind.spec.yaml)


@cache
def _built_in() -> Mapping[str, type[NodeClass]]:
    found = {}
    for type_, module in BUILT_IN.items():
        found[type_] = getattr(_module(module), type_)
    return found


def _read(nodes: _Installed, behaviours: _Installed) -> _Tables:
    """The tables of all working nodes. For a broken one, `load` of its group raises the reason."""
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
