"""The notation of node tables: one node with scripted leaves, and what came of each tick and reset.

    Fallback [FS RF] 0F1R=R 1F=F ~ 0S=S

is a fallback of two leaves. In the first tick child 0 returned FAILURE, child 1 RUNNING, and the
node RUNNING; then it failed; `~` is a reset, as a parent does it; then child 0 succeeded. `0!` says
that child 0 was halted while it ran. `k:=1` writes a key, `k:=` clears it. Behind `/` stands the
value of the key `v` or `i`. Letters: R S F K (skipped). A tick takes 0.05 s.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, replace
from typing import Any, cast

from momantu_bt.engine.blackboard import Board, Cell
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.subtree import SubTree
from momantu_bt.formats.places import Place
from momantu_bt.geometry import Pose2D
from momantu_bt.skill import MISSING
from momantu_bt.tree.catalogue import NODE_CLASSES, NODES
from momantu_bt.tree.files.xml.values import attribute_value
from momantu_bt.tree.model import Literal, Node, PortValue, Reference
from tests.framework.engine.conftest import Bench, Leaf

_ROW = re.compile(r"(?P<head>[^\[]+)\[(?P<kids>[^\]]*)\] (?P<trace>.+)")
_WATCHED = {"PersistentSequence": "i"}

PATHS: dict[str, tuple[Any, ...]] = {
    "none": (),
    "list": (1, 2, 3),
    "more": (1, 2, 2, 3),
    "near": (Pose2D(0, 0, 0), Pose2D(1, 0, 0)),
    "detour": (Pose2D(0, 0, 0), Pose2D(0, 2, 0), Pose2D(1, 2, 0), Pose2D(1, 0, 0)),
    "elsewhere": (Pose2D(0, 0, 0), Pose2D(4, 0, 0), Pose2D(2, 0, 0)),
}
"""Values of keys that no attribute can say."""


@dataclass(frozen=True, slots=True)
class Row:
    """One line of a table."""

    type: str
    attributes: dict[str, str]
    kids: tuple[str, ...]
    trace: tuple[str, ...]
    text: str


def rows(text: str) -> list[Row]:
    """The rows of a table; lines that begin with `#` are remarks."""
    return [_row(line) for line in text.splitlines() if line and not line.startswith("#")]


def _row(line: str) -> Row:
    match = _ROW.fullmatch(line)
    assert match is not None, line
    type_, *pairs = shlex.split(match["head"])
    attributes = dict(pair.split("=", 1) for pair in pairs)
    return Row(type_, attributes, tuple(match["kids"].split()), tuple(match["trace"].split()), line)


class Telling(Leaf):
    """A scripted leaf that tells what it returns and when it is halted."""

    def __init__(self, bench: Bench, script: str, index: int, events: list[str]) -> None:
        super().__init__(bench.model("AlwaysSuccess", f"leaf{index}"), bench.context, script)
        self.told = index
        self.events = events

    def step(self) -> Any:
        status = super().step()
        letter = "K" if status.name == "SKIPPED" else status.name[0]
        self.events.append(f"{self.told}{letter}")
        return status

    def clear(self) -> None:
        super().clear()
        self.events.append(f"{self.told}!")


def played(row: Row) -> tuple[str, ...]:
    """What our node does where the row says what is right; in the row's notation."""
    bench, events = Bench(), list[str]()
    kids = [Telling(bench, script, i, events) for i, script in enumerate(row.kids)]
    node = made(bench, row, kids)
    found = []
    for step in row.trace:
        events.clear()
        if ":=" in step:
            key, text = step.split(":=")
            bench.board.set(key, natural(text) if text else MISSING)
            found.append(step)
            continue
        if "~" in step:
            node.reset()
            ending = "~"
        else:
            ending = f"={bench.tick(node)}"
        if not any("RK" in script for script in row.kids):  # a leaf that is skipped while it runs
            assert_consistent(node)
        found.append("".join(events) + ending + _watched(bench, row, step))
    return tuple(found)


def assert_consistent(node: TreeNode) -> None:
    """What holds of a node and its leaves after every tick and reset."""
    for each in (node, *node.below):
        assert (each.state.name == "RUNNING") <= (node.state.name == "RUNNING")
    if node.state.name == "IDLE":
        assert not any(each.shown.name == "RUNNING" for each in (node, *node.below))


def made(bench: Bench, row: Row, kids: list[Telling]) -> TreeNode:
    """The node of a row, its ports read as an XML file's attributes are."""
    spec = NODES.get(row.type)
    names = {xml: port for port, xml in spec.xml.items()} if spec is not None else {}
    model = Node(row.type, Place("test.yaml", 1, 1))
    for attribute, text in row.attributes.items():
        port = names.get(attribute, attribute)
        assert spec is not None
        assert port in spec.ports, f"{row.type} has no port {port}"
        model.ports[port] = _value(port, text, spec)
    parts = Parts(model, bench.context, bench.board, kids=tuple(kids))
    if row.type == "SubTree":
        return SubTree(parts, given={}, constants={}, wires={}, board=Board([]))
    assert spec is not None
    answers = tuple((("any",), kid) for kid in kids[1:2]) if spec.handlers else ()
    caught = Cell("failure", bench.context.writes)
    kind = cast(type[TreeNode], NODE_CLASSES[row.type])
    return kind(replace(parts, ports=spec.ports, answers=answers, caught=caught))


def _value(port: str, text: str, spec: Any) -> PortValue:
    if port in spec.keys or (spec.ports[port].direction == "out"):
        return Reference(text.strip("{}"))
    return attribute_value(text, port, spec.ports[port].type)


def natural(text: str) -> Any:
    """What XML would write to a key, or one of PATHS."""
    if text in PATHS:
        return PATHS[text]
    value = attribute_value(text, "value", object)
    assert isinstance(value, Literal)
    return value.value


def _watched(bench: Bench, row: Row, step: str) -> str:
    if "/" not in step:
        return ""
    key = _WATCHED.get(row.type, "v")
    if not bench.board.has(key):
        return "/?"
    value = bench.board.get(key)
    return f"/{str(value).lower() if isinstance(value, bool) else value}"
