"""YAML values at node positions, as nodes of the model. Reads with a queue, not by recursion."""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.formats.names import nearest
from momantu_bt.formats.yaml.values import Entries, Items, Raw, Scalar
from momantu_bt.tree.catalogue import MODIFIERS, NODES, SPELLED, SUBTREE, Kind, NodeSpec
from momantu_bt.tree.catalogue.nodes import DOCTOR, why_broken
from momantu_bt.tree.files.port_values import KEY, drop_duplicates
from momantu_bt.tree.files.queue import Put
from momantu_bt.tree.files.yaml.branches import read_branches, read_switch
from momantu_bt.tree.files.yaml.children import read_control, read_decorator, read_handlers, split
from momantu_bt.tree.files.yaml.kept import is_kept
from momantu_bt.tree.files.yaml.misplaced import indent_branches
from momantu_bt.tree.files.yaml.misspelled import meant_word, mend_branching, mend_companions
from momantu_bt.tree.files.yaml.modifiers import modified, near_modifier
from momantu_bt.tree.files.yaml.named import read_named
from momantu_bt.tree.files.yaml.ports import read_leaf
from momantu_bt.tree.files.yaml.reading import Reading
from momantu_bt.tree.files.yaml.words import COMPANIONS, NAMED, SWITCH
from momantu_bt.tree.language import AGAIN
from momantu_bt.tree.model import Node


