"""The documentation is true where a machine can tell: its links, its examples, its commands."""

from __future__ import annotations

import re
import sys
from inspect import signature
from pathlib import Path
from types import ModuleType

import pytest

from momantu_bt.cli import COMMANDS, VERBS, main
from momantu_bt.pytest_plugin import RunTree

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
]
PAGES += sorted((ROOT / "docs" / "skills").glob("*.md"))


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
    assert set(verbs) - set(VERBS) - set(COMMANDS.installed()) == set()


def test_the_worked_skill_passes_its_own_tests(
    monkeypatch: pytest.MonkeyPatch, run_tree: RunTree
) -> None:
    page = ModuleType("worked_skill")
    # Port types are looked up in the module that declares the class.
    monkeypatch.setitem(sys.modules, page.__name__, page)
    for block in blocks(ROOT / "docs" / "writing_a_skill.md", "python"):
        exec(block, page.__dict__)
    tests = [value for name, value in vars(page).items() if name.startswith("test_")]
    assert len(tests) == 8
    for test in tests:
        test(*([run_tree] if "run_tree" in signature(test).parameters else []))


def test_the_readmes_tree_is_free_of_mistakes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (subtree,) = blocks(ROOT / "README.md", "yaml")
    name = subtree.partition(":")[0]
    document = ["momantu_bt: 1", "world: four_rooms", "main: Main", "trees:"]
    document += ["  Main:", f"    - {name}: {{surface: table_a}}"]
    document += [f"  {line}" for line in subtree.splitlines()]
    file = tmp_path / "readme.yaml"
    file.write_text("\n".join(document) + "\n", encoding="utf-8")
    assert main(["check", str(file)]) == 0, capsys.readouterr()
