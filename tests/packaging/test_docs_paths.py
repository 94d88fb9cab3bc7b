"""Files, modules and tests that the documentation names exist; its tables of files are whole."""

from __future__ import annotations

import importlib.util
import re
import subprocess
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
PACKAGES = {
    "momantu_bt": ROOT / "momantu_bt",
    "momantu_skills": ROOT / "skills" / "momantu_skills",
    "momantu_worlds": ROOT / "worlds" / "momantu_worlds",
}
TOPS = ("benchmarks/", "docs/", "momantu_bt/", "setup/", "skills/", "tests/", "trees/", "worlds/")
IN_PROSE = rf"(?<![\w./])(?:{'|'.join(TOPS)})[\w./-]+"
OF_THE_READER = {
    "src/pace_nodes/pace.py",
    "tests/test_pace.py",
    "src/door/door.py",
    "mounted.py",
    "test_look_round.py",
    "touch_button/src/touch_button_skill/touch_button.py",
    "touch_button/tests/test_touch_button.py",
    "turn/src/turn_skill/turn.py",
    "turn/tests/test_speed.py",
}
"""Files that a page asks its reader to write."""
GENERATED = {"records/", "trees/schema.json"}
"""Files that a command on a page writes."""
PLACEHOLDER = re.compile(r"\b(CODE|NAME)\b")
API = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
GROUPS = set(
    re.findall(r"^\| `(momantu_bt\.\w+)` \|", API.partition("## Entry points")[2], re.MULTILINE)
)
"""Groups of entry points; `test_reference` checks their table."""


@cache
def files() -> frozenset[str]:
    """Every file and folder of the project."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    said = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    found = {path for path in said.splitlines() if (ROOT / path).exists()}
    return frozenset(found | {str(folder) for path in found for folder in Path(path).parents})


def prose(page: Path) -> str:
    """A page without its fenced blocks."""
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def is_there(named: str) -> bool:
    """Whether a file or folder has the name; `*` stands for anything, a path may begin anywhere."""
    named = PLACEHOLDER.sub("*", named)
    patterns = (named, f"*/{named}", f"{named}.py")
    return any(fnmatch(path, pattern) for path in files() for pattern in patterns)


def missing_part(dotted: str) -> str | None:
    """The part of a dotted name that nothing is called."""
    top, *rest = dotted.split(".")
    here = PACKAGES[top]
    for number, part in enumerate(rest):
        if (here / part).is_dir():
            here /= part
        elif (here / f"{part}.py").is_file():
            here /= f"{part}.py"
        else:
            source = here if here.is_file() else here / "__init__.py"
            known = set(re.findall(r"\w+", source.read_text(encoding="utf-8")))
            return next((word for word in rest[number:] if word not in known), None)
    return None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_files_and_folders_exist(page: Path) -> None:
    spans = [" ".join(span.split()) for span in re.findall(r"`([^`]+)`", prose(page))]
    named = {span for span in spans if re.fullmatch(r"[\w./*-]+", span)}
    told = {span for span in named if span.startswith(TOPS) or span.endswith((".py", "/"))}
    told |= {path.rstrip(".") for path in re.findall(IN_PROSE, prose(page))}
    beside = {path for path in told if (page.parent / path).exists()}
    absent = {path for path in told if not is_there(path.rstrip("/"))}
    assert absent - beside - OF_THE_READER - GENERATED == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_modules_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    dotted = set(re.findall(r"\bmomantu_(?:bt|skills|worlds)(?:\.[A-Za-z_]\w*)+", text)) - GROUPS
    dotted = {name.removesuffix(".toml").removesuffix(".yaml") for name in dotted}
    assert [name for name in sorted(dotted) if missing_part(name)] == []


@cache
def all_tests() -> str:
    """The text of all tests, for names of functions."""
    return "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_tests_exist(page: Path) -> None:
    absent = []
    for name, cut in re.findall(r"(?<!\w)((?:\w+/)*test_\w+)(…|\*)?", prose(page)):
        is_file = is_there(f"{name}.py")
        if not is_file and not re.search(rf"def {name}{'' if cut else '[(]'}", all_tests()):
            absent.append(name)
    assert (
        set(absent) - {path.removesuffix(".py") for path in OF_THE_READER} - {"test_node"} == set()
    )


def test_what_registers_an_addition_stands_in_its_file() -> None:
    page = " ".join((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split())
    named = re.findall(r"`(\w+)`(?: or `(\w+)`)? in `([\w/]+\.py)`", page)
    assert len(named) >= 8
    for *names, path in named:
        text = (ROOT / path).read_text(encoding="utf-8")
        assert all(re.search(rf"\b{name}\b", text) for name in names if name), f"{names}: {path}"
    examples = re.findall(r"`([\w/]+/)`, such as `([\w/]+\.py)`", page)
    assert len(examples) >= 10
    assert [path for path in examples if not (ROOT / "".join(path)).is_file()] == []
    groups = set(re.findall(r"`pyproject.toml`: `([\w.]+)`", page))
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert {group for group in groups if f'"{group}"' not in project} == set()


def test_the_tables_of_files_are_those_of_the_files() -> None:
    spec = importlib.util.spec_from_file_location("file_tables", ROOT / "setup" / "file_tables.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    assert page == module.with_tables(page), "run `.venv/bin/python setup/file_tables.py`"
