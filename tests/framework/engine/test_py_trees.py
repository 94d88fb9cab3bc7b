"""Nodes are py_trees behaviours: its displays and visitors work, its stop halts."""

from __future__ import annotations

import py_trees

from momantu_bt.engine.nodes.reactive import ReactiveSequence
from momantu_bt.engine.nodes.sequences import Sequence
from momantu_bt.engine.status import IDLE


def test_its_display_shows_every_node_with_its_status(bench):
    node = bench.node(Sequence, ["S", "R"])
    bench.tick(node)
    shown = py_trees.display.ascii_tree(node, show_status=True)
    assert "leaf0 [o]" in shown
    assert "leaf1 [*]" in shown


def test_its_visitors_meet_what_was_ticked_children_first(bench):
    node = bench.node(Sequence, ["F", "S"])

    class Names(py_trees.visitors.VisitorBase):
        def __init__(self):
            super().__init__(full=False)
            self.seen = []

        def run(self, behaviour):
            self.seen.append((behaviour.name, behaviour.status.value))

    visitor = Names()
    bench.context.begin_tick()
    for behaviour in node.tick():
        behaviour.visit(visitor)
    assert visitor.seen == [("leaf0", "FAILURE"), ("sequence", "FAILURE")]


def test_its_stop_halts_what_runs(bench):
    node = bench.node(ReactiveSequence, ["S", "R"])
    bench.tick(node)
    node.stop(py_trees.common.Status.INVALID)
    assert node.state is IDLE
    assert node.kids[1].halts == 1
    assert node.status is py_trees.common.Status.INVALID
    assert node.tip() is None


def test_skipped_and_idle_are_invalid_to_it(bench):
    node = bench.leaf("K")
    bench.tick(node)
    assert node.status is py_trees.common.Status.INVALID
