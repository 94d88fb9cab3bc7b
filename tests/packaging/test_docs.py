"""The documentation is true where a machine can tell: its links, its examples, its commands."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

from momantu_bt.cli import VERBS
from momantu_bt.failure import CODE

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of one language on a page."""
    return re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_exist(page: Path) -> None:
    verbs = re.findall(r"(?:^|`|bin/)momantu-bt ([a-z]+)", page.read_text("utf-8"), re.MULTILINE)
    assert set(verbs) - set(VERBS) == set()


def test_the_worked_skill_passes_its_own_test(monkeypatch: pytest.MonkeyPatch) -> None:
    page = ModuleType("worked_skill")
    # Port types are looked up in the module that declares the class.
    monkeypatch.setitem(sys.modules, page.__name__, page)
    for block in blocks(ROOT / "docs" / "writing_a_skill.md", "python"):
        exec(block, page.__dict__)
    tests = [value for name, value in vars(page).items() if name.startswith("test_")]
    assert len(tests) == 2
    for test in tests:
        test()


def test_the_readme_quotes_the_tree_as_it_is() -> None:
    (quoted,) = blocks(ROOT / "README.md", "yaml")
    tree = (ROOT / "trees" / "bring_object.yaml").read_text(encoding="utf-8")
    for code in CODE.finditer(quoted):
        assert code.group() in tree
    indented = "".join(f"  {line}\n" for line in quoted.splitlines())
    assert indented in tree
