"""Hints at guards that nobody watches, and warnings of keys that nobody reads."""

from collections.abc import Callable

import pytest

from momantu_bt.formats.problems import Problem, Severity

Check = Callable[[str], list[Problem]]
GUARD = "{condition: $@robot.stamp < 90}"
DRIVE = "{navigate: {in_front_of: table_a}}"


def found(check: Check, nodes: str, more: str = "") -> list[tuple[str, int]]:
    text = f"momantu_bt: 1\nworld: rooms\nmain: Main\ntrees:\n  Main:\n    {nodes}\n{more}"
    problems = check(text)
    assert all(problem.severity > Severity.ERROR for problem in problems), problems
    return [(problem.code, problem.place.line) for problem in problems]


@pytest.mark.parametrize(
    "nodes",
    [
        f"- {GUARD}\n    - {DRIVE}",
        f"- {GUARD}\n    - succeed\n    - {DRIVE}",
        f"- {GUARD}\n    - retry: {{attempts: 2, child: {{fallback: [always_failure, {DRIVE}]}}}}",
        "- {condition: $@localization.localized}\n    - relocalize",
        f"- {GUARD}\n    - Sub",
    ],
)
def test_a_guard_that_is_asked_once(check: Check, nodes: str) -> None:
    sub = f"  Sub:\n    sequence: [{DRIVE}]\n" if "Sub" in nodes else ""
    assert found(check, nodes, sub) == [("unwatched-guard", 6)]


@pytest.mark.parametrize(
    "nodes",
    [
        f"- reactive_sequence: [{GUARD}, {DRIVE}]",
        f"- {{navigate: {{in_front_of: table_a}}, while: $@robot.stamp < 90}}\n    - {GUARD}",
        f"- {DRIVE}\n    - {GUARD}",
        f"- {GUARD}\n    - wait: 1",
        f"- {GUARD}\n    - {{navigate: {{in_front_of: table_a}}, disabled: true}}",
        f"- {{condition: $@robot.stamp < 90, disabled: true}}\n    - {DRIVE}",
        f"- script: $n := 1\n    - condition: $n > 0\n    - {DRIVE}",
    ],
)
def test_a_guard_that_is_watched_or_cannot_change(check: Check, nodes: str) -> None:
    assert found(check, nodes) == []


def test_the_hint_says_what_to_write(check: Check) -> None:
    text = f"momantu_bt: 1\nworld: rooms\ntrees:\n  Main: [{GUARD}, {DRIVE}]\n"
    hint = check(text)[0]
    assert hint.severity is Severity.HINT
    assert "$@robot is asked once here, and not again while navigate runs" in hint.message
    assert "`reactive_sequence:`" in hint.hint
    assert "`while:`" in hint.hint


def test_a_key_that_only_scripts_write(check: Check) -> None:
    sub = "  Sub: [{script: '$left := 1; $used := 2'}, {condition: $used > 1}]\n"
    assert found(check, "- Sub", sub) == [("unread-output", 7)]
    after = "  Sub: [{succeed: , on_success: $left := 1}]\n"
    assert found(check, "- Sub", after) == [("unread-output", 7)]


def test_a_key_that_only_set_writes(check: Check) -> None:
    assert found(check, "- set: {key: $left, value: 1}") == [("unread-output", 6)]


def test_a_script_of_the_main_tree_may_compute_a_result(check: Check) -> None:
    assert found(check, "- script: $result := 1") == []


@pytest.mark.parametrize(
    "reader", ["{condition: $@n > 0}", "{wait: $@n}", "{fail: {code: OH, message: '${@n}'}}"]
)
def test_any_tree_may_read_what_the_main_tree_writes(check: Check, reader: str) -> None:
    nodes = "- set: {key: $n, value: 1}\n    - Sub"
    assert found(check, nodes, f"  Sub: [{reader}]\n") == []
    # the subtree's own key of that name is another one
    own = "  Sub: [{set: {key: $n, value: 1}}, " + reader + "]\n"
    assert found(check, nodes, own) == [("unread-output", 8)]


@pytest.mark.parametrize(
    ("values", "nodes", "line"),
    [
        ("{a: 1 s}", "- succeed", 3),
        ("{a: 1 s, b: 2 s}", "- wait: $a", 3),
        ("{a: 1 s}", "- Sub: {a: 2 s}", 3),
    ],
)
def test_a_value_that_nothing_reads(check: Check, values: str, nodes: str, line: int) -> None:
    sub = "  Sub:\n    inputs: {a: number}\n    wait: $a\n" if "Sub" in nodes else ""
    text = f"momantu_bt: 1\nmain: Main\nvalues: {values}\ntrees:\n  Main:\n    {nodes}\n{sub}"
    assert [(p.code, p.place.line) for p in check(text)] == [("unused-value", line)]


@pytest.mark.parametrize(
    "nodes",
    [
        "- wait: $a",
        "- condition: $a > 0",
        "- {wait: $a, disabled: true}\n    - succeed",
        "- {succeed: , skip_if: $a > 0, disabled: true}\n    - succeed",
        "- Sub: {b: $a}",
        "- Root",
        "- wiat: 3 s",
    ],
)
def test_a_value_that_something_may_read(check: Check, nodes: str) -> None:
    sub = "  Sub: {inputs: {b: number}, wait: $b}\n" if "Sub" in nodes else ""
    sub = "  Root: {wait: $@a}\n" if "Root" in nodes else sub
    text = f"momantu_bt: 1\nmain: Main\nvalues: {{a: 1 s}}\ntrees:\n  Main:\n    {nodes}\n{sub}"
    assert "unused-value" not in [problem.code for problem in check(text)]


@pytest.mark.parametrize(
    "nodes",
    [
        "- {relocalize: , repeat: -1}\n    - succeed",
        "- always_failure\n    - succeed",
        "- fallback: [{relocalize: , force: success}, relocalize]",
        "- fallback: [{relocalize: , retry: -1}, relocalize]",
        "- {relocalize: , keep_running_until_failure: }\n    - succeed",
        "- Sub\n    - succeed",
        "- if: succeed\n      then: relocalize\n      else: relocalize",
    ],
)
def test_a_node_that_is_never_reached(check: Check, nodes: str) -> None:
    sub = "  Sub: [{fail: {code: NO_WAY}}]\n" if "Sub" in nodes else ""
    assert [code for code, _ in found(check, nodes, sub)] == ["unreachable"]


@pytest.mark.parametrize(
    "nodes",
    [
        "- {relocalize: , repeat: -1, timeout: 3 s, force: success}\n    - succeed",
        "- {always_failure: , invert: }\n    - succeed",
        "- {always_failure: , disabled: true}\n    - succeed",
        "- {always_failure: , skip_if: $@robot.stamp > 3}\n    - succeed",
        "- {relocalize: , repeat: -1}\n    - {succeed: , disabled: true}",
        "- fallback: [{relocalize: , retry: 3}, relocalize]",
    ],
)
def test_a_node_that_may_be_reached(check: Check, nodes: str) -> None:
    assert found(check, nodes) == []
