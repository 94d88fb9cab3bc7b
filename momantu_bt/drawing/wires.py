"""Find the wires of a document: which node writes what another one reads."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from momantu_bt.formats.places import Place
from momantu_bt.tree.check.keys.reads import references
from momantu_bt.tree.check.root_keys import ROBOT_KEY
from momantu_bt.tree.check.signatures import Context
from momantu_bt.tree.language import FAILURE_KEY
from momantu_bt.tree.model import Document, Literal, Node, Reference, Scope, Tree
from momantu_bt.tree.problems import Problems
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.script import ScriptSyntaxError, parse
from momantu_bt.values.kinds import ScriptText

CALLER = "the caller"
"""Who writes the inputs of a subtree, and reads its outputs."""
VALUES = "values"
"""Who writes the first keys of the root's board."""


@dataclass(frozen=True, slots=True)
class End:
    """One end of a wire. said: the node as the file writes it, or another source.

    node: None if it is not a node. tree: the tree that it stands in.
    """

    said: str
    place: Place | None
    tree: str
    node: Node | None = field(default=None, compare=False)


@dataclass(slots=True)
class Wire:
    """A key of one board with everything that writes and reads it, in the order of the file.

    tree: the tree that owns the board; the root's board belongs to the main tree, and published
    keys belong to no tree ("").
    """

    tree: str
    key: str
    writers: list[End] = field(default_factory=list)
    readers: list[End] = field(default_factory=list)

    def touches(self, tree: str) -> bool:
        """Whether a tree writes or reads it; a value that nothing reads is not a wire."""
        ends = (*self.writers, *self.readers)
        return any(end.tree == tree for end in ends) and any(end.node for end in ends)

    def spelling(self, tree: str) -> str:
        """The key as that tree writes it."""
        return f"${self.key}" if tree == self.tree else f"$@{self.key}"


def wires(document: Document, registry: Registry) -> list[Wire]:
    """All wires of a checked document, in the order in which the keys are met."""
    return list(_Wiring(document, registry).wires.values())


class _Wiring:
    def __init__(self, document: Document, registry: Registry) -> None:
        self.document = document
        self.context = Context(document, registry, Problems())
        self.published = {ROBOT_KEY: "the robot"}
        self.published |= {name: f"the service {name}" for name in registry.services}
        self.wires: dict[tuple[str, str], Wire] = {}
        self.joined: set[tuple[int, End, int]] = set()
        for name, place in document.value_places.items():
            self._write(document.trees[document.main], name, End(VALUES, place, document.main))
        for tree in document.trees.values():
            self._tree(tree)

    def _tree(self, tree: Tree) -> None:
        for port in tree.ports.values():
            end = End(CALLER, port.place, tree.name)
            if port.direction != "out":
                self._write(tree, port.name, end)
            if port.direction != "in":
                self._read(tree, port.name, end)
        stack: list[tuple[Node, Node | None]] = [(tree.root, None)]
        while stack:
            node, caught = stack.pop()
            self._node(tree, node, caught)
            handled = [(h.node, node) for h in node.handlers if h.node is not None]
            stack += reversed([*((child, caught) for child in node.children), *handled])

    def _node(self, tree: Tree, node: Node, caught: Node | None) -> None:
        end = self._end(tree, node)
        for reading, name in self._uses(node):
            if reading and name == FAILURE_KEY and caught is not None:
                self._write(tree, name, self._end(tree, caught))
            (self._read if reading else self._write)(tree, name, end)

    def _end(self, tree: Tree, node: Node) -> End:
        signature = self.context.signature(node)
        said = node.name or node.target or (signature.said if signature else node.type)
        return End(said, node.place, tree.name, node)

    def _uses(self, node: Node) -> Iterator[tuple[bool, str]]:
        """(whether it reads, the key); a key of the root's board begins with `@`."""
        signature = self.context.signature(node)
        ports = signature.ports if signature is not None else {}
        for name, value in node.ports.items():
            port = ports.get(name)
            direction = "inout" if port is None else port.direction
            if port is not None and port.type is ScriptText and isinstance(value, Literal):
                yield from _script_uses(str(value.value))
            for reference in references(value):
                key = _spelled(reference)
                if direction != "out":
                    yield True, key
                if direction != "in" and value is reference:
                    yield False, key
        for script in node.conditions.values():
            yield from _script_uses(script)

    def _write(self, tree: Tree, key: str, end: End) -> None:
        self._join(self._wire(tree, key).writers, end)

    def _read(self, tree: Tree, key: str, end: End) -> None:
        self._join(self._wire(tree, key).readers, end)

    def _join(self, ends: list[End], end: End) -> None:
        at = (id(ends), end, id(end.node))
        if at not in self.joined:
            self.joined.add(at)
            ends.append(end)

    def _wire(self, tree: Tree, key: str) -> Wire:
        board, name = tree.name, key.removeprefix("@")
        if key.startswith("@"):
            board = "" if name in self.published else self.document.main
        if (board, name) not in self.wires:
            wire = self.wires[board, name] = Wire(board, name)
            if not board:
                wire.writers.append(End(self.published[name], None, board))
        return self.wires[board, name]


def _script_uses(text: str) -> Iterator[tuple[bool, str]]:
    try:
        script = parse(text)
    except ScriptSyntaxError:  # pragma: no cover - the checker has refused the document before
        return
    for variable in script.reads:
        yield True, variable.key
    for variable in script.writes:
        yield False, variable.key


def _spelled(reference: Reference) -> str:
    return f"@{reference.key}" if reference.scope is Scope.ROOT else reference.key


def wire_lines(document: Document, found: list[Wire], tree: str) -> Iterator[str]:
    """The wires of one tree in words: `$seen  from scan (12)  to grip (14, 17)`.

    Numbers are lines of the tree's own file; a line of another file comes after that file's name.
    """
    file = document.trees[tree].place.file
    rows = [
        (wire.spelling(tree), _ends(file, wire.writers), _ends(file, wire.readers))
        for wire in found
        if wire.touches(tree)
    ]
    widths = [max((len(row[column]) for row in rows), default=0) for column in (0, 1)]
    for key, writers, readers in rows:
        line = f"{key:{widths[0]}}  from {writers:{widths[1]}}"
        yield f"{line}  to {readers}" if readers else line.rstrip()


def _ends(file: str, ends: list[End]) -> str:
    said: dict[str, list[str]] = {}
    for end in ends:
        lines = said.setdefault(end.said, [])
        if end.node is not None and end.place is not None:
            other = "" if end.place.file == file else f"{Path(end.place.file).name}:"
            lines.append(f"{other}{end.place.line}")
    return ", ".join(f"{who} ({', '.join(at)})" if at else who for who, at in said.items())
