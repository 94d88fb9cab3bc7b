"""A robot is named by its file as well as by an installed name, wherever robots are named."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.bench.planning.made_of import difference, made_of
from momantu_bt.cli import main
from momantu_bt.robots import read_robot
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.tree.load import load
from momantu_bt.tree.registry import Registry

TREE = "momantu_bt: 1\ntrees:\n  Main:\n    - wait: 1 s\n"
Write = Callable[..., Path]


@pytest.fixture
def tree(tmp_path: Path) -> str:
    (tmp_path / "tree.yaml").write_text(TREE)
    return str(tmp_path / "tree.yaml")


def test_file_folder_and_relative_path_give_the_same_robot(
    carter: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = carter()
    registry = Registry.installed()
    given = registry.description(str(file))
    assert given.name == "carter"
    assert registry.description(str(file.parent)) == given
    monkeypatch.chdir(file.parent)
    assert registry.description("robot.yaml") == given
    assert ROBOTS.absolute("robot.yaml") == str(file)
    assert ROBOTS.absolute("fetch") == "fetch"
    assert ROBOTS.absolute(None) is None


def test_a_bare_name_with_a_file_nearby_gets_a_hint(
    carter: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tree: str
) -> None:
    monkeypatch.chdir(carter().parent.parent)
    assert main(["robots", "show", "carter"]) == 2
    assert "write ./carter/robot.yaml" in capsys.readouterr().err
    assert main(["check", tree, "--robot", "carter"]) == 2
    assert "write ./carter/robot.yaml" in capsys.readouterr().err


def test_a_path_without_a_file_is_told_what_lies_there(
    carter: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["robots", "show", str(carter().parent / "robto.yaml")]) == 2
    assert "files there: robot.yaml" in capsys.readouterr().err


def test_a_urdf_is_no_robot_file_and_the_way_to_one_is_told(
    carter: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(carter().parent)
    assert main(["robots", "show", "cart.urdf"]) == 2
    assert "`momantu-bt robots setup cart.urdf` makes one of it" in capsys.readouterr().err


def test_a_folder_without_a_robot_file_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "other.yaml").touch()
    assert main(["robots", "show", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "there is no robot file" in said
    assert "files there: other.yaml" in said


def test_a_users_meshes_count_in_a_benchs_key_of_a_named_robot(
    carter: Write, tmp_path: Path, tree: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    meshes = tmp_path / "meshes" / "carter" / "cart"
    meshes.mkdir(parents=True)
    (meshes / "mast.stl").write_bytes(b"solid")
    file = carter()
    registry = Registry(robots={"carter": lambda: read_robot(file)})
    document = load(tree, Registry.installed()).document
    plain = made_of(document, registry, robot="carter")
    monkeypatch.setenv("MOMANTU_BT_MESHES", str(tmp_path / "meshes"))
    own = made_of(document, registry, robot="carter")
    (meshes / "mast.stl").write_bytes(b"changed")
    assert not any(name.startswith("the robot's file") for name in plain)
    (changed,) = difference(own, made_of(document, registry, robot="carter"))
    assert changed.endswith("mast.stl")


def test_a_broken_robot_file_is_an_error_of_the_check_with_its_own_place(
    carter: Write, capsys: pytest.CaptureFixture[str], tree: str
) -> None:
    file = carter(robot=("height:", "hight:"))
    assert main(["check", tree, "--robot", str(file)]) == 2
    shown = capsys.readouterr().err
    assert "robot.yaml:21:1: error: unknown key 'hight'" in shown
    assert "did you mean 'height'" in shown


def test_every_text_is_kept_and_counts_in_a_benchs_key(carter: Write, tree: str) -> None:
    registry = Registry.installed()
    document = load(tree, registry).document
    file = carter()
    assert set(registry.description(str(file)).texts()) == {
        "robot.yaml",
        "cart.urdf",
        "arm.urdf.xacro",
    }
    before = made_of(document, registry, robot=str(file))
    assert before["the robot"] == "carter"
    carter(arm=('mass="2"', 'mass="3"'))
    after = made_of(document, registry, robot=str(file))
    assert difference(before, after) == ("the robot's file arm.urdf.xacro",)


def test_a_schema_completes_the_poses_of_a_file(
    carter: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = carter(robot=("  look_around:", "  wave: {arm_turn: 0, arm_bend: 0}\n  look_around:"))
    assert main(["skills", "schema", "--robot", str(file)]) == 0
    assert "wave" in json.dumps(json.loads(capsys.readouterr().out))
