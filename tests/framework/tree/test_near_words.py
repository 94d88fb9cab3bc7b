"""What a person probably means: other words for skills, keys without their sign, lost colons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.skill import In, Out, Skill
from momantu_bt.tree.check.checker import check
from momantu_bt.tree.files.xml.format import read as read_xml
from momantu_bt.tree.files.yaml.format import read
from momantu_bt.tree.problems import TreeError
from momantu_bt.tree.registry import Registry


class Pull(Skill):
    """Pull a thing."""

    number: int = In(1, doc="how often")
    place: str = In("table_a", names="surface", doc="where")
    felt: float = Out(doc="force")
    also_called = ("tug_at", "yank")


Found = Callable[[str], list[Problem]]


@pytest.fixture
def found(registry: Registry) -> Found:
    having = replace(registry, skills={"pull": Pull})

    def problems(text: str) -> list[Problem]:
        whole = text if text.startswith("momantu") else "momantu_bt: 1\nworld: rooms\n" + text
        try:
            document, reading = read(whole, "t.yaml", having)
        except TreeError as error:
            return error.problems
        return check(document, having, reading=reading).problems

    return problems


@pytest.mark.parametrize(
    ("node", "hint"),
    [
        ("yank: {number: 2}", "did you mean pull?"),
        ("TugAt: {number: 2}", "did you mean pull?"),
        ("pull {number: 2}", "`pull` needs a colon after it: `pull: {number: …}`"),
        ("pull number: 2", "`pull` needs a colon after it: `pull: {number: …}`"),
        ("Main {number: 2}", "`Main` needs a colon after it: `Main: {number: …}`"),
        ("loop: 3", "did you mean repeat?"),
    ],
)
def test_an_unknown_node(found: Found, node: str, hint: str) -> None:
    (problem,) = found(f"trees:\n  Main:\n    - {node}\n")
    assert problem.code == "unknown-node"
    assert problem.hint == hint


def test_a_key_without_its_sign(found: Found) -> None:
    nodes = "trees:\n  Main:\n    - pull: {felt: $force}\n    - pull: {number: force}\n"
    problems = [p for p in found(nodes) if p.severity.label == "error"]
    assert [(p.code, p.hint) for p in problems] == [("wrong-value", "did you mean $force?")]
    nodes = "values: {top: table_a}\ntrees:\n  Main:\n    - pull: {place: top}\n"
    problems = [p for p in found(nodes) if p.severity.label == "error"]
    assert [(p.code, p.hint) for p in problems] == [("unknown-surface", "did you mean $top?")]


@pytest.mark.parametrize(
    ("trees", "hint"),
    [
        ("  - Main:\n      - pull: {number: 2}\n", "write `Main:` without `- ` before it"),
        ("  - pull: {number: 2}\n  - wait: 1 s\n", "write a name such as `Main:` above the list"),
        ("  - wait\n", "write a name such as `Main:` above the list"),
    ],
)
def test_trees_as_a_list(found: Found, trees: str, hint: str) -> None:
    first, *others = found(f"trees:\n{trees}")
    assert (first.code, first.place.line) == ("wrong-value", 4)
    assert hint in first.hint
    assert [p.code for p in others] == (["missing-input"] if "  - wait\n" in trees else [])


def test_an_unknown_leaf_in_xml_may_also_stand_elsewhere(registry: Registry) -> None:
    having = replace(registry, skills={"pull": Pull})
    text = '<root BTCPP_format="4"><BehaviorTree ID="M"><Pul/></BehaviorTree></root>'
    document, reading = read_xml(text, "t.xml", having)
    (problem,) = check(document, having, reading=reading).problems
    assert problem.hint.startswith("did you mean pull? If it stands elsewhere: ")
    assert "skills stub FILE" in problem.hint
