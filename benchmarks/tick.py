"""What a tick costs: our engine beside bare py_trees, interleaved in one process.

    python benchmarks/tick.py
    python benchmarks/tick.py --nodes 10 100 1000 --rounds 30

Both sides tick trees of one shape: a sequence of groups of nine leaves each. On the bare side a
leaf is a py_trees behaviour whose `update` returns a constant, and the groups are py_trees'
sequences and selectors. On our side a leaf has ports: it reads one key and writes another, or
fails with a code and a sentence that its group looks at. Recording is what `run --record` does on
each tick: the fingerprint over statuses and written keys, and both in the run's log.

walk      groups are sequences; every leaf is ticked and succeeds
fallback  groups are fallbacks; of nine leaves eight fail, with their reasons, and one succeeds
running   every leaf but the last is done; the last runs on and is all that has work to do

The cost is that of a tick of the whole tree, divided by its nodes; of several rounds in turn the
median counts. The demands: ours at most half of bare py_trees, ours with recording at most as much.
"""

from __future__ import annotations

import argparse
import gc
import logging
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import py_trees
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

Tick: TypeAlias = Callable[[], object]

GROUP = 9
"""Leaves of a group; with the group itself ten nodes."""
SHAPES = ("walk", "fallback", "running")
LEAST_TIME = 0.01
"""Seconds that one round of one side takes at least."""
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
    context = built.root.context

    def tick() -> None:
        context.begin_tick()
        built.root.execute()

    return tick


def recorded_tick(document: Document, folder: Path) -> Tick:
    """A tick with all that a recorded run does in it."""
    built = ours(document)
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


def seconds(tick: Tick, times: int) -> float:
    started = time.perf_counter()
    for _ in range(times):
        tick()
    return (time.perf_counter() - started) / times


def compare(shape: str, nodes: int, rounds: int) -> None:
    """One line of the table."""
    with tempfile.TemporaryDirectory() as folder:
        sides = {
            "bare": bare(shape, nodes),
            "ours": plain_tick(ours(document_of(shape, nodes))),
            "recorded": recorded_tick(document_of(shape, nodes), Path(folder)),
        }
        times = {name: max(1, int(LEAST_TIME / seconds(tick, 3))) for name, tick in sides.items()}
        measured: dict[str, list[float]] = {name: [] for name in sides}
        for _ in range(rounds):
            for name, tick in sides.items():
                measured[name].append(seconds(tick, times[name]))
    count = groups_of(nodes) * (GROUP + 1) + 1
    cost = {name: statistics.median(found) / count * 1e6 for name, found in measured.items()}
    ratios = [
        statistics.median(a / b for a, b in zip(measured[name], measured["bare"], strict=True))
        for name in ("ours", "recorded")
    ]
    print(
        f"{shape:9} {count:6d} {cost['bare']:10.2f} {cost['ours']:10.2f} {cost['recorded']:10.2f}"
        f" {ratios[0]:12.2f} {ratios[1]:15.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, nargs="+", default=[10, 100, 1000])
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--rounds", type=int, default=15)
    asked = parser.parse_args()
    py_trees.logging.level = py_trees.logging.Level.WARN
    logging.disable()
    gc.disable()
    print("microseconds per node and tick               ratio to bare py_trees")
    print("shape      nodes       bare       ours   recorded         ours        recorded")
    for shape in asked.shapes:
        for nodes in asked.nodes:
            compare(shape, nodes, asked.rounds)
            gc.collect()


if __name__ == "__main__":
    main()
