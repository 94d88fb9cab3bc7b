"""Lines that stand too far left or right: one error each, and the rest is read as meant."""

from collections.abc import Callable

import pytest

from momantu_bt.formats.problems import Problem

Check = Callable[[str], list[Problem]]

TEXT = """\
momantu_bt: 1
world: rooms
main: Main
values:
  from: table
trees:
  Main:
    recover:
      attempts: 2
      try:
        - Sub: {a: $from}
        - Sub: {a: y}
      catch:
        X_Y:
          say: lost
        any: {wait: 1 s}
  Sub:
    inputs: {a: text}
    recover:
      attempts: 2
      try:
        sequence:
          - say: $a
          - fail: {code: X_Y, message: m}
      catch:
        X_Y: {fail: {code: X_Y, message: m}}
  Last:
    sequence:
      - Sub: {a: z}
      - Sub: {a: z}
      - Sub: {a: z}
"""


def indented(text: str, first: int, last: int, by: int) -> str:
    """The text with some of its lines moved by so many columns."""
    lines = text.splitlines()
    for number in range(first - 1, last):
        lines[number] = " " * by + lines[number] if by > 0 else lines[number][-by:]
    return "\n".join(lines) + "\n"


def found(check: Check, text: str) -> list[tuple[str, int]]:
    return [(p.code, p.place.line) for p in check(text) if p.severity.label == "error"]


def test_the_text_is_right(check: Check) -> None:
    assert found(check, TEXT) == []


@pytest.mark.parametrize(
    ("lines", "by", "line", "hint"),
    [
        ((5, 5), -2, 5, "under `values:`"),
        ((8, 8), -2, 8, "under `Main:`"),
        ((8, 16), -2, 8, "under `Main:`"),
        ((9, 16), -2, 9, "under `recover:`"),
        ((13, 13), -2, 13, "under `recover:`"),
        ((13, 16), -2, 13, "under `recover:`"),
        ((15, 15), -2, 15, "under `X_Y:`"),
        ((17, 17), 2, 17, "to the column of `Main:`"),
        ((17, 26), 2, 17, "to the column of `Main:`"),
        ((18, 26), -2, 18, "under `Sub:`"),
        ((22, 24), -2, 22, "under `try:`"),
        ((25, 25), 2, 25, "to the column of `try:`"),
        ((25, 26), 2, 25, "to the column of `try:`"),
        ((27, 27), 2, 27, "to the column of `Sub:`"),
        ((27, 31), -2, 27, "under `trees:`"),
    ],
)
def test_one_wrong_indentation_is_one_error(
    check: Check, lines: tuple[int, int], by: int, line: int, hint: str
) -> None:
    problems = [p for p in check(indented(TEXT, *lines, by)) if p.severity.label == "error"]
    assert [(p.code in ("indentation", "unknown-key"), p.place.line) for p in problems] == [
        (True, line)
    ]
    assert hint in problems[0].hint


def test_what_else_is_wrong_in_a_misplaced_tree_is_told_too(check: Check) -> None:
    text = indented(TEXT.replace("say: $a", "say: $b"), 17, 17, 2)
    assert found(check, text) == [("indentation", 17), ("read-before-write", 23)]


@pytest.mark.parametrize(
    ("slip", "code"),
    [
        (("inputs: {a: text}", "inputs: {a text}"), "bad-name"),
        (("inputs: {a: text}", "inputs: {a: [text]}"), "wrong-value"),
        (("inputs: {a: text}", "inputs{a: text}"), "unknown-key"),
        (("inputs: {a: text}", "inputs: {a: {type: text, defalt: x}}"), "unknown-key"),
    ],
)
def test_an_input_that_cannot_be_read_is_one_error(
    check: Check, slip: tuple[str, str], code: str
) -> None:
    assert found(check, TEXT.replace(*slip)) == [(code, 18)]


def test_an_output_that_cannot_be_read_is_one_error(check: Check) -> None:
    text = (
        "momantu_bt: 1\nmain: Main\ntrees:\n  Main:\n    - Sub: {b: $b}\n    - say: $b\n"
        "  Sub:\n    outputs: {b=text}\n    set: {key: $b, value: x}\n"
    )
    assert found(check, text) == [("bad-name", 8)]


def test_an_equals_sign_in_ports_is_a_colon(check: Check) -> None:
    (problem,) = check("momantu_bt: 1\ntrees:\n  Main:\n    - say: {text=hello}\n")
    assert (problem.code, problem.hint) == ("braces", "write {text: hello}")


def test_a_part_of_the_wanted_type_is_suggested(check: Check) -> None:
    text = (
        "momantu_bt: 1\nworld: rooms\ntrees:\n  Main:\n"
        "    - detect_object: {object: {category: can, diameter: 0.07, height: 0.1}, on: table,"
        " found: $o}\n    - navigate: {within_reach_of: $o}\n"
    )
    found = [p for p in check(text) if p.code == "wrong-type"]
    assert [p.hint for p in found] == ["did you mean $o.pose?"]
