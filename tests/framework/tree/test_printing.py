"""Trees in plain words, and problems with their line and caret."""

import pytest

from momantu_bt.formats.places import Place
from momantu_bt.formats.problems import Problem, Severity, show
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.show.printing import lines, text, tree_lines, unwrap


def printed(node: str) -> list[str]:
    """The lines of a tree `Main` of one node, indented."""
    document, problems = read(f"momantu_bt: 1\ntrees: {{Main: {node}}}\n", "t.yaml")
    assert problems.sorted() == []
    return ["  " * line.depth + line.text for line in tree_lines(document.trees["Main"].root)]


@pytest.mark.parametrize(
    ("node", "line"),
    [
        ("{go: , retry: 3, timeout: 60 s}", "go  (3 tries, at most 60 s)"),
        ("{go: , timeout: 60, retry: 3}", "go  (at most 60 s, 3 tries)"),
        ("{go: , retry: -1}", "go  (tries without end)"),
        ("{go: , repeat: 2}", "go  (2 rounds)"),
        ("{go: , invert: , delay: 1 s}", "go  (inverted, after 1 s)"),
        ("{go: , skip_if: not $a, name: way}", "way: go  (skip_if not $a)"),
        ("{go: , disabled: true}", "go  (disabled)"),
        ("{go: {to: $x.pose, n: 2}}", "go to $x.pose, n 2"),
        ("{go: {to: $@x}}", "go to $@x"),
        ("{wait: 2 s}", "wait 2 s"),
        ('{go: "${n} of 3"}', 'go "${n} of 3"'),
        ("{go: {x: {a: [1, true]}}}", "go x {a: [1, true]}"),
        ("{condition: $n > 2 and $m}", "condition $n > 2 and $m"),
    ],
)
def test_one_line(node: str, line: str) -> None:
    assert printed(node) == [line]


def test_nesting() -> None:
    node = "{recover: {attempts: 3, try: [a, b], catch: {A | B: again, any: c}}, timeout: 2 min}"
    assert printed(node) == [
        "recover with 3 tries  (at most 2 min)",
        "  sequence",
        "    a",
        "    b",
        "  on A or B: try again",
        "  on anything else:",
        "    c",
    ]


def test_branches_say_which_is_which() -> None:
    assert printed("{if: $n > 2, then: a, else: [b]}") == [
        "if",
        "  if: condition $n > 2",
        "  then: a",
        "  else: sequence",
        "    b",
    ]


def test_a_document_begins_with_its_main_tree() -> None:
    trees = "A: {inputs: {n: int}, outputs: {m: text}, go: }, B: [A]"
    document, _ = read(f"momantu_bt: 1\nmain: B\ntrees: {{{trees}}}\n", "t.yaml")
    heads = [line.text for line in lines(document) if line.depth == 0]
    assert heads == ["B", "A takes n (int) gives m (text)"]


def test_a_node_is_found_within_its_decorators() -> None:
    document, _ = read("momantu_bt: 1\ntrees: {A: {go: , retry: 3, timeout: 1 s}}\n", "t.yaml")
    node, around = unwrap(document.trees["A"].root)
    assert node.type == "go"
    assert [outer.type for outer in around] == ["Timeout", "RetryUntilSuccessful"]
    assert text(node) == "go"


def test_a_problem_has_a_caret_under_its_place() -> None:
    problem = Problem("unknown-node", "no node is called 'pik'", Place("t.yaml", 2, 5, 3), "pick?")
    assert show(problem, {"t.yaml": "a:\n  - pik: 3\n"}) == (
        "t.yaml:2:5: error: no node is called 'pik' [unknown-node]\n"
        "  2 |   - pik: 3\n"
        "    |     ^^^ pick?"
    )


def test_a_tab_before_the_place_stays_a_tab() -> None:
    problem = Problem("syntax", "a tab", Place("t.yaml", 1, 2))
    assert show(problem, {"t.yaml": "\tx"}).splitlines()[-1] == "    | \t^"


def test_a_long_line_is_shown_around_the_place() -> None:
    problem = Problem("x", "y", Place("t.yaml", 1, 501, 2), severity=Severity.HINT)
    shown = show(problem, {"t.yaml": "a" * 500 + "bb" + "c" * 500}).splitlines()
    caret = shown[2].index("^")
    assert shown[1][caret : caret + 2] == "bb"
    assert len(shown[1]) < 140


def test_a_place_outside_of_the_text_shows_the_hint_alone() -> None:
    problem = Problem("x", "y", Place("t.yaml", 9, 1), "do this")
    assert show(problem, {}) == "t.yaml:9:1: error: y [x]\n  do this"
