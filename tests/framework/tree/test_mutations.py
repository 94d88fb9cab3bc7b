"""Slips of the pen in good trees: nearly all are found, and told in the line where they are.

The slips and the judgement are those of `benchmarks/mutations.py`, which makes every slip at every
place; here a sample of them is made.
"""

import importlib.util
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from momantu_bt.tree.catalogue import MODIFIERS, NODES
from momantu_bt.tree.model import Node
from momantu_bt.tree.registry import Registry

ROOT = Path(__file__).parents[3]
LEAST = 0.99
FLOOR = 0.7
"""Of each kind of which the sample has enough; the sample is small, so one miss weighs much."""


def benchmark() -> ModuleType:
    spec = importlib.util.spec_from_file_location("mutations", ROOT / "benchmarks/mutations.py")
    sys.path.insert(0, str(ROOT / "benchmarks"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["mutations"] = module
    spec.loader.exec_module(module)
    return module


MUTATIONS = benchmark()


@pytest.fixture(scope="module")
def trees() -> list[Any]:
    """Every good tree, checked."""
    found: list[Any] = MUTATIONS.good_trees(Registry.installed())
    return found


@pytest.fixture(scope="module")
def tallies(trees: list[Any]) -> dict[str, Any]:
    """The verdicts on two slips of each kind in each tree."""
    found: dict[str, Any] = MUTATIONS.corpus(trees, most=1)
    return found


def test_slips_are_caught_in_their_line(tallies: dict[str, Any]) -> None:
    mistakes = sum(tally.mistakes for tally in tallies.values())
    right = sum(tally.verdicts["right"] for tally in tallies.values())
    told = "\n".join(line for tally in tallies.values() for line in tally.told)
    assert mistakes > 500
    assert right >= LEAST * mistakes, told


def test_every_kind_of_slip_is_caught(tallies: dict[str, Any]) -> None:
    for kind, tally in tallies.items():
        if tally.mistakes >= 5:
            assert tally.caught >= FLOOR * tally.mistakes, f"{kind}: {tally.told}"


def test_every_kind_of_slip_is_made(tallies: dict[str, Any]) -> None:
    assert {kind for kind, tally in tallies.items() if not tally.verdicts} <= {"comma in a number"}


def test_several_slips_are_told_at_once(trees: list[Any]) -> None:
    largest = max(trees, key=lambda tree: len(tree.text))
    files, whole = MUTATIONS.several(largest, 20, seed=1)
    assert files >= 15
    assert whole >= 0.8 * files


def tree(text: str) -> Any:
    header = "momantu_bt: 1\nworld: four_rooms\ntrees:\n  Main:\n"
    return MUTATIONS.GoodTree(Path("t.yaml"), Registry.installed(), text=header + text)


def verdict(good: Any, line: int, changed: str, kind: str = "typo in a key") -> str:
    lines = good.text.splitlines()
    text = "\n".join([*lines[: line - 1], changed, *lines[line:]]) + "\n"
    return str(MUTATIONS.judge(good, MUTATIONS.Mutant(kind, line, changed, text)))


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ("    - reset_pose: hoem", "right"),
        ("    - reset_pose:  home", "same"),
        ("    - [reset_pose: home]", "same"),
        ("    - reset_pose: carry", "missed"),
    ],
)
def test_the_judgement_of_a_node(changed: str, expected: str) -> None:
    assert verdict(tree("    - reset_pose: home\n"), 5, changed) == expected


def test_the_judgement_of_free_text_and_of_what_may_be_left_out() -> None:
    good = tree(
        '    - navigate: {in_front_of: home, side: 1}\n    - fail: {code: A, message: "so"}\n'
    )
    assert verdict(good, 6, '    - fail: {code: A, message: "os"}') == "free"
    assert verdict(good, 6, '    - fail: {code: B, message: "so"}') == "free"
    left_out = verdict(good, 5, "    - navigate: {in_front_of: home}", "input left out")
    assert left_out == "allowed"


def test_good_trees_use_every_node_and_modifier(trees: list[Any]) -> None:
    used = {node.type for good in trees for node in nodes_of(good)}
    assert set(NODES) <= used
    written = set(re.findall(r"\b(\w+):", "".join(good.text for good in trees if not good.as_xml)))
    assert set(MODIFIERS) - {"attributes", "xml"} <= written  # these two hold texts of XML


def nodes_of(good: Any) -> Iterator[Node]:
    for each in good.document.trees.values():
        yield from each.root.walk()
