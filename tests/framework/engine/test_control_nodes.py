"""Control nodes beside their tables: failures, halts and what people see."""

from __future__ import annotations

import pytest

from momantu_bt.engine.status import IDLE, RUNNING
from momantu_bt.nodes.branches import IfThenElse, WhileDoElse
from momantu_bt.nodes.fallbacks import Fallback, RoundRobin
from momantu_bt.nodes.parallel import Parallel
from momantu_bt.nodes.reactive import ReactiveSequence
from momantu_bt.nodes.sequences import AsyncSequence, Sequence


def test_parallel_does_not_tick_again_what_has_ended(bench):
    node = bench.node(Parallel, ["S", "RRS"], success_count=-1, failure_count=1)
    assert bench.ticks(node) == "RRS"
    assert [kid.given for kid in node.kids] == [1, 3]


def test_the_end_of_a_parallel_halts_what_still_runs(bench):
    node = bench.node(Parallel, ["R", "F"], success_count=-1, failure_count=1)
    assert bench.ticks(node) == "F"
    assert node.kids[0].halts == 1
    assert node.kids[0].shown is IDLE


def test_a_fallback_fails_with_the_last_failure_and_the_others_beside_it(bench):
    node = bench.node(Fallback, ["F", "F", "F"])
    bench.tick(node)
    assert node.failure.message == "leaf2 failed"
    assert [other.message for other in node.failure.beside] == ["leaf0 failed", "leaf1 failed"]


@pytest.mark.parametrize("kind", [Sequence, AsyncSequence, Fallback, ReactiveSequence, RoundRobin])
def test_halting_reaches_the_running_child_once_and_may_be_repeated(bench, kind):
    node = bench.node(kind, ["R", "R"])
    bench.tick(node)
    node.reset()
    node.reset()
    assert node.kids[0].halts == 1
    assert node.state is IDLE
    assert {n.shown for n in (node, *node.below)} == {IDLE}


@pytest.mark.parametrize("kind", [Sequence, Fallback, ReactiveSequence, IfThenElse, WhileDoElse])
def test_no_node_below_a_finished_one_still_shows_running(bench, kind):
    node = bench.node(kind, ["RS", "RF", "RS"])
    bench.ticks(node, most=20)
    assert not any(child.shown is RUNNING for child in node.below)