@dataclass(frozen=True, slots=True)
class NodeReader:
    """Reads node positions."""

    reading: Reading

    def read(self, raw: Raw, put: Put) -> None:
        """Read one node and all below it, and give it to `put`; BROKEN if it cannot be read."""
        waiting = self.reading.waiting
        waiting.append((raw, put))
        while waiting:
            following, its_put = waiting.popleft()
            its_put(self._node(following))

    def _node(self, raw: Raw) -> Node:
        if isinstance(raw, Items):
            node = Node("Sequence", raw.place)
            self.reading.children(node, raw)
            return node
        if isinstance(raw, Entries):
            return self._mapping(raw)
        if isinstance(raw.value, str) and raw.value:
            return self._named(raw, Scalar(None, "", False, raw.place), [])
        message, hint = "a node is missing", "write its name"
        return self.reading.broken("not-a-node", raw.place, message, hint)

    # a mapping: one node key and its modifiers

    def _mapping(self, raw: Entries) -> Node:
        drop_duplicates(raw, self.reading.problems)
        mend_branching(raw, self.reading.problems)
        chosen = self._node_key(raw)
        if chosen is None:
            written = ", ".join(key.text for key, _ in raw.entries)
            message = f"only modifiers here ({written}), no node" if written else "no node here"
            hint = "write one, such as `wait: 1 s`"
            return self.reading.broken("no-node", raw.place, message, hint)
        key, value = chosen
        if key.text in COMPANIONS:
            mend_companions(key, raw, self.reading.problems)
        beside = [(k, v) for k, v in raw.entries if k is not key]
        key = self._meant(key, value)
        spec = SPELLED.get(key.text)
        if spec is not None and spec.handlers and beside:
            problems = self.reading.problems
            value, beside = indent_branches(key, value, beside, spec.ports, problems)
        companions = {**COMPANIONS, **NAMED}.get(key.text, ())
        others = [(k, v) for k, v in beside if k.text in companions]
        if key.text in NAMED:
            node = read_named(key, value, raw.entries, self.reading)
        else:
            node = self._named(key, value, others)
        modifiers = [(k, v) for k, v in beside if k.text not in companions]
        return modified(node, modifiers, self.reading)

    def _node_key(self, raw: Entries) -> tuple[Scalar, Raw] | None:
        every = {**COMPANIONS, **NAMED}
        companions = {name for key, _ in raw.entries for name in every.get(key.text, ())}
        known = self.reading.is_known
        own = [
            entry
            for entry in raw.entries
            if entry[0].text not in MODIFIERS
            and entry[0].text not in companions
            and not is_kept(entry[0])
        ]
        if not own:
            nodes = [e for e in raw.entries if _decorates(*e)]
            # an attribute stands beside a node: alone, it is a node of that name
            alone = [e for e in raw.entries if e[0].text.startswith("_")]
            return nodes[-1] if nodes else alone[0] if len(alone) == 1 else None
        named = [e for e in own if e[0].text in NAMED]
        if named and not any(known(key.text) for key, _ in own):
            return named[0]
        surely = [e for e in own if known(e[0].text) or not near_modifier(e[0].text)]
        return (surely or own)[0]

    def _meant(self, key: Scalar, value: Raw) -> Scalar:
        """The key; for an unknown one with nodes below it, the near word that has such, reported.

        Names of skills and trees stay.
        """
        name = key.text
        known = self.reading.is_known(name) or name in self.reading.skills
        if known or name in NODES or not KEY.fullmatch(name):
            return key
        near = None if why_broken(name) else meant_word(name, value)
        if near is None:
            return key
        message = f"no node is called {name!r}"
        self.reading.error("unknown-node", key.place, message, f"did you mean {near}?")
        return Scalar(near, near, key.quoted, key.place)

    # one node by its name

    def _named(self, key: Scalar, value: Raw, companions: list[tuple[Scalar, Raw]]) -> Node:
        name = key.text
        refused = self._refused(key)
        if refused is not None:
            return refused
        if name == SWITCH:
            return read_switch(key, value, companions, self.reading)
        spec = SPELLED.get(name)
        if spec is None:
            return self._foreign(key, value)
        node = Node(spec.type, key.place)
        if name in COMPANIONS:
            read_branches(node, value, companions, self.reading)
        else:
            self._below(node, value, spec)
        return node

    def _refused(self, key: Scalar) -> Node | None:
        """A broken node for an invalid name, which is reported; None if the name is valid."""
        name = key.text
        if name == AGAIN:
            message = "`again` stands alone, as a handler of `recover`"
            return self.reading.broken("again", key.place, message)
        if "$" in name:
            return self.reading.broken("not-a-node", key.place, f"{name} is a wire, not a node")
        if (name in NODES and name not in SPELLED) or name == SUBTREE:
            ours = NODES[name].yaml[0] if name in NODES else "the tree's name"
            message, hint = f"no node is called {name!r}", f"did you mean {ours}?"
            return self.reading.broken("unknown-node", key.place, message, hint)
        return None

    def _foreign(self, key: Scalar, value: Raw) -> Node:
        """A skill, or a tree of this document."""
        name = key.text
        target = name if name in self.reading.trees else None
        broken = why_broken(name) if target is None and _has_below(value) else None
        if broken is not None:
            return self.reading.broken("broken-plugin", key.place, broken, DOCTOR)
        node = Node(SUBTREE if target else name, key.place, target=target)
        if target is None and isinstance(value, Entries) and _has_children(value):
            split(node, value, None, ("children",), self.reading)
        else:
            read_leaf(node, value, None, self.reading)
        return node

    def _below(self, node: Node, value: Raw, spec: NodeSpec) -> None:
        if spec.handlers:
            read_handlers(node, value, spec, self.reading)
        elif spec.kind is Kind.CONTROL:
            read_control(node, value, spec, self.reading)
        elif spec.kind is Kind.DECORATOR:
            read_decorator(node, value, spec, self.reading)
        else:
            read_leaf(node, value, spec, self.reading)


def _decorates(key: Scalar, value: Raw) -> bool:
    """Whether a decorator is written as a node: it has a child, perhaps under a wrong name."""
    if MODIFIERS.get(key.text) != "decorator" or not isinstance(value, Entries):
        return False
    near = [nearest(k.text, ("child",), least=0.8) for k, _ in value.entries]
    return any(near) or any(not isinstance(below, Scalar) for _, below in value.entries)


def _has_child(value: Raw) -> bool:
    return isinstance(value, Entries) and any(key.text == "child" for key, _ in value.entries)


def _has_below(value: Raw) -> bool:
    """Whether nodes stand below it. Skills and trees have none."""
    return isinstance(value, Items) or _has_child(value)


def _has_children(value: Entries) -> bool:
    """Whether it has a list of `children`, as an unknown control node has."""
    return any(key.text == "children" and isinstance(raw, Items) for key, raw in value.entries)
