"""`skills stub` writes a package with which the file checks; its tests say what to fill in."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
import tomllib
from collections.abc import Callable
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from momantu_bt import plugins
from momantu_bt.cli import main
from momantu_bt.plugins import Group
from momantu_bt.skill import Skill
from momantu_bt.tree.plugins import SKILLS

Out = pytest.CaptureFixture[str]
Install = Callable[[Path], "dict[str, type[Skill]]"]


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch):
    """Give the skills of a package that lies in a folder, as if it were installed."""
    packages: list[str] = []

    def installed(folder: Path) -> dict[str, type[Skill]]:
        monkeypatch.syspath_prepend(folder / "src")
        project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))
        named = project["project"]["entry-points"][SKILLS.name]
        entries = [EntryPoint(name, value, SKILLS.name) for name, value in named.items()]
        packages.extend(entry.module.partition(".")[0] for entry in entries)
        find = plugins.entry_points
        monkeypatch.setattr(
            plugins,
            "entry_points",
            lambda group: [*find(group=group), *(e for e in entries if e.group == group)],
        )
        group: Group[type[Skill]] = SKILLS
        return {name: group.load(name) for name in named}

    yield installed
    for module in [m for m in sys.modules if m.partition(".")[0] in packages]:
        del sys.modules[module]


UNDECLARED = """<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>
  <FindShelf found="{shelf}" tries="3" patience="1.5" bright="true" label="low" class="a"/>
  <FollowLine to="{shelf}"/>
  <FollowLine to="{shelf}" speed="0.5" my-port="2"/>
  <Gently><AlwaysSuccess/></Gently>
</Sequence></BehaviorTree></root>"""


def test_a_file_checks_with_the_skills_that_were_made_from_its_uses(
    tmp_path: Path, capsys: Out, install: Install
) -> None:
    file = tmp_path / "their tree.xml"
    file.write_text(UNDECLARED.replace("<Gently>", "").replace("</Gently>", ""), encoding="utf-8")
    assert main(["check", str(file)]) == 2
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 0
    folder = tmp_path / "their-tree-skills"
    assert f"{folder}: FindShelf, FollowLine" in capsys.readouterr().out
    skills = install(folder)
    ports = {name: skills["FindShelf"].ports[name] for name in skills["FindShelf"].ports}
    assert {name: port.type for name, port in ports.items() if port.direction == "in"} == {
        "tries": int, "patience": float, "bright": bool, "label": str, "class": str
    }  # fmt: skip
    assert ports["found"].direction == "out"
    follow = skills["FollowLine"].ports
    assert follow["to"].required
    assert not follow["speed"].required
    assert main(["check", str(file)]) == 0, capsys.readouterr().err
    assert main(["skills", "test", "FollowLine"]) == 1
    said = capsys.readouterr().out
    assert "NOT_WRITTEN is among its codes; it is a stub" in said
    assert "speed" not in said
    its_test = runpy.run_path(str(folder / "tests" / "test_stubs.py"))["test_it_does_its_work"]
    for name in ("FindShelf", "FollowLine"):
        with pytest.raises(pytest.skip.Exception, match=rf"fill in run\(\) of {name}"):
            its_test(name)
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-rs"], cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTEST_ADDOPTS": "-p no:cacheprovider"},
    )  # fmt: skip
    assert ran.returncode == 0, ran.stdout
    assert "skipped" in ran.stdout


def test_a_port_that_is_named_as_an_output_is_one(tmp_path: Path, install: Install) -> None:
    file = tmp_path / "t.xml"
    file.write_text(
        """<root BTCPP_format="4"><BehaviorTree ID="Main"><ReactiveSequence>
          <Aim _while="choice != 'rest'"/>
          <Choose choice_in="{choice}" choice_out="{choice}"/>
        </ReactiveSequence></BehaviorTree></root>""",
        encoding="utf-8",
    )
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 0
    ports = install(tmp_path / "t-skills")["Choose"].ports
    assert (ports["choice_in"].direction, ports["choice_out"].direction) == ("in", "out")


def test_nodes_with_children_are_left_out_and_named(tmp_path: Path, capsys: Out) -> None:
    file = tmp_path / "t.xml"
    file.write_text(UNDECLARED, encoding="utf-8")
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 0
    assert "left out: Gently: it has children" in capsys.readouterr().err
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 2
    assert "is there already" in capsys.readouterr().err


def test_types_defaults_and_docs_come_from_a_model(
    tmp_path: Path, capsys: Out, install: Install
) -> None:
    file = tmp_path / "t.yaml"
    file.write_text(
        "momantu_bt: 1\ntrees:\n  Main:\n    - TurnPage: {page: 3}\nmodels:\n  - Action: TurnPage\n"
        "    ports:\n      - {in: page, type: int, doc: which one}\n"
        "      - {in: speed, type: double, default: '0.5'}\n"
        "      - {in: at, type: Pose2D, default: '{goal}'}\n"
        "      - {out: seen, type: 'std::vector<double>'}\n",
        encoding="utf-8",
    )
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 0
    (skill,) = install(tmp_path / "t-skills").values()
    ports = skill.ports
    assert (ports["page"].type, ports["page"].doc, ports["page"].required) == (
        int, "which one", True
    )  # fmt: skip
    assert (ports["speed"].type, ports["speed"].default) == (float, 0.5)
    assert ports["at"].default is None
    assert (ports["seen"].direction, ports["seen"].type) == ("out", tuple[float, ...])
    assert main(["check", str(file)]) == 0, capsys.readouterr().err


def test_a_file_without_missing_leaves_needs_no_stub(tmp_path: Path, capsys: Out) -> None:
    file = tmp_path / "t.yaml"
    file.write_text("momantu_bt: 1\ntrees: {Main: [wait: 1 s]}\n", encoding="utf-8")
    assert main(["skills", "stub", str(file), "--into", str(tmp_path)]) == 2
    assert "every leaf" in capsys.readouterr().err
