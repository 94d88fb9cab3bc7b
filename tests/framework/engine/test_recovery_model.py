"""Recover and Handle against a plain model of them, over random plans of codes and handlers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.blackboard import Board
from momantu_bt.engine.node import Parts, TreeNode
from momantu_bt.engine.status import FAILURE, RUNNING, SUCCESS
from momantu_bt.nodes.fallbacks import RoundRobin
from momantu_bt.nodes.recover import Handle, Recover
from momantu_bt.record.reader import read_record
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.skill import MISSING, Failure, In, Run, Skill

CODES = ("A", "B", "C")


class Planned(TreeNode):
    """Ends as a plan says, start by start; notes each start, and what a cell then holds.

    plan: (ticks it runs first, code or OK), the last one for ever.
    """

    def __init__(self, model, context, plan, events, cell=None):
        super().__init__(Parts(model, context, Board(context.writes)))
        self.plan, self.events, self.cell = plan, events, cell
        self.starts = self.left = 0

    def step(self):
        if self.state is not RUNNING:
            self.left, self.code = self.plan[min(self.starts, len(self.plan) - 1)]
            self.starts += 1
            self.events.append((self.name, None if self.cell is None else self.cell.value))
            if self.cell is not None:
                self.cell.write(self.starts)
        if self.left > 0:
            self.left -= 1
            return RUNNING
        return SUCCESS if self.code == "OK" else self.fail(self.code, f"{self.name} {self.starts}")


PLANS = st.lists(
    st.tuples(st.integers(0, 2), st.sampled_from(["OK", *CODES])), min_size=1, max_size=4
)
CATCHES = st.lists(
    st.tuples(
        st.lists(st.sampled_from([*CODES, "any", "try.A", "other.B"]), min_size=1, max_size=2),
        st.none() | PLANS,
    ),
    max_size=3,
)


def chosen(catches, code):
    """Index of the handler of a code: the first that names it, else the first `any`."""
    for index, (codes, _) in enumerate(catches):
        if code in codes or f"try.{code}" in codes:
            return index
    return next((i for i, (codes, _) in enumerate(catches) if "any" in codes), None)


def planned(plan, start):
    return plan[min(start, len(plan) - 1)][1]


def model_of_recover(plan, catches, attempts):
    """(starts in order, codes of the failure's chain, tries)."""
    order, used = [], [0] * len(catches)
    for count in range(1, attempts + 1):
        order.append("try")
        code = planned(plan, count - 1)
        if code == "OK":
            return order, [], None
        index = chosen(catches, code)
        if index is None or count == attempts:
            return order, [code], count
        handler = catches[index][1]
        if handler is not None:
            order.append(f"handler{index}")
            answer = planned(handler, used[index])
            used[index] += 1
            if answer != "OK":
                return order, [answer, code], count
    raise AssertionError("attempts is at least 1")


def model_of_handle(plan, catches):
    code = planned(plan, 0)
    index = None if code == "OK" else chosen(catches, code)
    if code == "OK" or index is None:
        return ["try"], [] if code == "OK" else [code]
    handler = catches[index][1]
    if handler is None:
        return ["try"], []
    answer = planned(handler, 0)
    return ["try", f"handler{index}"], [] if answer == "OK" else [answer, code]


def made(bench, kind, plan, catches, **inputs):
    """A recovery with its events; `try` writes the cell `mine`, the handlers `theirs`."""
    events = []
    mine, theirs = bench.board.cell("mine"), bench.board.cell("theirs")
    kids = [Planned(bench.model("AlwaysSuccess", "try"), bench.context, plan, events, mine)]
    rules = []
    for index, (codes, handler) in enumerate(catches):
        node = None
        if handler is not None:
            name = bench.model("AlwaysSuccess", f"handler{index}")
            node = Planned(name, bench.context, handler, events, theirs)
            kids.append(node)
        rules.append((tuple(codes), node))
    node = kind(bench.parts(bench.model(kind.__name__, "recovery"), kids, rules, **inputs))
    return node, events, node.caught


@given(plan=PLANS, catches=CATCHES, attempts=st.integers(1, 5))
def test_recover_does_what_its_model_does(new_bench, plan, catches, attempts):
    bench = new_bench()
    node, events, caught = made(bench, Recover, plan, catches, attempts=attempts)
    letters = bench.ticks(node, most=100)
    order, codes, tries = model_of_recover(plan, catches, attempts)
    assert [name for name, _ in events] == order
    assert letters[-1] == ("F" if codes else "S")
    if codes:
        chain = list(node.failure.chain())
        assert [link.code for link in chain] == codes
        assert (node.failure.tries, node.failure.most_tries) == (tries, attempts)
        assert caught.value is MISSING or caught.value.code in CODES


@given(plan=PLANS, catches=CATCHES, attempts=st.integers(1, 5))
def test_each_try_begins_on_a_clean_board_and_handlers_keep_theirs(
    new_bench, plan, catches, attempts
):
    bench = new_bench()
    bench.board.set("mine", "before")
    node, events, _ = made(bench, Recover, plan, catches, attempts=attempts)
    letters = bench.ticks(node, most=100)
    assert {held for name, held in events if name == "try"} == {"before"}
    handled = [held for name, held in events if name.startswith("handler")]
    if handled:
        assert handled[0] is MISSING
        assert MISSING not in handled[1:]
    if letters.endswith("S"):
        assert bench.board.get("mine") == sum(name == "try" for name, _ in events)


@given(plan=PLANS, catches=CATCHES)
def test_handle_does_what_its_model_does(new_bench, plan, catches):
    bench = new_bench()
    node, events, _ = made(bench, Handle, plan, catches)
    letters = bench.ticks(node, most=100)
    order, codes = model_of_handle(plan, catches)
    assert [name for name, _ in events] == order
    assert letters[-1] == ("F" if codes else "S")
    assert [link.code for link in node.failure.chain()] == codes if codes else True


@given(plan=PLANS, catches=CATCHES, ticks=st.integers(0, 6))
def test_a_recovery_that_was_halted_counts_from_the_first_try(new_bench, plan, catches, ticks):
    bench = new_bench()
    node, events, _ = made(bench, Recover, plan, catches, attempts=3)
    for _ in range(ticks):
        if bench.tick(node) != "R":
            break
    node.reset()
    events.clear()
    for kid in node.kids:
        kid.starts = 0
    bench.ticks(node, most=100)
    assert [name for name, _ in events] == model_of_recover(plan, catches, 3)[0]


@given(
    answers=st.lists(st.sampled_from(["OK", "B"]), min_size=3, max_size=3), tries=st.integers(1, 6)
)
def test_a_round_robin_of_handlers_goes_round_and_ends_when_all_failed(new_bench, answers, tries):
    bench = new_bench()
    events = []
    steps = [
        Planned(bench.model("AlwaysSuccess", f"h{i}"), bench.context, [(0, answer)], events)
        for i, answer in enumerate(answers)
    ]
    handler = bench.node(RoundRobin, steps)
    body = Planned(bench.model("AlwaysSuccess", "try"), bench.context, [(0, "A")], events)
    handlers = [(("A",), handler)]
    node = Recover(bench.parts(bench.model("Recover"), [body, handler], handlers, attempts=tries))
    assert bench.ticks(node, most=100).endswith("F")
    expected, at = [], 0
    for count in range(1, tries + 1):
        expected.append("try")
        if count == tries:
            break
        turn = [(at + i) % 3 for i in range(3)]
        working = next((i for i, index in enumerate(turn) if answers[index] == "OK"), None)
        expected += [f"h{index}" for index in turn[: 3 if working is None else working + 1]]
        if working is None:
            break
        at = (turn[working] + 1) % 3
    assert [name for name, _ in events] == expected


class Slip(Skill):
    """Runs a tick, then fails with a number that counts its starts."""

    failures = {"SLIPPED": "slipped"}
    times: int = In(99, doc="how often")
    starts = 0

    def run(self, robot) -> Run:
        Slip.starts += 1
        yield "holding"
        if Slip.starts <= self.times:
            raise Failure("SLIPPED", f"time {Slip.starts}")


@pytest.fixture(autouse=True)
def _anew():
    Slip.starts = 0


@pytest.mark.parametrize("tree", ["{slip: {times: 2}, retry: 3}", "{slip: {times: 2}, retry: -1}"])
def test_the_reason_of_a_failure_is_told_though_the_node_starts_again_at_once(
    run_yaml, tmp_path, tree
):
    said = []

    record = tmp_path / "record"
    report = run_yaml(
        f"trees: {{Main: [{tree}]}}",
        Slip,
        watch=lambda run: [ChangeLines(said.append)],
        record=record,
    )
    assert report.status == "SUCCESS"
    recording = read_record(record)
    reasons = [
        change.failure.message
        for tick in recording.ticks
        for change in tick.changes
        if recording.nodes[change.node].name == "slip" and change.status == FAILURE.value
    ]
    assert reasons == ["time 1", "time 2"]
    assert [line.partition("fails: ")[2] for line in said if "fails" in line] == [
        "SLIPPED, time 1",
        "SLIPPED, time 2",
    ]


def test_a_recovery_inside_a_recovery_hands_out_what_it_could_not_handle(run_yaml):
    text = """
trees:
  Main:
    recover:
      attempts: 2
      try:
        recover:
          attempts: 2
          try: slip
          catch: {SLIPPED: again}
      catch: {SLIPPED: again}
"""
    failure = run_yaml(text, Slip).failure
    assert Slip.starts == 4
    assert (failure.tries, failure.most_tries) == (2, 2)
    assert (failure.cause.tries, failure.cause.message) == (2, "time 4")
