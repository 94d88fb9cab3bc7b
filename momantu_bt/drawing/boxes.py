"""Turn a document into boxes and lines between them, the base of every kind of picture.

A box is a node with the decorators around it; each node of the document is in one box.
"""

from __future__ import annotations

from dataclasses import dataclass

from momantu_bt.drawing.wires import Wire, wires
from momantu_bt.formats.places import cells
from momantu_bt.tree.catalogue import NODES, SUBTREE
from momantu_bt.tree.model import Document, Handler, Node, Tree
from momantu_bt.tree.registry import Registry
from momantu_bt.tree.show.printing import (
    below,
    extra_texts,
    handler_text,
    heading,
    port_texts,
    title,
    unwrap,
)

WIDEST = 56
"""Longest line in a box, in terminal cells; the rest is cut."""
COLOURS = {
    "control": "#dbe7f6",
    "decorator": "#ece4f5",
    "leaf": "#f1efe6",
    "skill": "#dcf0dd",
    "subtree": "#fbe9c6",
}
"""Fill colour of each kind of box."""
SKILL = "skill"
"""The kind of a box that is neither a built-in node nor a `subtree`."""


@dataclass(frozen=True, slots=True)
class Box:
    """One node of a tree with its decorators.

    number: unique in the picture. kind: control, decorator, leaf, skill or subtree. parent: number
    of the box above. role: its role for the parent ("then", "on TOO_FAR"), or "". nodes: the node
    and its decorators, outermost first.
    """

    number: int
    depth: int
    kind: str
    title: str
    lines: tuple[str, ...]
    nodes: tuple[Node, ...]
    parent: int | None = None
    role: str = ""


@dataclass(frozen=True, slots=True)
class Thread:
    """A wire between two boxes of one tree. key: as the tree spells it."""

    key: str
    writer: int
    reader: int


@dataclass(frozen=True, slots=True)
class TreePicture:
    """One tree. title: its name, its inputs and its outputs."""

    name: str
    title: str
    boxes: tuple[Box, ...]
    threads: tuple[Thread, ...]


def pictures(document: Document, registry: Registry) -> list[TreePicture]:
    """The main tree and, after it, the others, in the order of the file."""
    found = wires(document, registry)
    others = [tree for name, tree in document.trees.items() if name != document.main]
    made: list[TreePicture] = []
    first = 1
    for tree in (document.trees[document.main], *others):
        boxes = _boxes(tree, first)
        first += len(boxes)
        made.append(TreePicture(tree.name, heading(tree), boxes, _threads(tree, boxes, found)))
    return made


def _boxes(tree: Tree, first: int) -> tuple[Box, ...]:
    boxes: list[Box] = []
    stack: list[tuple[Node, int, int | None, str]] = [(tree.root, 0, None, "")]
    while stack:
        outer, depth, parent, role = stack.pop()
        node, around = unwrap(outer)
        number = first + len(boxes)
        inside: list[tuple[Node, int, int | None, str]] = []
        again: list[str] = []
        for name, each in below(node):
            if not isinstance(each, Handler):
                inside.append((each, depth + 1, number, name))
            elif each.node is not None:
                inside.append((each.node, depth + 1, number, handler_text(each)))
            else:
                again.append(f"{handler_text(each)}: try again")
        lines = [*port_texts(node), *extra_texts(node, around), *again]
        boxes.append(
            Box(
                number,
                depth,
                _kind(node),
                cut(title(node)),
                tuple(map(cut, lines)),
                (node, *around),
                parent,
                role,
            )
        )
        stack += reversed(inside)
    return tuple(boxes)


def _kind(node: Node) -> str:
    if node.type == SUBTREE:
        return "subtree"
    spec = NODES.get(node.type)
    return SKILL if spec is None else str(spec.kind)


def _threads(tree: Tree, boxes: tuple[Box, ...], found: list[Wire]) -> tuple[Thread, ...]:
    where = {id(node): box.number for box in boxes for node in box.nodes}
    threads: dict[Thread, None] = {}
    for wire in found:
        for writer in wire.writers:
            for reader in wire.readers:
                ends = where.get(id(writer.node)), where.get(id(reader.node))
                if ends[0] is not None and ends[1] is not None and ends[0] != ends[1]:
                    threads[Thread(wire.spelling(tree.name), ends[0], ends[1])] = None
    return tuple(threads)


def width_of(text: str) -> int:
    """The width of a text in cells of a terminal."""
    return sum(map(cells, text))


def cut(text: str) -> str:
    """A text on one line, at most `WIDEST` cells wide, without what cannot be printed."""
    plain = "".join(c if c.isprintable() else " " for c in text)
    if width_of(plain) <= WIDEST:
        return plain
    while width_of(plain) >= WIDEST:
        plain = plain[: max(1, len(plain) * WIDEST // width_of(plain)) - 1]
    return plain + "…"
