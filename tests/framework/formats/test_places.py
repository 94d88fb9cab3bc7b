"""The caret stands under the word, whatever the line; nothing can upset a terminal."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import NOWHERE, Place, excerpt, within
from momantu_bt.formats.problems import Problem, Severity, show

ODD = st.text(alphabet="a é日本😀\u0301ｱ\t$:{}-", max_size=30)


def cells(text: str) -> int:
    """Columns of a terminal, a tab counted as one."""
    marks = ("Mn", "Me")
    wide = (1 + (unicodedata.east_asian_width(c) in "WF") for c in text)
    return sum(n for n, c in zip(wide, text, strict=True) if unicodedata.category(c) not in marks)


@given(ODD, st.text(alphabet="日ax", min_size=1, max_size=5), ODD)
def test_the_caret_is_under_the_word(before: str, word: str, after: str) -> None:
    problem = Problem("x", "m", Place("t", 1, len(before) + 1, len(word)))
    _, shown, caret = show(problem, {"t": before + word + after}).splitlines()
    prefix = caret.index("|") + 2
    assert shown[prefix:] == before + word + after
    assert cells(caret[prefix:].rstrip("^")) == cells(before)
    assert caret.count("^") == cells(word)
    assert caret.count("\t") == before.count("\t")


@given(st.integers(1, 2000), st.integers(1, 2000), st.integers(1, 50))
def test_any_place_in_or_beyond_a_line_can_be_shown(size: int, column: int, length: int) -> None:
    text = show(Problem("x", "m", Place("t", 1, column, length), "do"), {"t": "b" * size})
    head, shown, caret = text.splitlines()
    assert head == f"t:1:{column}: error: m [x]"
    assert len(shown) < 140
    assert 1 <= caret.count("^") <= max(1, min(length, 120))
    assert caret.endswith("^ do")


@pytest.mark.parametrize("character", ["\x1b", "\x07", "\x85", "\u202e", "\u2028"])
def test_what_could_upset_a_terminal_is_not_shown(character: str) -> None:
    problem = Problem("x", "m", Place("t", 2, 3))
    shown = show(problem, {"t": f"first\n{character}a b\nlast"})
    assert character not in shown
    assert "\ufffda b" in shown


@pytest.mark.parametrize("break_", ["\n", "\r\n", "\r"])
def test_line_ends_of_every_kind_end_lines(break_: str) -> None:
    source = {"t": break_.join(["one", "two: 3", "four"])}
    shown = show(Problem("x", "m", Place("t", 2, 1, 3), severity=Severity.WARNING), source)
    assert shown == "t:2:1: warning: m [x]\n  2 | two: 3\n    | ^^^"
    assert within(Place("t", 2, 1, 6), "3", source) == Place("t", 2, 6, 1)


def test_a_word_is_found_whole_and_behind_the_place() -> None:
    source = {"t": "$ab $a $a"}
    assert within(Place("t", 1, 1, 9), "$a", source) == Place("t", 1, 5, 2)
    assert within(Place("t", 1, 6, 4), "$a", source) == Place("t", 1, 8, 2)
    assert within(Place("t", 1, 1, 9), "$c", source) == Place("t", 1, 1, 9)


def test_a_place_that_the_file_does_not_have_shows_the_note_alone() -> None:
    assert excerpt(Place("t", 9), "one\n", "do this") == "  do this"
    assert excerpt(Place("t", 9), "one\n") == ""
    assert show(Problem("", "m", NOWHERE, "do this"), {}) == "error: m\n  do this"
