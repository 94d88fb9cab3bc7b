"""The language's pages: their examples are right, tables complete, the tests they name exist."""

import ast
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.formats.problems import Problem
from momantu_bt.tree.catalogue import NODES
from momantu_bt.tree.show.problem_pages import codes

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "tree_language.md").read_text(encoding="utf-8")
XML_PAGE = (ROOT / "docs" / "xml.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```(?:yaml|xml)\n(.*?)```", PAGE + XML_PAGE, re.DOTALL)
ROOMS = (ROOT / "momantu_bt" / "formats", ROOT / "momantu_bt" / "tree")
SOURCES = [path for room in ROOMS for path in room.rglob("*.py")]


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_have_no_errors(check: Callable[[str], list[Problem]], example: str) -> None:
    if not example.startswith(("momantu_bt", "<root")):
        indented = "".join(f"    {line}\n" for line in example.splitlines())
        example = f"momantu_bt: 1\nworld: rooms\ntrees:\n  Main:\n{indented}"
    assert check(example) == []


def test_the_table_has_every_built_in_node() -> None:
    page = PAGE[: PAGE.index("## Modifiers")]
    rows = re.findall(r"^\| `(\w+)` \| (\w+)[^|]*\|([^|]*)\|$", page, re.MULTILINE)
    shown = {type_: (yaml, set(re.findall(r"`(\w+)`", ports))) for yaml, type_, ports in rows}
    assert shown == {spec.type: (spec.yaml[0], set(spec.ports)) for spec in NODES.values()}


@pytest.mark.parametrize(
    ("page", "least"), [("tree_language.md", 30), ("xml.md", 30), ("convert.md", 14)]
)
def test_every_test_that_a_rule_names_exists(page: str, least: int) -> None:
    rules = (ROOT / "docs" / page).read_text(encoding="utf-8")
    named = re.findall(r"\b(test_\w+):\s+((?:test_\w+,?\s*)+)", rules)
    assert len(named) >= least
    for file, tests in named:
        path = next((ROOT / "tests" / "framework").rglob(f"{file}.py"))
        text = path.read_text(encoding="utf-8")
        for test in re.findall(r"test_\w+", tests):
            assert f"def {test}(" in text, f"{file}: {test}"


def _reported() -> set[str]:
    """Codes in calls such as `problems.error("code", …)` and `Problem("code", …)`."""
    found: set[str] = set()
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and node.args:
                first = node.args[0]
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                told = ("error", "warning", "hint", "Problem", "_error", "_broken")
                if name in told and isinstance(first, ast.Constant):
                    found.add(str(first.value))
    return found


def test_the_table_has_every_code() -> None:
    table = PAGE[PAGE.index("| code |") :]
    cells = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    shown = {code for cell in cells for code in re.findall(r"`([\w-]+)`", cell)}
    assert shown == set(codes())


def test_every_code_that_can_be_reported_has_a_page() -> None:
    names = {"unknown-place", "unknown-surface", "unknown-tag", "unknown-named-pose"}
    assert _reported() | names == set(codes())
