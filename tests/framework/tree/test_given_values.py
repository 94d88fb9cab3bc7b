"""Values from `--values` and `--set`: what is wrong with one is shown where it is written."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.formats.places import lines_of
from momantu_bt.formats.problems import show
from momantu_bt.tree.files.settings import SET, Given
from momantu_bt.tree.load import TreeError, load, read_values
from momantu_bt.tree.registry import Registry

NODES = "[{wait: $pause}, {succeed: , retry: $n}]"
TREE = f"momantu_bt: 1\nvalues: {{pause: 1 s, n: 2}}\ntrees:\n  Main: {NODES}\n"
KEYS = st.from_regex(r"[a-z_]\w{0,8}", fullmatch=True)
WORDS = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True)
GAPS = st.sampled_from(["", " ", "  "])


@pytest.fixture
def tree(tmp_path: Path) -> str:
    path = tmp_path / "t.yaml"
    path.write_text(TREE, encoding="utf-8")
    return str(path)


def values(folder: Path, text: str) -> Path:
    path = folder / "v.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "code", "line", "column"),
    [
        ("n: 3\npause: 3 m\n", "wrong-value", 2, 8),
        ("# slow\nn: 3\npuase: 3 s\n", "unknown-value", 3, 1),
        ("n:\n  0\n", "wrong-value", 2, 3),
    ],
)
def test_a_problem_in_a_file_of_values(
    tree: str, tmp_path: Path, text: str, code: str, line: int, column: int
) -> None:
    path = values(tmp_path, text)
    with pytest.raises(TreeError) as caught:
        load(tree, Registry(), values=read_values(path))
    (problem,) = caught.value.problems
    assert (problem.code, problem.place.file) == (code, str(path))
    assert (problem.place.line, problem.place.column) == (line, column)
    assert text.splitlines()[line - 1] in show(problem, caught.value.source)


def test_where_a_given_value_is_used(tree: str, tmp_path: Path) -> None:
    with pytest.raises(TreeError) as caught:
        load(tree, Registry(), values=read_values(values(tmp_path, "pause: 3 m\n")))
    assert "does not fit 'duration' of wait" in caught.value.problems[0].message
    assert caught.value.problems[0].hint == f"it is used in line 4 of {tree}"


@pytest.mark.parametrize(
    ("texts", "code", "line", "column"),
    [
        (["n=3", "pause= 3 m"], "wrong-value", 2, 8),
        (["n=0"], "wrong-value", 1, 3),
        ([" puase = 3 s", "n=3"], "unknown-value", 1, 2),
    ],
)
def test_a_problem_in_a_setting(
    tree: str, texts: list[str], code: str, line: int, column: int
) -> None:
    board = Given()
    board.set(texts)
    with pytest.raises(TreeError) as caught:
        load(tree, Registry(), values=board)
    (problem,) = caught.value.problems
    assert (problem.code, problem.place.file) == (code, SET)
    assert (problem.place.line, problem.place.column) == (line, column)
    assert texts[line - 1] in show(problem, caught.value.source)


def test_a_file_that_gives_a_key_twice(tmp_path: Path) -> None:
    with pytest.raises(TreeError) as caught:
        read_values(values(tmp_path, "n: 1\nm: 2\nn: 3\n"))
    (problem,) = caught.value.problems
    assert (problem.code, problem.place.line) == ("duplicate-key", 3)
    assert problem.hint == "the first is in line 1"


@given(st.lists(st.tuples(KEYS, WORDS, GAPS, GAPS), min_size=1, max_size=4))
def test_places_of_settings_are_where_they_stand(parts: list[tuple[str, str, str, str]]) -> None:
    texts = [f"{gap}{key}{gap}={other}{value}" for key, value, gap, other in parts]
    board = Given()
    board.set(texts)
    assert dict(board) == {key: board[key] for key, *_ in parts}
    lines = lines_of(board.source[SET])
    last = {key: value for key, value, *_ in parts}
    for key in board:
        at, key_at = board.places[key], board.key_places[key]
        assert lines[at.line - 1][at.column - 1 :].startswith(last[key])
        assert lines[key_at.line - 1][key_at.column - 1 :].startswith(key)


def test_a_setting_wins_over_the_file(tree: str, tmp_path: Path) -> None:
    board = read_values(values(tmp_path, "n: 1\npause: 3 m\n"))
    board.set(["pause=3 s"])
    assert load(tree, Registry(), values=board).document.values["pause"].value == "3 s"
