"""`skills new` makes a package that works, or nothing at all."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.skill import Skill
from momantu_bt.tree.plugins import SKILLS

Out = pytest.CaptureFixture[str]


@pytest.mark.parametrize("name", ["turn_round", "TurnRound"])
def test_the_package_names_its_skill_and_its_tests_pass(
    tmp_path: Path, capsys: Out, name: str
) -> None:
    assert main(["skills", "new", name, "--into", str(tmp_path)]) == 0
    folder = tmp_path / name
    assert str(folder) in capsys.readouterr().out
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
    entry = project["project"]["entry-points"]["momantu_bt.skills"]
    assert entry == {name: "turn_round_skill.turn_round:TurnRound"}
    assert all("$name" not in file.read_text() for file in folder.rglob("*.*") if file.is_file())
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "momantu_bt.pytest_plugin"],
        cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTEST_ADDOPTS": "-p no:cacheprovider"},
    )  # fmt: skip
    assert ran.returncode == 0, ran.stdout
    assert " passed" in ran.stdout


NAMES = ["turn", "skill", "failure", "robot", "out", "a2", "FollowWall", "Robot", "class", "None"]


@pytest.mark.parametrize("name", [*NAMES, "turn-round", "Über.weg", "日本", "_x", "TCPMove2D"])
def test_what_it_makes_is_a_good_plug_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    assert main(["skills", "new", name, "--into", str(tmp_path)]) == 0
    monkeypatch.syspath_prepend(tmp_path / name / "src")
    project = tomllib.loads((tmp_path / name / "pyproject.toml").read_text(encoding="utf-8"))
    (value,) = project["project"]["entry-points"]["momantu_bt.skills"].values()
    monkeypatch.setattr(
        plugins, "entry_points", lambda group: [EntryPoint(name, value, SKILLS.name)]
    )
    try:
        assert issubclass(SKILLS.load(name), Skill)
    finally:
        package = value.partition(".")[0]
        for module in [each for each in sys.modules if each.startswith(package)]:
            del sys.modules[module]


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("../turn", "as in XML"),
        ("turn round", "as in XML"),
        ("", "as in XML"),
        ("Sequence", "a built-in node"),
        ("sequence", "a built-in node"),
        ("retry", "a built-in node"),
        ("catch", "a word of tree files"),
        ("null", "a word of tree files"),
        ("pick", "installed already"),
    ],
)
def test_a_bad_name_is_refused(tmp_path: Path, capsys: Out, name: str, reason: str) -> None:
    assert main(["skills", "new", name, "--into", str(tmp_path)]) == 2
    assert reason in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_what_is_there_is_left_alone(
    tmp_path: Path, capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "turn").mkdir()
    assert main(["skills", "new", "turn"]) == 2
    assert "is there already" in capsys.readouterr().err
    assert list((tmp_path / "turn").iterdir()) == []
    assert main(["skills", "new", "turn", "--into", "nowhere"]) == 2
    assert "no folder nowhere" in capsys.readouterr().err
    (tmp_path / "spin_skill.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)
    assert main(["skills", "new", "spin"]) == 2
    assert "'spin_skill' is there already" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["spin_skill.py", "turn"]


def test_nothing_half_written_stays(
    tmp_path: Path, capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = Path.write_text

    def full(self: Path, text: str, *more: str, **options: str) -> int:
        if self.name == "README.md":
            raise OSError(28, "No space left on device")
        return whole(self, text, *more, **options)

    monkeypatch.setattr(Path, "write_text", full)
    assert main(["skills", "new", "turn", "--into", str(tmp_path)]) == 2
    assert "No space left" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_pages_are_written(tmp_path: Path, capsys: Out) -> None:
    folder = tmp_path / "docs" / "skills"
    assert main(["skills", "pages", str(folder), "pick", "look"]) == 0
    assert {path.name for path in folder.iterdir()} == {"pick.md", "look.md", "index.md"}
    assert main(["skills", "show", "pick", "--json"]) == 0
    told = json.loads(capsys.readouterr().out.partition("\n")[2])
    assert told["examples"]["yaml"] in (folder / "pick.md").read_text(encoding="utf-8")
    (tmp_path / "file").write_text("")
    assert main(["skills", "pages", str(tmp_path / "file")]) == 2
