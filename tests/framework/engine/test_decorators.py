"""Decorators beside their tables: failures, counts and what they remember."""

from __future__ import annotations

import pytest

from momantu_bt.engine.status import IDLE, RUNNING
from momantu_bt.nodes.forcing import ForceSuccess, Inverter
from momantu_bt.nodes.loops import (
    KeepRunningUntilFailure,
    RetryUntilSuccessful,
    RunOnce,
)
from momantu_bt.nodes.timing import Timeout


@pytest.mark.parametrize("kind", [Inverter, ForceSuccess, KeepRunningUntilFailure])
def test_halting_a_decorator_halts_its_child(bench, kind):
    node = bench.node(kind, ["R"])
    bench.tick(node)
    node.reset()
    assert node.child.halts == 1
    assert node.child.state is IDLE


def test_else_fail_gives_the_code_and_keeps_the_childs_failure_as_its_cause(run_yaml):
    report = run_yaml(
        "values: {battery: 12}\ntrees:\n  Main:\n    handle:\n      try:\n"
        "        - condition: $battery > 20\n"
        '          else_fail: {code: BATTERY_LOW, message: "only ${battery} % left"}\n'
        "      catch: {BATTERY_LOW: {fail: {code: GAVE_UP, message: '${failure.message}'}}}\n",
        world="none",
    )
    codes = [link.code for link in report.failure.chain()]
    assert codes[0] == "GAVE_UP"
    assert codes[-2:] == ["BATTERY_LOW", "FAILED"]
    assert report.failure.message == "only 12 % left"


def test_a_timeout_names_what_was_running(bench):
    node = bench.node(Timeout, ["R"], duration=0.1)
    bench.ticks(node)
    assert node.failure.code == "TIMEOUT"
    assert "0.1 s" in node.failure.message
    assert node.failure.cause.code == "HALTED"
    assert node.failure.cause.node == "leaf0"
    assert node.child.halts == 1


@pytest.mark.parametrize(("then_skip", "later"), [(True, "K"), (False, "F")])
def test_run_once_runs_its_child_once(bench, then_skip, later):
    node = bench.node(RunOnce, ["RF"], then_skip=then_skip)
    assert bench.ticks(node) == "RF"
    assert bench.tick(node) == later
    assert bench.tick(node) == later
    assert node.child.given == 2


def test_retry_keeps_the_code_and_adds_the_tries(bench):
    node = bench.node(RetryUntilSuccessful, ["F"], attempts=3)
    bench.ticks(node)
    assert (node.failure.code, node.failure.node) == ("FAILED", "leaf0")
    assert (node.failure.tries, node.failure.most_tries) == (3, 3)


def test_retry_within_retry_keeps_both_counts(bench):
    inner = bench.node(RetryUntilSuccessful, ["F"], attempts=2)
    outer = bench.node(RetryUntilSuccessful, [inner], attempts=3)
    bench.ticks(outer, most=20)
    assert (outer.failure.tries, outer.failure.most_tries) == (3, 3)
    assert (outer.failure.cause.tries, outer.failure.cause.most_tries) == (2, 2)


def test_counts_are_forgotten_by_a_halt(bench):
    node = bench.node(RetryUntilSuccessful, ["FFRFFS"], attempts=3)
    for _ in range(3):
        bench.tick(node)
    assert node.count == 2
    node.reset()
    assert bench.ticks(node) == "RRS"


def test_a_node_counts_its_runs_failures_ticks_and_active_seconds(bench):
    node = bench.node(RetryUntilSuccessful, ["RRFRS"], attempts=2)
    bench.ticks(node)
    leaf = node.child
    assert (leaf.ticks, leaf.runs, leaf.failures) == (5, 2, 1)
    assert leaf.seconds == pytest.approx(0.15)
    assert (node.runs, node.failures) == (1, 0)
    assert node.seconds == pytest.approx(0.15)
    assert node.state is not RUNNING
