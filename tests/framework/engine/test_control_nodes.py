"""Every control node: its status for each status of its children, tick by tick.

A script such as "RS" is what a child returns in turn; the expected text is what the node does.
"""

from __future__ import annotations

import pytest

from momantu_bt.engine.nodes.branches import IfThenElse, WhileDoElse
from momantu_bt.engine.nodes.fallbacks import AsyncFallback, Fallback, RoundRobin
from momantu_bt.engine.nodes.parallel import Parallel, ParallelAll
from momantu_bt.engine.nodes.reactive import ReactiveFallback, ReactiveSequence
from momantu_bt.engine.nodes.sequences import AsyncSequence, Sequence, SequenceWithMemory
from momantu_bt.engine.status import IDLE, RUNNING

TABLE = [
    (Sequence, ["S", "S"], "S"),
    (Sequence, ["S", "F"], "F"),
    (Sequence, ["F", "S"], "F"),
    (Sequence, ["RS", "RRS"], "RRRS"),
    (Sequence, ["K", "S"], "S"),
    (Sequence, ["K", "K"], "K"),
    (Sequence, ["S", "K"], "S"),
    (AsyncSequence, ["S", "S", "S"], "RRS"),
    (AsyncSequence, ["S", "F"], "RF"),
    (AsyncSequence, ["RS", "S"], "RS"),
    (SequenceWithMemory, ["S", "S"], "RS"),
    (SequenceWithMemory, ["K", "K"], "K"),
    (Fallback, ["S", "F"], "S"),
    (Fallback, ["F", "S"], "S"),
    (Fallback, ["F", "F"], "F"),
    (Fallback, ["RF", "RS"], "RRS"),
    (Fallback, ["K", "F"], "F"),
    (Fallback, ["K", "K"], "K"),
    (AsyncFallback, ["F", "F", "S"], "RRS"),
    (ReactiveSequence, ["S", "RRS"], "RRS"),
    (ReactiveSequence, ["SSF", "R"], "RRF"),
    (ReactiveSequence, ["K", "K"], "K"),
    (ReactiveSequence, ["K", "S"], "S"),
    (ReactiveFallback, ["F", "RRS"], "RRS"),
    (ReactiveFallback, ["FFS", "R"], "RRS"),
    (ReactiveFallback, ["F", "F"], "F"),
    (ReactiveFallback, ["K", "K"], "K"),
    (IfThenElse, ["S", "S", "F"], "S"),
    (IfThenElse, ["F", "F", "S"], "S"),
    (IfThenElse, ["F", "S"], "F"),
    (IfThenElse, ["RS", "RF", "S"], "RRF"),
    (IfThenElse, ["K", "S", "F"], "K"),
    (WhileDoElse, ["SSF", "R", "RS"], "RRRS"),
    (WhileDoElse, ["SF", "R"], "RF"),
    (WhileDoElse, ["K", "S"], "K"),
    (RoundRobin, ["S", "F"], "S"),
    (RoundRobin, ["F", "S"], "S"),
    (RoundRobin, ["F", "F"], "F"),
    (RoundRobin, ["RF", "RS"], "RRS"),
    (RoundRobin, ["K", "K"], "K"),
]


@pytest.mark.parametrize(("kind", "kids", "expected"), TABLE)
def test_status_for_each_status_of_the_children(bench, kind, kids, expected):
    node = bench.node(kind, kids)
    assert bench.ticks(node) == expected
    if expected[-1] in "SF":
        assert all(kid.state is IDLE for kid in node.kids) or kids == ["F", "S"]


PARALLEL = [
    (Parallel, ["S", "S"], {"success_count": -1, "failure_count": 1}, "S"),
    (Parallel, ["RS", "S"], {"success_count": -1, "failure_count": 1}, "RS"),
    (Parallel, ["R", "F"], {"success_count": -1, "failure_count": 1}, "F"),
    (Parallel, ["R", "S"], {"success_count": 1, "failure_count": 1}, "S"),
    (Parallel, ["F", "RS"], {"success_count": 1, "failure_count": 2}, "RS"),
    (Parallel, ["K", "S"], {"success_count": -1, "failure_count": 1}, "S"),
    (Parallel, ["K", "K"], {"success_count": 1, "failure_count": 1}, "K"),
    (Parallel, ["S", "S"], {"success_count": 3, "failure_count": 1}, "F"),
    (ParallelAll, ["RS", "F"], {"max_failures": 1}, "RF"),
    (ParallelAll, ["RS", "F"], {"max_failures": 2}, "RS"),
    (ParallelAll, ["K", "RS"], {"max_failures": 1}, "RS"),
    (ParallelAll, ["K", "K"], {"max_failures": 1}, "K"),
]


@pytest.mark.parametrize(("kind", "kids", "ports", "expected"), PARALLEL)
def test_parallel_ends_when_its_counts_say_so(bench, kind, kids, ports, expected):
    assert bench.ticks(bench.node(kind, kids, **ports)) == expected


def test_parallel_does_not_tick_again_what_has_ended(bench):
    node = bench.node(Parallel, ["S", "RRS"], success_count=-1, failure_count=1)
    assert bench.ticks(node) == "RRS"
    assert [kid.given for kid in node.kids] == [1, 3]


def test_the_end_of_a_parallel_halts_what_still_runs(bench):
    node = bench.node(Parallel, ["R", "F"], success_count=-1, failure_count=1)
    assert bench.ticks(node) == "F"
    assert node.kids[0].halts == 1
    assert node.kids[0].shown is IDLE


def test_a_reactive_sequence_halts_the_work_when_its_guard_fails(bench):
    node = bench.node(ReactiveSequence, ["SF", "R"])
    assert bench.ticks(node) == "RF"
    assert node.kids[1].halts == 1
    assert node.kids[1].state is IDLE


def test_a_reactive_fallback_hands_over_to_an_earlier_child(bench):
    node = bench.node(ReactiveFallback, ["FR", "R"])
    bench.tick(node)
    bench.tick(node)
    assert node.kids[0].state is RUNNING
    assert node.kids[1].state is IDLE
    assert node.kids[1].halts == 1


def test_while_do_else_halts_the_branch_no_longer_meant(bench):
    node = bench.node(WhileDoElse, ["SFF", "R", "R"])
    bench.tick(node)
    assert bench.tick(node) == "R"
    assert node.kids[1].halts == 1


def test_a_sequence_with_memory_goes_on_at_the_child_that_failed(bench):
    node = bench.node(SequenceWithMemory, ["S", "FS"])
    assert bench.ticks(node) == "RF"
    node.reset()
    assert bench.ticks(node) == "S"
    assert [kid.given for kid in node.kids] == [1, 2]


def test_a_plain_sequence_starts_over_after_a_failure(bench):
    node = bench.node(Sequence, ["S", "FS"])
    assert bench.ticks(node) == "F"
    node.reset()
    assert bench.ticks(node) == "S"
    assert [kid.given for kid in node.kids] == [2, 2]


def test_round_robin_starts_with_the_next_child_each_time(bench):
    node = bench.node(RoundRobin, ["S", "S", "S"])
    counts = []
    for _ in range(4):
        assert bench.tick(node) == "S"
        node.reset()
        counts.append([kid.given for kid in node.kids])
    assert counts == [[1, 0, 0], [1, 1, 0], [1, 1, 1], [2, 1, 1]]


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
