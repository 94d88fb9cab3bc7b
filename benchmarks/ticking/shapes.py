"""Trees of built-in leaves, and the same trees of bare py_trees behaviours."""

from __future__ import annotations

from pathlib import Path

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Composite, Selector, Sequence

from momantu_bt.engine.build import Built, build
from momantu_bt.engine.context import RunContext
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.fingerprint import Fingerprint
from momantu_bt.formats.places import Place
from momantu_bt.record.recorder import Recorder
from momantu_bt.running.options import RunOptions
from momantu_bt.testing import ManualClock
from momantu_bt.tree.model import Document, Literal, Node, PortValue, Reference, Tree
from momantu_bt.world_plugins import NoWorld
from ticking.measuring import Tick

GROUP = 9
"""Leaves of a group; with the group itself ten nodes."""
SHAPES = ("walk", "fallback", "running")
HERE = Place("tick.yaml", 1, 1)


class Bare(Behaviour):
    """A plain leaf: a constant status."""

    def __init__(self, name: str, result: Status) -> None:
        super().__init__(name)
        self.result = result

    def update(self) -> Status:
        """The same status each time."""
        return self.result


def bare(shape: str, nodes: int) -> Tick:
    """A py_trees tree and what ticks it once."""
    groups: list[Behaviour] = []
    for number in range(groups_of(nodes)):
        made: Composite = (Selector if shape == "fallback" else Sequence)(f"g{number}", memory=True)
        made.add_children(
            [Bare(f"l{number}_{i}", bare_result(shape, number, i, nodes)) for i in range(GROUP)]
        )
        groups.append(made)
    root = Sequence("root", memory=True, children=groups)
    return root.tick_once


def bare_result(shape: str, group: int, leaf: int, nodes: int) -> Status:
    last_leaf = leaf == GROUP - 1
    if shape == "fallback":
        return Status.SUCCESS if last_leaf else Status.FAILURE
    running = shape == "running" and last_leaf and group == groups_of(nodes) - 1
    return Status.RUNNING if running else Status.SUCCESS


def groups_of(nodes: int) -> int:
    return max(1, nodes // (GROUP + 1))


def node(type_: str, ports: dict[str, PortValue] | None = None, children: tuple = ()) -> Node:
    return Node(type_, HERE, ports or {}, list(children))


def document_of(shape: str, nodes: int) -> Document:
    """The same tree as a document, with ports on every leaf."""
    groups = [
        node(
            "Fallback" if shape == "fallback" else "Sequence",
            children=tuple(leaf(shape, number, i, nodes) for i in range(GROUP)),
        )
        for number in range(groups_of(nodes))
    ]
    tree = Tree("Main", node("Sequence", children=tuple(groups)), HERE)
    return Document("tick.yaml", "Main", {"Main": tree})


def ours(document: Document) -> Built:
    """It in our engine."""
    built = build(document, RunContext(ManualClock()), {}.__getitem__)
    built.board.set("a", 1.5)
    return built


def leaf(shape: str, group: int, index: int, nodes: int) -> Node:
    last = index == GROUP - 1
    if shape == "fallback" and not last:
        return node("Fail", {"code": Literal("NO_WAY"), "message": Literal("closed")})
    if shape == "running" and last and group == groups_of(nodes) - 1:
        return node("Sleep", {"duration": Literal("1000 h")})
    return node("SetBlackboard", {"key": Reference(f"k{group}_{index}"), "value": Reference("a")})


def plain_tick(built: Built) -> Tick:
    """A tick without observers."""
    context = built.root.context

    def tick() -> None:
        context.begin_tick()
        built.root.execute()

    return tick


def recorded_tick(document: Document, built: Built, folder: Path) -> Tick:
    """A tick with all that a recorded run does in it."""
    context = built.root.context
    run = Executor(built, context, NoWorld())
    run.fingerprint = Fingerprint()
    recorder = Recorder(folder / "record", context.events, print)
    recorder.begin(document, run, RunOptions().recorded(), {})

    def tick() -> None:
        context.begin_tick()
        built.root.execute()
        run._note()

    return tick


def sides(shape: str, nodes: int, folder: Path) -> dict[str, Tick]:
    """What ticks each tree once."""
    document = document_of(shape, nodes)
    return {
        "bare": bare(shape, nodes),
        "ours": plain_tick(ours(document)),
        "recorded": recorded_tick(document, ours(document), folder),
    }
