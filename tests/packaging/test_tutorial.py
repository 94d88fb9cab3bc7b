"""The tutorials work: files are saved and commands run, in order, in an empty folder."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
FILE = re.compile(r"`([\w/]+\.(?:yaml|py))`:\s*$")
PIP = """#!/bin/sh
# without network, into a folder of the test's own
[ "$1" = install ] && shift
exec "{python}" -m pip install -q --no-deps --no-index --no-build-isolation \
    --disable-pip-version-check --target "{site}" "$@"
"""


def steps(page: str) -> list[tuple[str, str]]:
    """(path, text) of each file to save and ("", line) of each command, in order."""
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    found: list[tuple[str, str]] = []
    for block in BLOCK.finditer(text):
        language, body = block.groups()
        if language == "sh":
            found += [("", line) for line in body.splitlines()]
            continue
        named = FILE.search(text[: block.start()].rstrip())
        assert named is not None, f"which file is this?\n{body}"
        found.append((named[1], body))
    return found


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """`momantu-bt`, `pip` and `pytest` of this Python; what pip installs stays in the test."""
    tools, site = tmp_path / "tools", tmp_path / "site"
    tools.mkdir()
    site.mkdir()
    # folders on PYTHONPATH do not read .pth files, which editable installs are made of
    (site / "sitecustomize.py").write_text(f"import site\nsite.addsitedir({str(site)!r})\n")
    scripts = {
        "pip": PIP.format(python=sys.executable, site=site),
        "pytest": f'#!/bin/sh\nexec "{sys.executable}" -m pytest -q "$@"\n',
        "momantu-bt": f'#!/bin/sh\nexec "{sys.executable}" -m momantu_bt "$@"\n',
    }
    for name, text in scripts.items():
        (tools / name).write_text(text, encoding="utf-8")
        (tools / name).chmod(0o755)
    path = [str(site), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {
        **os.environ,
        "PATH": f"{tools}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": os.pathsep.join(path),
        "PYTEST_PLUGINS": "momantu_bt.pytest_plugin",
    }


def followed(page: str, folder: Path, environment: dict[str, str], leave_out: str = "") -> str:
    """Save every file of a page and run its commands; returns all that they printed.

    leave_out: a word of commands that are not run.
    """
    folder.mkdir()
    told = ""
    for path, text in steps(page):
        if path:
            file = folder / path
            file.write_text(text, encoding="utf-8")
            continue
        if leave_out and leave_out in text:
            continue
        done = subprocess.run(
            ["sh", "-c", text], cwd=folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
        told += done.stdout + done.stderr
    return told


@pytest.mark.slow
def test_every_command_of_the_tutorial_succeeds(
    tmp_path: Path, environment: dict[str, str]
) -> None:
    folder = tmp_path / "empty"
    told = followed("tutorial", folder, environment)
    assert (folder / "report.json").is_file()
    assert "no node is called 'check_turn'" in told
    assert "ok    turn" in told


def test_the_tutorial_saves_and_runs_something() -> None:
    found = steps("tutorial")
    assert {path for path, _ in found} > {"first.yaml", "look_round.yaml", "test_look_round.py"}
    assert len([line for path, line in found if not path]) > 10


@pytest.mark.slow
def test_the_button_is_touched(tmp_path: Path, environment: dict[str, str]) -> None:
    folder = tmp_path / "empty"
    told = followed("touch_the_button", folder, environment)
    assert "ok    touch_button" in told
    assert re.search(r"touch_button: felt \d+ N after 0\.0\d+ m", told)
    report = json.loads((folder / "run" / "report.json").read_text(encoding="utf-8"))
    assert report["status"] == "SUCCESS"
    assert 8.0 < report["blackboard"]["force"] < 150.0
    assert "before the button" in (folder / "run" / "run.mcap").read_bytes().decode("latin-1")


@pytest.mark.slow
def test_a_building_nobody_drew_is_mapped_and_worked_in(
    tmp_path: Path, environment: dict[str, str]
) -> None:
    """Without the last command, a run of several minutes that other tests have in parts."""
    folder = tmp_path / "empty"
    told = followed("tutorial_map", folder, environment, leave_out="explore_and_bring")
    assert (folder / "difference.png").is_file()
    assert "occupied cells of A that agree" in told
    assert "bring_object succeeded" in told
