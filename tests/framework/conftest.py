"""Random documents: every node, modifier and kind of value, right in form."""

import random
from collections.abc import Callable, Sequence
from typing import Any

import pytest

from momantu_bt.formats.places import Place
from momantu_bt.skill import Port
from momantu_bt.tree.catalogue import CONDITIONS, NODES, SUBTREE, Kind, NodeSpec
from momantu_bt.tree.model import (
    FIRST_INPUT,
    Document,
    Handler,
    Literal,
    Node,
    PortDeclaration,
    PortValue,
    Reference,
    Scope,
    Template,
    Tree,
)
from momantu_bt.values.kinds import ScriptText

TREE_NAMES = ("Main", "Take", "Put")
_TEXTS = (
    "a",
    "home",
    "yes",
    "010",
    "5",
    "a: b",
    "#",
    "$",
    "{x}",
    "é 木",
    "x\ny",
    " a ",
    "",
    "null",
)
_TEXTS += (
    "true",
    "it's",
    '"',
    "\\",
    "\t",
    "66 mm",
    "a,b",
    "- a",
    "\x07",
    "1;2;3",
    "2.50",
    "<&>",
    "--",
)
_NAMES = tuple(text for text in _TEXTS if text and "\x07" not in text)
_KEYS = ("a", "found", "n", "target_pose", "größe")
_PORTS = ("object", "at", "side", "name", "timeout", "ID", "_x", "a b", "5", "note", "value")
_SCRIPTS = ("a > 1", "!a && b", "a && b || c", "!a == 1", "n := 'x: y'", "x = a ? b : c; @y += 1")
_SCRIPTS += ('a == "<&>"', "true", "and > 1", "{} := 1".format("n"), "a.b >= -1.5")
_CODES = (("any",), ("OH_NO",), ("A", "pick.SLIPPED"), ("TIMEOUT",))
_HERE = Place("t.yaml", 1, 1)


class Sower:
    """Random documents that are right in form: every node, every kind of value and modifier."""

    def __init__(self, seeded: random.Random) -> None:
        self.random = seeded

    def document(self) -> Document:
        r = self.random
        names = TREE_NAMES[: r.randint(1, 3)]
        trees = {name: self.tree(name, names) for name in names}
        values = {key: Literal(self.plain(2)) for key in self.some(_KEYS)}
        world = r.choice([None, "four_rooms", "none", "5"])
        goal = r.choice([None, Literal("none"), Literal("can on desk"), Literal(self.plain(2))])
        return Document("t.yaml", r.choice(names), trees, world, values, goal)

    def some(self, names: Sequence[Any]) -> list[Any]:
        return self.random.sample(names, self.random.randint(0, min(3, len(names))))

    def tree(self, name: str, names: Sequence[str]) -> Tree:
        r = self.random
        ports = {}
        for key in self.some(_KEYS):
            default = r.choice([None, None, Literal(self.plain(1)), Reference("outside")])
            direction, type_ = r.choice(["in", "out", "inout"]), r.choice(["any", "list of pose"])
            doc = r.choice(["", "a: b"])
            ports[key] = PortDeclaration(key, direction, type_, _HERE, default, doc)
        doc = r.choice(["", "", "What it does: # all", "two\nlines"])
        opened = not ports and r.random() < 0.3
        return Tree(name, self.node(names, r.randint(0, 4)), _HERE, ports, doc, opened)

    def node(self, names: Sequence[str], depth: int) -> Node:
        r = self.random
        kind = r.random()
        if depth == 0 or kind < 0.25:
            node = self.leaf(names)
        else:
            inner = [spec for spec in NODES.values() if spec.kind is not Kind.LEAF]
            node = self.inner(r.choice(inner), names, depth)
        if r.random() < 0.2:
            node.name, node.disabled = r.choice([None, *_NAMES]), r.random() < 0.5
            node.note = r.choice([None, *_NAMES])
            node.conditions = {key: r.choice(_SCRIPTS) for key in self.some(CONDITIONS)}
        return node

    def leaf(self, names: Sequence[str]) -> Node:
        r = self.random
        kind = r.randint(0, 3)
        if kind == 0:
            return Node(r.choice(("pick", "un_known", "two words")), _HERE, ports=self.any_ports())
        if kind == 1:
            ports = {key: self.value() for key in self.some(_KEYS)}
            return Node(SUBTREE, _HERE, ports=ports, target=r.choice(names))
        specs = [spec for spec in NODES.values() if spec.kind is Kind.LEAF]
        return self.with_ports(r.choice(specs))

    def any_ports(self) -> dict[str, PortValue]:
        if self.random.random() < 0.2:
            return {FIRST_INPUT: Literal(self.random.choice([*_TEXTS, 5, 0.5, True]))}
        return {name: self.value() for name in self.some(_PORTS)}

    def with_ports(self, spec: NodeSpec) -> Node:
        r = self.random
        node = Node(spec.type, _HERE)
        excluded = {name for group in spec.one_of for name in r.sample(group, len(group) - 1)}
        for name, port in spec.ports.items():
            if name in excluded or (not port.required and r.random() < 0.5):
                continue
            node.ports[name] = self.value(port)
        return node

    def inner(self, spec: NodeSpec, names: Sequence[str], depth: int) -> Node:
        r = self.random
        node = self.with_ports(spec)
        least, most = spec.children
        count = r.randint(least, most if most is not None else least + 2)
        node.children = [self.node(names, depth - 1) for _ in range(count)]
        if spec.handlers:
            for codes in r.sample(_CODES, r.randint(1, 3)):
                again = spec.type == "Recover" and r.random() < 0.4
                below = None if again else self.node(names, depth - 1)
                node.handlers.append(Handler(codes, below, _HERE))
        return node

    def value(self, port: Port | None = None) -> PortValue:
        r = self.random
        if port is not None and port.type is ScriptText:
            return Literal(r.choice(_SCRIPTS))
        if port is not None and port.direction == "out":
            return self.reference(())
        kind = r.randint(0, 5)
        if kind == 0:
            return self.reference(r.choice([(), ("pose",), ("pose", "x")]))
        if kind == 1:
            parts = [self.reference(()), r.choice(["$5 ", "a", ": "]), self.reference(("b",))]
            return Template(tuple(parts[slice(*r.choice([(1,), (2,), (3,), (1, 3)]))]))
        return Literal(self.plain(2))

    def reference(self, fields: tuple[str, ...]) -> Reference:
        return Reference(self.random.choice(_KEYS), fields, self.random.choice(list(Scope)))

    def plain(self, depth: int) -> Any:
        r = self.random
        kind = r.randint(0, 8 if depth else 6)
        if kind <= 3:
            return r.choice(_TEXTS)
        if kind <= 6:
            return r.choice([0, 1, -3, 10**20, 0.5, -1e-07, 1e22, 1.0, True, False, None])
        items = [self.plain(depth - 1) for _ in range(r.randint(0, 2))]
        return items if kind == 7 else {r.choice(_TEXTS): item for item in items}


@pytest.fixture(scope="session")
def random_document() -> Callable[[random.Random], Document]:
    """A random document that is right in form; places and comments aside, all there can be."""
    return lambda seeded: Sower(seeded).document()
