"""The API reference: it builds without network, and has the public modules and nothing else."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "setup" / "reference.py"
BUILD = """\
import runpy, socket, sys, warnings
from pathlib import Path

def refuse(*arguments, **options):
    raise OSError("no network here")

socket.socket.connect = refuse
warnings.simplefilter("error")
runpy.run_path(sys.argv[1])["build"](Path(sys.argv[2]))
"""


def reference() -> ModuleType:
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("reference", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


PUBLIC: tuple[str, ...] = reference().PUBLIC


def test_it_builds_a_page_for_each_public_module_and_no_other(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", BUILD, str(SCRIPT), str(tmp_path)], check=True)
    pages = {page.relative_to(tmp_path).with_suffix("") for page in tmp_path.rglob("*.html")}
    assert {".".join(page.parts) for page in pages} - {"index"} == set(PUBLIC)
    package = (tmp_path / "momantu_bt.html").read_text(encoding="utf-8")
    assert all(f'href="{name.replace(".", "/")}.html"' in package for name in PUBLIC)
    assert 'id="Skill.run"' in (tmp_path / "momantu_bt" / "skill.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_is_explained(name: str) -> None:
    module = importlib.import_module(name)
    assert inspect.getdoc(module)
    names = getattr(module, "__all__", [word for word in vars(module) if word[0] != "_"])
    found = {word: getattr(module, word) for word in names}
    own = {
        word: value
        for word, value in found.items()
        if inspect.isclass(value) or inspect.isfunction(value)
        if hasattr(module, "__all__") or value.__module__ == name
    }
    members = {
        f"{word}.{member}": value
        for word, kind in own.items()
        if inspect.isclass(kind)
        for member, value in vars(kind).items()
        if member[0] != "_" and (inspect.isfunction(value) or isinstance(value, property))
    }
    assert [word for word, value in {**own, **members}.items() if not value.__doc__] == []


def test_the_page_lists_the_public_modules() -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    table = page.partition("## Public modules")[2].partition("\n## ")[0]
    cells = re.findall(r"^\| (`[^|]+`) \|", table, re.MULTILINE)
    assert sorted(re.findall(r"`([\w.]+)`", " ".join(cells))) == sorted(PUBLIC)


def test_the_page_lists_the_groups_of_entry_points() -> None:
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    table = page.partition("## Entry points")[2].partition("\n## ")[0]
    listed = re.findall(r"^\| `([\w.]+)` \|", table, re.MULTILINE)
    groups = r'Group(?:\[[^=]*\])?\(\s*"(momantu_bt\.\w+)"'
    packages = ("momantu_bt", "skills", "worlds")
    files = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    sources = [path.read_text(encoding="utf-8") for path in files]
    assert sorted(listed) == sorted(found for text in sources for found in re.findall(groups, text))
