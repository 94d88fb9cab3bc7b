"""Keys that a tree shares with the trees that run it: by wires, by defaults, by `_autoremap`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from momantu_bt.formats.places import Place
from momantu_bt.tree.catalogue import AUTOREMAP, SUBTREE
from momantu_bt.tree.check.nodes import autoremaps
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import BROKEN, Literal, Node, PortValue, Reference, Scope, Template, Tree
from momantu_bt.tree.script import Script, ScriptSyntaxError, parse
from momantu_bt.values.kinds import ScriptText

MAX_KEYS = 1000
"""The most different keys of one tree. Each node knows of all the keys before it."""
MAX_SHARED = 50_000
"""The most keys that trees share with trees that run them, added up over all those calls."""
ROOT_MARK = "@"
"""Prefix of a key in a script: it means the key of the root's board."""
_PRIVATE = re.compile("_")
"""The start of keys that are never remapped automatically (BehaviorTree.CPP's rule)."""


@dataclass(frozen=True, slots=True)
class Call:
    """One node that runs a tree."""

    node: Node
    tree: Tree

    def outside(self, key: str) -> Reference | None:
        """The key of the outer tree that the inner tree's key stands for."""
        value = self._value(key)
        if value is not None:
            return value if isinstance(value, Reference) and not value.fields else None
        if autoremaps(self.node) and not _PRIVATE.match(key):
            return Reference(key)
        return None

    def gives_value(self, key: str) -> bool:
        """Whether the call gives this key of the inner tree a value and not a key."""
        return self._value(key) is not None and self.outside(key) is None

    def local(self, keys: Iterable[str]) -> dict[str, str]:
        """Those of the inner keys that are keys of the outer tree, by their names there."""
        inside = set(keys)
        named = {*self.node.ports, *self.tree.ports}
        found: dict[str, str] = {}
        for key in sorted(inside & named):
            reference = self.outside(key)
            if reference is not None and reference.scope is Scope.LOCAL and reference.key != BROKEN:
                found[reference.key] = key
        if autoremaps(self.node):
            others = inside - named - {BROKEN}
            found |= {key: key for key in others if not _PRIVATE.match(key)}
        return found

    def place(self, key: str) -> Place:
        """The place where the call gives the key, or else the node's place."""
        return self.node.port_places.get(key, self.node.place)

    def _value(self, key: str) -> PortValue | None:
        if key in self.node.ports:
            return self.node.ports[key]
        declared = self.tree.ports.get(key)
        return None if declared is None or autoremaps(self.node) else declared.default


@dataclass(slots=True)
class TreeKeys:
    """What is known about a tree's keys, for its callers.

    mentioned: all keys that it reads or writes, itself or by a tree below that shares them.
    written, removed: keys that it may write, and take away. shared: keys that some node wires
    from outside. remapped: whether some node shares them all. needed: keys that it reads and
    may not have written before, with the first place. success, failure: which keys have a
    value after each result. written_as_root: keys of the main tree that any tree writes as the
    root's (`$@key`), at a time that is not followed. succeeds, fails: whether the tree can end
    so at all.
    """

    mentioned: set[str] = field(default_factory=set)
    written: set[str] = field(default_factory=set)
    removed: set[str] = field(default_factory=set)
    shared: set[str] = field(default_factory=set)
    remapped: bool = False
    needed: dict[str, Place] = field(default_factory=dict)
    success: frozenset[str] = frozenset()
    failure: frozenset[str] = frozenset()
    written_as_root: set[str] = field(default_factory=set)
    succeeds: bool = True
    fails: bool = True

    def goes_out(self, key: str) -> bool:
        """Whether anything outside may read the key."""
        return key in self.shared or (self.remapped and not _PRIVATE.match(key))


def shared_keys(context: Context, order: list[Tree]) -> dict[str, TreeKeys] | None:
    """The keys that each tree mentions, writes and removes; None, with a report, if too many.

    order: each tree comes after the trees that it runs.
    """
    found = {tree.name: TreeKeys() for tree in order}
    shared = 0
    on_root: set[str] = set()
    for tree in order:
        keys = found[tree.name]
        for node in tree.root.walk():
            _own_keys(context, node, keys, on_root)
            if node.type == SUBTREE:
                call = call_of(context, node)
                shared += _keys_of_call(call, keys, found[call.tree.name])
                if shared > MAX_SHARED:
                    message = f"trees share more than {MAX_SHARED} keys with those that run them"
                    hint = "share fewer keys, or run it in fewer places"
                    context.problems.error("too-large", node.place, message, hint)
                    return None
        if len(keys.mentioned) > MAX_KEYS:
            message = f"{tree.name!r} has {len(keys.mentioned)} keys; at most {MAX_KEYS}"
            context.problems.error("too-large", tree.place, message, "make trees of its parts")
            return None
    main = found.get(context.document.main)
    if main is not None:
        main.written_as_root = on_root
        main.written |= on_root
    return found


def call_of(context: Context, node: Node) -> Call:
    """The call that a SubTree node makes."""
    return Call(node, context.document.trees[node.target or ""])


def _own_keys(context: Context, node: Node, keys: TreeKeys, on_root: set[str]) -> None:
    """Add the keys that a node mentions itself. on_root: those that it writes as the root's."""
    signature = context.signature(node)
    ports = signature.ports if signature is not None else {}
    spec = signature.spec if signature is not None else None
    removed = spec.removes if spec is not None else None
    for name, value in node.ports.items():
        local = {each.key for each in _references(value) if each.scope is Scope.LOCAL}
        keys.mentioned |= local
        port = ports.get(name)
        by_itself = ("out", "inout") if spec is not None else ("out",)
        if port is None or port.direction in by_itself:
            # an unknown node may write what it names
            keys.written |= local if removed is None else set()
            root = {each.key for each in _references(value) if each.scope is Scope.ROOT}
            on_root |= root if removed is None else set()
        if removed is not None:
            keys.removed |= local
    for script in scripts_of(context, node):
        keys.mentioned |= {v.key for v in (*script.reads, *script.writes)}
        keys.written |= {v.key for v in script.writes}
        on_root |= {v.key[1:] for v in script.writes if v.key.startswith(ROOT_MARK)}


def _keys_of_call(call: Call, keys: TreeKeys, inside: TreeKeys) -> int:
    """Add what a call says of the outer tree's keys. Returns how many keys they share."""
    mentioned = call.local(inside.mentioned)
    keys.mentioned |= mentioned.keys()
    keys.written |= call.local(inside.written).keys()
    keys.removed |= call.local(inside.removed).keys()
    inside.remapped = inside.remapped or autoremaps(call.node)
    inside.shared |= {name for name in call.node.ports if name != AUTOREMAP}
    inside.shared |= {name for name, port in call.tree.ports.items() if port.default is not None}
    return len(mentioned)


def scripts_of(context: Context, node: Node) -> Iterator[Script]:
    """The scripts of a node's ports and conditions. Scripts that cannot be read are left out."""
    signature = context.signature(node)
    ports = signature.ports if signature is not None else {}
    texts = list(node.conditions.values())
    for name, value in node.ports.items():
        port = ports.get(name)
        if port is not None and port.type is ScriptText and isinstance(value, Literal):
            texts.append(str(value.value))
    for text in texts:
        try:
            yield parse(text)
        except ScriptSyntaxError:
            continue


def _references(value: PortValue) -> list[Reference]:
    if isinstance(value, Reference):
        return [value]
    if isinstance(value, Template):
        return [part for part in value.parts if isinstance(part, Reference)]
    return []
