"""Which keys each node of a tree, or something below it, writes or takes away.

All nodes are handled once, from the leaves up. Loops and conditions look up the result.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.catalogue.known import Key, literal_type
from momantu_bt.tree.check.keys.shared import TreeKeys, call_of
from momantu_bt.tree.check.signatures import Context, Signature
from momantu_bt.tree.model import Literal, Node, Reference, Scope, Tree
from momantu_bt.values.kinds import ValueType

Rewrites = dict[tuple[str, ValueType], Key]
"""The keys that nodes write: each with every type it gets, and the first place for the type."""


class KeyChanges:
    """The changes of one tree's keys. keys: what is known of each tree that this one runs."""

    def __init__(self, context: Context, tree: Tree, keys: Mapping[str, TreeKeys]) -> None:
        self.context, self.tree, self.keys = context, tree, keys
        self._removals = self._all_removals()
        self._rewrites = self._all_rewrites()

    def rewritten(self, node: Node) -> Iterable[tuple[str, Key]]:
        """What is known of the board's keys that the node, or something below it, writes."""
        return ((name, key) for (name, _), key in self._rewrites[id(node)].items())

    def _all_rewrites(self) -> dict[int, Rewrites]:
        """For each node of the tree, the keys that it, or something below it, writes."""
        found: dict[int, Rewrites] = {}
        for node in reversed(list(self.tree.root.walk())):
            handlers = (handler.node for handler in node.handlers if handler.node is not None)
            parts = [self._own_rewrites(node)]
            parts += [found[id(each)] for each in (*node.children, *handlers)]
            writing = [part for part in parts if part]
            if len(writing) == 1:
                # in long chains of nodes with one child, all share the keys written at the end
                found[id(node)] = writing[0]
                continue
            each_once = found[id(node)] = {}
            for part in writing:
                for written, key in part.items():
                    each_once.setdefault(written, key)
        return found

    def _own_rewrites(self, node: Node) -> Rewrites:
        found: Rewrites = {}
        signature = self.context.signature(node)
        if signature is None or node.disabled:
            return found
        for name, value in node.ports.items():
            port = signature.ports.get(name)
            if port is None or port.direction != "out" or not isinstance(value, Reference):
                continue
            if value.scope is Scope.LOCAL and not value.fields:
                place = node.port_places.get(name, node.place)
                for written in _types(node, port, signature):
                    if written is not object:
                        found.setdefault((value.key, written), Key(written, place))
        return found

    def removed(self, *nodes: Node) -> set[str]:
        """Keys of the tree's board that the nodes, or something below them, may take away."""
        return set().union(*(self._removals[id(node)] for node in nodes))

    def _all_removals(self) -> dict[int, frozenset[str]]:
        """For each node of the tree, the keys that it, or something below it, may take away."""
        found: dict[int, frozenset[str]] = {}
        for node in reversed(list(self.tree.root.walk())):
            handlers = (handler.node for handler in node.handlers if handler.node is not None)
            below = {found[id(each)] for each in (*node.children, *handlers)}
            found[id(node)] = frozenset(self._own_removals(node)).union(*below)
        return found

    def _own_removals(self, node: Node) -> Iterable[str]:
        spec = NODES.get(node.type)
        key = node.ports.get(spec.removes or "") if spec is not None else None
        if isinstance(key, Reference) and key.scope is Scope.LOCAL:
            return [key.key]
        if node.type != SUBTREE:
            return []
        call = call_of(self.context, node)
        return call.local(self.keys[call.tree.name].removed)


def _types(node: Node, port: Port, signature: Signature) -> list[ValueType]:
    """The possible values of a node's output."""
    copies = signature.spec.copies if signature.spec is not None else {}
    given = node.ports.get(copies.get(port.name, ""))
    if isinstance(given, Literal):
        return [literal_type(given)]
    item = signature.spec.item if signature.spec is not None else None
    items = node.ports.get(item[1]) if item is not None else None
    if port.type is object and isinstance(items, Literal) and isinstance(items.value, list):
        return [literal_type(Literal(each)) for each in items.value]
    return [port.type]
