"""Count which parts of a tree ran over many episodes: nodes, handlers, both sides of guards."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.bench.rows.spec import Row
from momantu_bt.engine.conditions import ASKED
from momantu_bt.formats.places import Place
from momantu_bt.tree.catalogue import SUBTREE
from momantu_bt.tree.model import Document, Node

NODE, HANDLER, GUARD = "node", "handler", "guard"


@dataclass(slots=True)
class Point:
    """One thing in a tree file that can happen or not.

    kind: NODE, HANDLER (an entry under `catch`) or GUARD (`skip_if` and the like). text: its name
    in the file. count: how often the node started, the handler answered or the guard held.
    asked: for a guard, how often it was evaluated.
    """

    kind: str
    place: Place
    text: str
    count: int = 0
    asked: int = 0

    @property
    def covered(self) -> bool:
        """Whether it happened; of a guard, whether it did both, hold and not hold."""
        return 0 < self.count < self.asked if self.kind == GUARD else self.count > 0

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        asked = {"asked": self.asked} if self.kind == GUARD else {}
        where = {"file": self.place.file, "line": self.place.line}
        return {"kind": self.kind, **where, "text": self.text, "count": self.count, **asked}


@dataclass(slots=True)
class _Counted:
    """The points of one node of the file, however often the tree has it."""

    node: Point
    guards: dict[str, Point] = field(default_factory=dict)
    handlers: list[Point] = field(default_factory=list)

    def add(self, told: dict[str, Any]) -> None:
        """Add what one episode says about one of its occurrences."""
        self.node.count += told.get("runs", 0)
        for name, (asked, held) in told.get("conditions", {}).items():
            self.guards[name].asked += asked
            self.guards[name].count += held
        for number, answered in enumerate(told.get("answered", ())):
            self.handlers[number].count += answered


def coverage(document: Document, rows: Iterable[Row]) -> list[Point]:
    """All points of the file and of those it includes, with counts over rows of this document.

    Nodes that the main tree never reaches have count 0, like nodes that never ran.
    """
    counted = {
        id(node): _counted(node) for tree in document.trees.values() for node in tree.root.walk()
    }
    order = [counted[id(node)] for node in running_order(document)]
    for row in rows:
        if "nodes" in row:
            for each, told in zip(order, row["nodes"], strict=True):
                each.add(told)
    return [point for each in counted.values() for point in _points(each)]


def running_order(document: Document) -> Iterator[Node]:
    """Nodes in the order of a report's: a subtree's stand wherever it is used."""
    stack = [document.trees[document.main].root]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(_below(node, document)))


def _below(node: Node, document: Document) -> Sequence[Node]:
    if node.disabled:
        return ()
    if node.type == SUBTREE:
        return (document.trees[node.target or ""].root,)
    handlers = [handler.node for handler in node.handlers if handler.node is not None]
    return [*node.children, *handlers]


def _counted(node: Node) -> _Counted:
    name = node.name or node.target or node.type
    guards = {
        key: Point(GUARD, node.condition_places.get(key, node.place), f"{key}: {script}")
        for key, script in node.conditions.items()
        if key in ASKED
    }
    handlers = [
        Point(HANDLER, handler.place, " | ".join(handler.codes)) for handler in node.handlers
    ]
    return _Counted(Point(NODE, node.place, name), guards, handlers)


def _points(counted: _Counted) -> Iterator[Point]:
    yield counted.node
    yield from counted.guards.values()
    yield from counted.handlers
