"""Precondition, conditions beside a node, and disabled nodes: who is asked when."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.conditions import Conditions
from momantu_bt.engine.context import Remarked
from momantu_bt.engine.status import IDLE, RUNNING
from momantu_bt.nodes.precondition import Precondition
from momantu_bt.nodes.sequences import Sequence
from momantu_bt.tree.model import Literal


def guarded(bench, script, instead="FAILURE", code="open"):
    """A precondition on the key `open` around a leaf."""
    model = bench.model("Precondition")
    model.ports = {"else": Literal(instead), "if": Literal(code)}
    return Precondition(bench.parts(model, [bench.leaf(script)]))


@pytest.mark.parametrize(
    ("instead", "letter"),
    [("FAILURE", "F"), ("SUCCESS", "S"), ("SKIPPED", "K"), ("RUNNING", "R")],
)
def test_a_closed_guard_gives_what_else_names_and_leaves_the_child_alone(bench, instead, letter):
    bench.board.set("open", False)
    node = guarded(bench, "S", instead)
    assert bench.tick(node) == letter
    assert node.child.ticks == 0
    node.reset()
    bench.board.set("open", True)
    assert bench.tick(node) == "S"


def test_a_guard_is_not_asked_while_its_child_runs_but_again_after_its_end(bench):
    bench.board.set("open", True)
    node = guarded(bench, "RRSS")
    assert bench.tick(node) == "R"
    bench.board.set("open", False)
    assert bench.ticks(node) == "RS"
    node.reset()
    assert bench.tick(node) == "F"
    assert node.failure.message == "`open` does not hold"


@pytest.mark.parametrize(
    ("code", "values", "said"),
    [
        ("n == 2", {"n": 1}, "`n == 2` does not hold; n is 1"),
        ("n > 0.5 && word == 'a'", {"n": 0.25, "word": "b"}, "; n is 0.25, word is b"),
        ("word == 'a'", {"word": ""}, "; word is empty"),
        ("!open", {"open": True}, "`!open` does not hold"),
        ("n == 2 && w == 'a'", {"n": 1, "w": "x" * 100}, "does not hold; n is 1"),
    ],
)
def test_a_condition_says_with_which_values_it_does_not_hold(bench, code, values, said):
    for name, value in values.items():
        bench.board.set(name, value)
    node = guarded(bench, "S", code=code)
    assert bench.tick(node) == "F"
    assert node.failure.message.endswith(said)


def test_after_a_halt_a_guard_is_asked_again_only_by_a_new_recovery(bench):
    bench.board.set("open", True)
    node = guarded(bench, "R")
    bench.tick(node)
    bench.board.set("open", False)
    node.reset()
    assert bench.tick(node) == "R"
    node.reset()
    node.renew()
    assert bench.tick(node) == "F"
    assert node.child.ticks == 2


def test_a_guard_that_cannot_be_evaluated_fails_with_script_error(bench):
    node = guarded(bench, "S", code="nobody > 3")
    assert bench.tick(node) == "F"
    assert node.failure.code == "SCRIPT_ERROR"
    assert "nobody" in node.failure.message
    assert node.child.ticks == 0


def conditioned(bench, script, **conditions):
    leaf = bench.leaf(script)
    leaf.conditions = Conditions(
        {name.rstrip("_"): text for name, text in conditions.items()}, bench.board
    )
    return leaf


BEFORE = {"fail_if": "F", "succeed_if": "S", "skip_if": "K"}


@given(truths=st.tuples(*[st.booleans()] * 4))
def test_the_first_condition_that_decides_is_fail_then_succeed_then_skip_then_while(
    new_bench, truths
):
    bench = new_bench()
    names = ("fail_if", "succeed_if", "skip_if")
    for name, value in zip((*names, "going"), truths, strict=True):
        bench.board.set(name, value)
    node = conditioned(bench, "S", **{n: n for n in reversed(names)}, while_="going")
    decided = [BEFORE[name] for name, value in zip(names, truths, strict=False) if value]
    expected = decided[0] if decided else ("S" if truths[3] else "K")
    assert bench.tick(node) == expected
    assert node.given == (0 if decided or not truths[3] else 1)


@pytest.mark.parametrize("name", BEFORE)
def test_of_a_running_node_only_while_is_asked(bench, name):
    bench.board.set("key", False)
    node = conditioned(bench, "RRS", **{name: "key"})
    assert bench.tick(node) == "R"
    bench.board.set("key", True)
    assert bench.ticks(node) == "RS"


def test_while_halts_what_runs_as_soon_as_it_no_longer_holds(bench):
    bench.board.set("go", True)
    bench.board.set("halted", 0)
    node = conditioned(bench, "RRRS", while_="go", on_halt="halted += 1")
    parent = bench.node(Sequence, [node])
    assert bench.tick(parent) == "R"
    bench.board.set("go", False)
    assert bench.tick(parent) == "K"
    assert (node.halts, node.state, bench.board.get("halted")) == (1, IDLE, 1)


@pytest.mark.parametrize(
    ("script", "events"),
    [
        ("S", "sa"),
        ("F", "fa"),
        ("RS", "sa"),
        ("RRF", "fa"),
        ("K", ""),
    ],
)
def test_scripts_follow_the_end_of_their_node_once(bench, script, events):
    bench.board.set("log", "")
    node = conditioned(
        bench,
        script,
        on_success="log = log + 's'",
        on_failure="log = log + 'f'",
        after="log = log + 'a'",
        on_halt="log = log + 'h'",
    )
    bench.ticks(node)
    node.reset()
    assert bench.board.get("log") == events


@given(ticks=st.integers(1, 4))
def test_on_halt_follows_a_halt_once_and_nothing_else_does(new_bench, ticks):
    bench = new_bench()
    bench.board.set("log", "")
    node = conditioned(bench, "R", after="log = log + 'a'", on_halt="log = log + 'h'")
    for _ in range(ticks):
        bench.tick(node)
    node.reset()
    node.reset()
    assert bench.board.get("log") == "h"


@pytest.mark.parametrize("when", ["on_success", "after"])
def test_a_script_that_breaks_after_a_success_makes_it_a_failure(bench, when):
    node = conditioned(bench, "RS", **{when: "nobody += 1"})
    assert bench.ticks(node) == "RF"
    assert node.failure.code == "SCRIPT_ERROR"
    assert node.failure.node == "leaf"
    assert node.failures == 1


def test_a_script_that_breaks_after_a_halt_is_remarked_on_and_the_halt_goes_on(bench):
    said = []
    bench.context.events.subscribe(Remarked, lambda event: said.append(event.text))
    node = conditioned(bench, "R", on_halt="nobody += 1")
    parent = bench.node(Sequence, [node])
    bench.tick(parent)
    parent.reset()
    assert (parent.state, node.state, node.halts) == (IDLE, IDLE, 1)
    assert len(said) == 1
    assert "on_halt" in said[0]
    assert "leaf (test.yaml:1)" in said[0]


WHERE = {
    "root": "trees: {Main: {%s}}",
    "child": "trees: {Main: [succeed, {%s}]}",
    "branch": "trees: {Main: {if: succeed, then: {%s}}}",
    "handler": "trees: {Main: {handle: {try: always_failure, catch: {any: {%s}}}}}",
    "decorated": "trees: {Main: {retry: {attempts: 2, child: {%s}}}}",
    "parallel": "trees: {Main: {parallel: [succeed, {%s}]}}",
    "subtree": "trees: {Main: [Sub], Sub: {%s}}",
}


@pytest.mark.parametrize("where", WHERE)
@pytest.mark.parametrize(
    "node", ["script: $n := 9", "sequence: [{script: $n := 9}]", "wait: 1 s, retry: 2"]
)
def test_a_disabled_node_never_starts_wherever_it_stands(run_yaml, where, node):
    report = run_yaml(f"values: {{n: 1}}\n{WHERE[where] % f'{node}, disabled: true'}")
    assert report.blackboard == {"n": 1}
    assert report.sim_time_s <= 0.05
    assert [n.runs for n in report.nodes if n.type in ("Script", "Sleep")] in ([0], [])


def test_a_disabled_node_is_skipped_and_what_is_below_it_is_not_built(run_yaml):
    text = """
trees:
  Main:
    - sequence: [{script: $n := 1}, {fail: {code: NEVER}}]
      disabled: true
    - wait: 0.1 s
"""
    report = run_yaml(text, world="none")
    assert report.status == "SUCCESS"
    assert "n" not in report.blackboard
    assert [(node.type, node.runs) for node in report.nodes] == [
        ("Sequence", 1),
        ("Sequence", 0),
        ("Sleep", 1),
    ]


def test_nothing_runs_below_a_guard_that_closed_meanwhile(bench):
    bench.board.set("go", True)
    inner = bench.node(Sequence, ["S", "R"])
    inner.conditions = Conditions({"while": "go"}, bench.board)
    outer = bench.node(Sequence, [inner, "S"])
    assert bench.tick(outer) == "R"
    bench.board.set("go", False)
    assert bench.tick(outer) == "S"
    assert not any(RUNNING in (node.state, node.shown) for node in outer.below)
