"""The leaves that a tree file uses and nothing here has: their ports, from models or from uses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.check.declared import declared_port, default_key
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.model import (
    BROKEN,
    FIRST_INPUT,
    Document,
    Literal,
    Node,
    NodeModel,
    PortDeclaration,
    PortValue,
    Reference,
    Template,
    Tree,
)
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry
from momantu_bt.values.convert import convert, natural
from momantu_bt.values.types import label
from momantu_bt.values.words import ConversionError

_PYTHON = {"text": "str", "number": "float", "int": "int", "bool": "bool"}
_OUTPUT_WORDS = frozenset({"out", "output"})
"""Words in the name of a port that say that it is an output."""
_BARE = "value"
"""The name of an input that a YAML file gives without a name."""


@dataclass(frozen=True, slots=True)
class StubPort:
    """A port to write. type: as Python code. default: as Python code; None: a tree must give it."""

    name: str
    direction: str
    type: str
    doc: str
    default: str | None = None


@dataclass(slots=True)
class StubLeaf:
    """A leaf to write.

    lines: where it is used, `file:line`. given: all that trees write at its ports. results: ports
    with keys that only later nodes read, which are outputs.
    """

    name: str
    model: NodeModel | None = None
    lines: list[str] = field(default_factory=list)
    given: dict[str, list[PortValue]] = field(default_factory=dict)
    results: set[str] = field(default_factory=set)

    @property
    def uses(self) -> int:
        """How many nodes there are."""
        return len(self.lines)


def missing_leaves(document: Document, registry: Registry) -> tuple[list[StubLeaf], list[str]]:
    """The leaves that neither the language nor a plug-in has; and the names of those with children.

    Both are in the order of the file.
    """
    context = Context(document, registry, Problems())
    found: dict[str, StubLeaf] = {}
    with_children: dict[str, None] = {}
    for tree in document.trees.values():
        for node in tree.root.walk():
            if node.type in NODES or node.type in (SUBTREE, BROKEN):
                continue
            if context.skill(node.type) is not None:
                continue
            model = context.models.get(node.type)
            if node.children or (model is not None and model.kind in ("Control", "Decorator")):
                with_children[node.type] = None
                continue
            leaf = found.setdefault(node.type, StubLeaf(node.type, model))
            leaf.lines.append(f"{node.place.file}:{node.place.line}")
            for name, value in node.ports.items():
                leaf.given.setdefault(name or _BARE, []).append(value)
            leaf.results |= set(_results(tree, node))
    return list(found.values()), list(with_children)


def ports_of(leaf: StubLeaf) -> list[StubPort]:
    """The ports of a leaf: those of its model, or else those that its uses show."""
    if leaf.model is not None:
        return [_declared(port, leaf) for port in leaf.model.ports]
    return [_used(leaf, name, values) for name, values in leaf.given.items()]


def _declared(declaration: PortDeclaration, leaf: StubLeaf) -> StubPort:
    port = declared_port(declaration)
    type_ = python_type(label(port.type))
    doc = " ".join(declaration.doc.split()) or f"as the model in the file says: {port.direction}"
    direction = port.direction
    if direction == "inout":
        direction = "out" if declaration.name in leaf.results else "in"
    if direction == "out":
        return StubPort(port.name, "out", type_, doc)
    always = len(leaf.given.get(port.name, ())) == leaf.uses
    if declaration.default is None and always:
        return StubPort(port.name, "in", type_, doc)
    default = "None"
    if default_key(declaration) is None and isinstance(declaration.default, Literal):
        try:
            default = repr(convert(declaration.default.value, port))
        except ConversionError:
            default = "None"
    return StubPort(port.name, "in", _optional(type_, default), doc, default)


def _used(leaf: StubLeaf, name: str, values: Sequence[PortValue]) -> StubPort:
    doc = f"as in {leaf.lines[0]}: {_shown(values[0])}"
    if name in leaf.results and not any(isinstance(value, Literal) for value in values):
        return StubPort(name, "out", "object", doc)
    type_ = _guessed(values)
    default = None if len(values) == leaf.uses else "None"
    return StubPort(name, "in", _optional(type_, default), doc, default)


def _optional(type_: str, default: str | None) -> str:
    return f"{type_} | None" if default == "None" and type_ != "object" else type_


def _guessed(values: Sequence[PortValue]) -> str:
    """The type of what trees write out; `object` if some of it comes by wire."""
    kinds = {type(natural(v.value)) if isinstance(v, Literal) else object for v in values}
    if kinds <= {int, float}:
        return "int" if kinds == {int} else "float"
    return next(iter(kinds)).__name__ if kinds in ({bool}, {str}) else "object"


def python_type(name: str) -> str:
    """One of our types as Python code; `object` for those that a stub cannot name."""
    if name.startswith("list of "):
        inner = python_type(name.removeprefix("list of "))
        return f"tuple[{inner}, ...]"
    return _PYTHON.get(name, "object")


def _shown(value: PortValue) -> str:
    if isinstance(value, Reference):
        return f"key {value.key}"
    return repr(value.value) if isinstance(value, Literal) else "a text with keys"


def _results(tree: Tree, node: Node) -> Iterator[str]:
    """Ports of a node whose keys no earlier node of the tree names, and some later one does.

    A port that is named as an output, such as `decision_out`, is one in any case.
    """
    nodes = list(tree.root.walk())
    at = next(number for number, each in enumerate(nodes) if each is node)
    before = {*tree.ports, *(key for each in nodes[:at] for key in _keys(each))}
    after = {key for each in nodes[at + 1 :] for key in _keys(each)}
    for name, value in node.ports.items():
        if not isinstance(value, Reference) or value.fields or name == FIRST_INPUT:
            continue
        named = not _OUTPUT_WORDS.isdisjoint(name.lower().split("_"))
        if named or (value.key in after and value.key not in before):
            yield name


def _keys(node: Node) -> Iterator[str]:
    for value in node.ports.values():
        parts = value.parts if isinstance(value, Template) else (value,)
        yield from (part.key for part in parts if isinstance(part, Reference))
        if isinstance(value, Literal) and isinstance(value.value, str):
            yield from _words(value.value)
    for script in node.conditions.values():
        yield from _words(script)


def _words(text: str) -> Iterator[str]:
    """The words of a text, which may be a script."""
    yield from "".join(c if c.isalnum() or c == "_" else " " for c in text).split()
