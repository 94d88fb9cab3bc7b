"""py_trees' displays, visitors and tree manager work on views of our nodes."""

from __future__ import annotations

import py_trees
import pytest

from momantu_bt.engine.status import IDLE
from momantu_bt.nodes.fallbacks import Fallback
from momantu_bt.nodes.forcing import Inverter
from momantu_bt.nodes.parallel import Parallel
from momantu_bt.nodes.reactive import ReactiveSequence
from momantu_bt.nodes.sequences import Sequence
from momantu_bt.py_trees_bridge.view import view
from tests.framework.engine.conftest import Bench


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_displays_show_every_node_with_its_status_and_kind(bench):
    inverted = bench.node(Inverter, ["F"])
    node = bench.node(Sequence, [inverted, bench.node(Fallback, ["F", "R"])])
    bench.tick(node)
    shown = py_trees.display.ascii_tree(view(node), show_status=True)
    assert [line.strip() for line in shown.splitlines()] == [
        "{-} sequence [*]",
        "-^- invert [o]",
        "--> leaf0 [x] -- FAILED, leaf0 failed",
        "{o} fallback [*]",
        "--> leaf0 [x] -- FAILED, leaf0 failed",
        "--> leaf1 [*]",
    ]
    assert py_trees.display.unicode_tree(view(node)).count("\n") == 6


def test_dot_has_a_box_per_node(bench):
    node = bench.node(Parallel, [bench.node(ReactiveSequence, ["S"]), "R"])
    graph = py_trees.display.dot_tree(view(node))
    named = {each.get_name().strip('"') for each in graph.get_nodes()}
    assert {"parallel", "reactive_sequence", "leaf0", "leaf1"} <= named


def test_visitors_meet_what_was_ticked_children_first(bench):
    node = bench.node(Sequence, ["F", "S"])
    tree = py_trees.trees.BehaviourTree(view(node))
    seen = py_trees.visitors.SnapshotVisitor()
    order = []

    class Names(py_trees.visitors.VisitorBase):
        def run(self, behaviour):
            order.append((behaviour.name, behaviour.status.value))

    tree.visitors += [seen, Names(full=False)]
    tree.tick()
    assert order == [("leaf0", "FAILURE"), ("sequence", "FAILURE")]
    assert tree.root.id in seen.visited


def test_to_stop_a_view_is_to_halt_its_node(bench):
    node = bench.node(ReactiveSequence, ["S", "R"])
    shown = view(node)
    shown.tick_once()
    assert shown.tip().name == "leaf1"
    shown.stop(py_trees.common.Status.INVALID)
    assert node.state is IDLE
    assert node.kids[1].halts == 1
    assert shown.status is py_trees.common.Status.INVALID
    assert shown.tip() is None


def test_skipped_and_idle_are_invalid(bench):
    node = bench.leaf("K")
    bench.tick(node)
    assert view(node).status is py_trees.common.Status.INVALID
