"""A person who decides: answers, defaults, nobody there, and what a run keeps of it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.person import Interrupted, Question, Scripted, answer
from momantu_bt.running.options import RunOptions

TEXT = """
trees:
  Main:
    - ask: {question: "Which table?", choices: [table_a, table_b], answer: $table%s}
    - confirm: {question: "Really ${table}?"%s}
"""


def tree(table="", really=""):
    return TEXT % (table and f", default: {table}", really and f", default: {really}")


def asked(run_yaml, text, *answers):
    return run_yaml(text, world="none", answers=answers)


@pytest.mark.parametrize(
    ("answers", "status", "code", "table"),
    [
        (("table_b", True), "SUCCESS", None, "table_b"),
        (("table_b", "yes"), "SUCCESS", None, "table_b"),
        (("TABLE_A", "Y"), "SUCCESS", None, "table_a"),
        (("table_b", False), "FAILURE", "DECLINED", "table_b"),
        (("table", "floor", "", "table_b", "perhaps", True), "SUCCESS", None, "table_b"),
        (("floor",), "FAILURE", "NO_ANSWER", None),
        (("table_a",), "FAILURE", "NO_ANSWER", "table_a"),
        ((), "FAILURE", "NO_ANSWER", None),
    ],
)
def test_answers_decide(run_yaml, answers, status, code, table):
    report = asked(run_yaml, tree(), *answers)
    assert report.status == status
    assert (report.failure and report.failure.code) == code
    assert report.blackboard.get("table") == table


def test_defaults_count_when_nobody_answers(run_yaml):
    report = asked(run_yaml, tree("table_b", "true"))
    assert (report.status, report.blackboard["table"]) == ("SUCCESS", "table_b")
    assert asked(run_yaml, tree("table_b", "false")).failure.code == "DECLINED"
    assert asked(run_yaml, tree("table_b"), "").failure.code == "NO_ANSWER"


def test_without_choices_any_text_is_an_answer(run_yaml):
    text = "trees: {Main: [{ask: {question: Name?, answer: $name}}]}"
    assert asked(run_yaml, text, " ", "  Bo Derek ").blackboard["name"] == "Bo Derek"


def test_a_default_that_comes_by_wire_is_checked_when_it_comes(run_yaml):
    text = "values: {d: floor}\n" + tree("$d")
    failure = asked(run_yaml, text, "table_a", True).failure
    assert failure.code == "WRONG_TYPE"
    assert "not one of: table_a, table_b" in failure.message


def test_a_question_takes_no_simulated_time_and_answers_are_in_the_fingerprint(run_yaml):
    runs = [asked(run_yaml, tree(), *said) for said in (("table_a", True), ("x", "table_a", "y"))]
    assert {report.ticks for report in runs} == {1}
    assert runs[0].fingerprint == runs[1].fingerprint
    other = asked(run_yaml, tree(), "table_b", True)
    assert other.fingerprint != runs[0].fingerprint


def test_each_question_is_asked_once_a_start_and_a_decline_can_be_handled(run_yaml):
    text = """
values: {n: 0}
trees:
  Main:
    recover:
      attempts: 3
      try:
        - script: $n += 1
        - confirm: "Go on after ${n}?"
      catch:
        DECLINED: again
"""
    report = asked(run_yaml, text, False, False, True)
    assert report.status == "SUCCESS"
    assert [node.runs for node in report.nodes if node.type == "Confirm"] == [3]


class Leaving:
    """Ends the run instead of answering."""

    def __init__(self):
        self.asked = []

    def ask(self, question, complaint):
        self.asked.append(question.text)
        raise Interrupted


def test_whoever_interrupts_instead_leaves_the_node_running(bench):
    from momantu_bt.nodes.asking import Confirm

    bench.context.person = Leaving()
    node = bench.node(Confirm, [], question="Well?", default=None)
    assert bench.tick(node) == "R"
    node.reset()
    assert node.state.value == node.shown.value == "IDLE"
    assert bench.context.person.asked == ["Well?"]


def test_nobody_is_there_unless_somebody_is_given():
    assert answer(RunOptions().person, Question("Well?")) is None


WORDS = st.text(st.characters(codec="ascii", categories=("L", "N")), min_size=1, max_size=4)


@given(
    choices=st.lists(WORDS, max_size=4, unique=True),
    said=st.lists(st.text(max_size=5), max_size=5),
    index=st.none() | st.integers(0, 3),
)
def test_an_answer_is_a_choice_a_text_or_the_default(choices, said, index):
    default = choices[index % len(choices)] if choices and index is not None else None
    question = Question("?", tuple(choices), default)
    found = answer(Scripted(said), question)
    if found is None:
        assert default is None
    elif choices:
        assert found in choices
    else:
        assert found == found.strip() != ""


@given(choices=st.lists(WORDS, min_size=1, max_size=4, unique=True), data=st.data())
def test_a_choice_written_out_means_itself(choices, data):
    said = data.draw(st.sampled_from(choices))
    assert Question("?", tuple(choices)).taken(f" {said} ") == said
