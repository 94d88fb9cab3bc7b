"""YAML text: places, YAML 1.2's values, syntax errors in our words, and bounds."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from momantu_bt.formats.problems import show
from momantu_bt.formats.yaml.reader import YamlSyntaxError
from momantu_bt.formats.yaml.values import plain_value
from momantu_bt.tree.files.syntax import MAX_BYTES, YAML_RULES, compose
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError

MAX_DEPTH, MAX_NODES = YAML_RULES.most_depth, YAML_RULES.most_values


def values(text: str) -> Any:
    """The plain value of a YAML text."""
    return plain_value(compose(text, "t.yaml"))


def test_yaml_1_2_values() -> None:
    text = "[yes, no, on, true, false, 010, 0x10, 1.5, 1e3, 12:30, ~, null, '', \"3\", -4]"
    expected = ["yes", "no", "on", True, False, 10, 16, 1.5, 1000.0, "12:30"]
    assert values(text) == [*expected, None, None, "", "3", -4]


def test_an_anchor_is_used_again() -> None:
    assert values("a: &x {b: 1}\nc: *x\n") == {"a": {"b": 1}, "c": {"b": 1}}


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("a: b: c", 1, 5, "a `:` that does not belong here"),
        ("a: [1, 2", 1, 4, "a `[` that is never closed"),
        ("a: {b: 1", 1, 4, "a `{` that is never closed"),
        ("a: 'x", 1, 4, "a quote that is never closed"),
        ("a: @x", 1, 4, "cannot begin with @"),
        ("a: `x", 1, 4, "cannot begin with `"),
        ("a:\n\t- b", 2, 1, "a tab"),
        ("- a\nb: 1", 2, 1, "neither the list's next item"),
        ("a: !b", 1, 4, "begins a YAML tag"),
        ("a: *b", 1, 4, "`*b` stands for nothing"),
        ("a: &x [*x]", 1, 8, "contains it"),
        ("a: 1\n---\nb: 2", 2, 1, "a second document"),
        ("a: b\n c: d", 2, 3, "a `:` that does not belong here"),
        ("a: - b", 1, 4, "a list cannot begin here"),
        ('a: "\\q"', 1, 6, "a backslash that means nothing"),
        ("a: \x01", 1, 4, "U+0001"),
        ("%TAG x", 1, 1, "cannot begin with `%`"),
        ("'a' 'b'", 1, 5, "follows the end"),
        ("{a: b}: c", 1, 1, "cannot be a key"),
        ("", 1, 1, "the file is empty"),
        ("# nothing\n", 1, 1, "the file is empty"),
    ],
)
def test_a_syntax_error_in_our_words(text: str, line: int, column: int, message: str) -> None:
    with pytest.raises(YamlSyntaxError, match="(?s).*") as caught:
        compose(text, "t.yaml")
    problem = caught.value.problem
    assert message in problem.message
    assert (problem.place.line, problem.place.column) == (line, column)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("- {script: $a := b ? 1 : 2}", 'put the script in quotes: script: "$a := b ? 1 : 2"'),
        ("- {if: a ? b : 'c', then: x}", "put the script in quotes: if: \"a ? b : 'c'\""),
        ("- {wait: 1 s, skip_if: a ? b : c}", 'put the script in quotes: skip_if: "a ? b : c"'),
        ("- {message: who ? me : you}", ""),
        ("- {script: $a := 1", ""),
    ],
)
def test_a_script_within_braces_that_yaml_reads_otherwise(text: str, hint: str) -> None:
    with pytest.raises(YamlSyntaxError) as caught:
        compose(text, "t.yaml")
    assert "a `{` that is never closed" in caught.value.problem.message
    assert caught.value.problem.hint == hint


def test_modifiers_under_a_bare_node_say_what_is_missing() -> None:
    with pytest.raises(YamlSyntaxError) as caught:
        compose("- relocalize\n  retry: 3\n", "t.yaml")
    hint = "line 1: write `relocalize:` when more follows below it"
    assert caught.value.problem.hint == hint


def _bomb() -> str:
    lines = ["a: &a [x, x, x, x, x, x, x, x, x, x]"]
    for name, before in zip("bcdefghi", "abcdefgh", strict=True):
        lines.append(f"{name}: &{name} [{', '.join(['*' + before] * 10)}]")
    return "\n".join(lines)


def _chain() -> str:
    """Each value nested as deep as may be around the one before."""
    names = [f"n{i}" for i in range(12)]
    lines = [f"{names[0]}: &{names[0]} x"]
    for name, before in zip(names[1:], names, strict=False):
        lines.append(f"{name}: &{name} {'[' * 90}*{before}{']' * 90}")
    return "\n".join(lines)


@pytest.mark.parametrize(
    "text",
    [
        "[" * (MAX_DEPTH + 1),
        "[" * 200_000,
        "x" * (MAX_BYTES + 1),
        "[" + "1, " * MAX_NODES + "1]",
        _bomb(),
        _chain(),
    ],
    ids=["deep", "deeper", "long", "many", "aliases", "deep aliases"],
)
def test_bounds(text: str) -> None:
    with pytest.raises(YamlSyntaxError) as caught:
        compose(text, "t.yaml")
    assert caught.value.problem.code == "too-large"


TREES = Path(__file__).parents[3] / "trees"
TEXT = (TREES / "bring_object.yaml").read_text(encoding="utf-8")


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_a_damaged_file_is_read_or_refused_with_places_inside_it(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(TEXT)))
    end = data.draw(st.integers(start, min(len(TEXT), start + 30)))
    noise = data.draw(st.text(alphabet="ab$@.:-,[]{}'\"&*!|#\n \t01", max_size=6))
    text = TEXT[:start] + noise + TEXT[end:]
    try:
        problems = read(text, "t.yaml")[1].sorted()
    except TreeError as error:
        problems = error.problems
    lines = text.splitlines()
    for problem in problems:
        assert 1 <= problem.place.line <= len(lines) + 1
        assert problem.message in show(problem, {"t.yaml": text})


def test_half_a_character_is_refused() -> None:
    with pytest.raises(YamlSyntaxError) as refused:
        compose('name: "a\\ud800b"\n', "t.yaml")
    problem = refused.value.problem
    assert (problem.place.line, problem.place.column) == (1, 7)
    assert "half a character" in problem.message
