"""ROS packages are found in one way, for xacro's `$(find …)` and for meshes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from momantu_bt.robots import RobotFileError, read_robot
from momantu_bt.robots.packages import Packages


def package(folder: Path, name: str | None = None) -> Path:
    """A package of that name, or of its folder's."""
    (folder / "urdf").mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><name>{name or folder.name}</name></package>")
    return folder


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A URDF in a package of a repository of a workspace."""
    return package(tmp_path / "ws" / "src" / "makers_robot" / "arm_description") / "urdf/arm.urdf"


@pytest.mark.parametrize(
    "place",
    [
        "src/base_description",
        "src/base/base_description",
        "src/makers_robot/base_description",
    ],
)
def test_neighbours_in_the_workspace(arm: Path, tmp_path: Path, place: str) -> None:
    there = package(tmp_path / "ws" / place)
    assert Packages(arm, tmp_path / "mine").find("base_description") == there


def test_a_package_in_a_folder_of_another_name(arm: Path, tmp_path: Path) -> None:
    there = package(tmp_path / "ws" / "src" / "base-1.2.3", "base_description")
    assert Packages(arm, tmp_path / "mine").find("base_description") == there


@pytest.mark.parametrize("inside", [".", "base_description", "repository/base_description"])
def test_given_folders_come_first(arm: Path, tmp_path: Path, inside: str) -> None:
    package(tmp_path / "ws" / "src" / "base_description")
    root = tmp_path / "elsewhere" / "base_description"
    there = package(root if inside == "." else root / inside)
    assert Packages(arm, tmp_path / "mine", [root]).find("base_description") == there.resolve()


def test_the_environment_of_ros(arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one = package(tmp_path / "one" / "base_description")
    two = package(tmp_path / "two" / "share" / "head_description")
    monkeypatch.setenv("ROS_PACKAGE_PATH", os.pathsep.join(["", str(one.parent)]))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "two"))
    packages = Packages(arm, tmp_path / "mine")
    assert packages.find("base_description") == one
    assert packages.find("head_description") == two
    assert packages.find("none_description") is None


@pytest.mark.parametrize(
    "name",
    ["meshes/x.stl", "package://arm/meshes/x.stl", "package://other_name/meshes/x.stl", "file"],
)
def test_a_mesh_is_found_beside_the_urdf_or_in_a_folder_above(tmp_path: Path, name: str) -> None:
    file = tmp_path / "arm" / "meshes" / "x.stl"
    file.parent.mkdir(parents=True)
    file.touch()
    for folder in (tmp_path / "arm", tmp_path / "arm" / "urdf" / "old"):
        folder.mkdir(parents=True, exist_ok=True)
        asked = f"file://{file}" if name == "file" else name
        packages = Packages(folder / "r.urdf", tmp_path / "mine")
        assert packages.mesh(asked) == file
        assert packages.mesh(asked.replace("x.stl", "y.stl")) is None


def test_a_mesh_with_a_misspelt_suffix_is_found_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "torso.stl").touch()
    packages = Packages(tmp_path / "r.urdf", tmp_path)
    assert packages.mesh("torso.std") == tmp_path / "torso.stl"
    assert packages.mesh("torso.dae") is None
    assert packages.file("torso.std") is None


ROBOT = """momantu_robot: 1
name: wall
parts: {{wall: {{xacro: {arm}, args: {{mesh: package://base_description/x.stl}}}}}}
{packages}
footprint: [[0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15]]
height: 1
working: {{stand_off: 0.3, look_off: 0.5}}
base: {{linear: 1, angular: 1, linear_acceleration: 1, angular_acceleration: 1}}
actuators: {{}}
"""
XACRO = """<robot xmlns:xacro="http://ros.org/wiki/xacro" name="wall">
<xacro:include filename="$(find base_description)/base.xacro"/></robot>"""
BASE = """<robot xmlns:xacro="http://ros.org/wiki/xacro"><link name="base_link"><visual><geometry>
<mesh filename="package://base_description/x.obj"/></geometry></visual></link></robot>"""


def test_a_robot_file_names_folders_of_packages(arm: Path, tmp_path: Path) -> None:
    arm.write_text(XACRO)
    there = package(tmp_path / "elsewhere" / "repository" / "base_description")
    (there / "base.xacro").write_text(BASE)
    (there / "x.obj").write_text("v 0 0 0\n")
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "robot.yaml").write_text(ROBOT.format(arm=arm, packages=""))
    with pytest.raises(RobotFileError, match=r"find base_description.*--package-path"):
        read_robot(mine)
    text = ROBOT.format(arm=arm, packages="packages: [../elsewhere]")
    (mine / "robot.yaml").write_text(text)
    assert str(there / "x.obj") in read_robot(mine).urdf.read_text()
    (there / "x.obj").unlink()
    with pytest.raises(RobotFileError, match=r"x\.obj' is missing; looked for"):
        read_robot(mine)


def test_the_meshes_of_a_missing_package_are_told_in_one_sentence(
    arm: Path, tmp_path: Path
) -> None:
    shape = '<visual><geometry><mesh filename="package://{}"/></geometry></visual>'
    package(tmp_path / "ws" / "src" / "arm_tools")
    names = ("lost/a.stl", "lost/b.stl", "lost/a.stl", "arm_tools/c.stl", "other/d.stl")
    arm.write_text(
        f'<robot name="wall"><link name="base_link">{"".join(map(shape.format, names))}</link>'
        "</robot>"
    )
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "robot.yaml").write_text(
        ROBOT.format(arm=arm, packages="")
        .replace("xacro:", "urdf:")
        .replace(", args: {mesh: package://base_description/x.stl}", "")
    )
    with pytest.raises(RobotFileError) as caught:
        read_robot(mine)
    said = str(caught.value)
    assert said.count("there is no package 'lost'") == 1
    assert "2 meshes are missing, the first 'package://lost/a.stl'" in said
    assert "the mesh 'package://other/d.stl' is missing; there is no package 'other'" in said
    assert "arm_tools/c.stl' is missing; looked for" in said
