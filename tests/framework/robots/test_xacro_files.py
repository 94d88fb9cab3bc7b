"""xacro files are expanded without ROS: arguments, includes, packages; what goes wrong is told."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from momantu_bt.robots import RobotFileError, read_robot

Write = Callable[..., Path]
MACRO = '<xacro:macro name="part"'
NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def test_arguments_reach_the_file(carter: Write) -> None:
    tip = read_robot(carter()).kinematics().base_from_frame("arm_left", {}).position
    file = carter(robot=("{reach: 0.5}", "{reach: 0.7}"))
    further = read_robot(file).kinematics().base_from_frame("arm_left", {}).position
    assert further[1] - tip[1] == pytest.approx(0.2)


@pytest.mark.parametrize("where", ["carter/tools/extra.xacro", "tools/extra.xacro"])
def test_packages_are_folders_beside_the_robot_file(
    carter: Write, tmp_path: Path, where: str
) -> None:
    extra = tmp_path / where
    extra.parent.mkdir(parents=True)
    red = '<material name="red"><color rgba="1 0 0 1"/></material>'
    extra.write_text(f"<robot {NAMESPACE}>{red}</robot>")
    include = '<xacro:include filename="$(find tools)/extra.xacro"/>'
    robot = read_robot(carter(arm=(MACRO, include + MACRO)))
    assert "arm_red" in robot.urdf.read_text()
    assert any(name.endswith("extra.xacro") for name in robot.texts())


def test_installed_packages_are_found_too(carter: Write) -> None:
    robot = read_robot(
        carter(arm=(MACRO, f'<xacro:property name="x" value="$(find xacro)"/>{MACRO}'))
    )
    assert robot.name == "carter"


@pytest.mark.parametrize(
    ("inside", "words"),
    [
        ('<xacro:include filename="$(find toolz)/x.xacro"/>', r"find toolz.*did you mean 'tools'"),
        ('<xacro:include filename="none.xacro"/>', "xacro cannot expand .*none.xacro"),
        ('<xacro:include filename="broken.xacro"/>', r"broken.xacro, included from arm.urdf.xacro"),
        ("<xacro:prt/>", "[Uu]nknown macro"),
        ('<link name="${1 / 0}"/>', "division by zero"),
        ('<link name="$(arg nothing)"/>', "nothing"),
        ('<link name="${open(1)}"/>', "open"),
        ('<link name="${().__class__}"/>', "__class__"),
    ],
)
def test_what_xacro_objects_to_is_told_with_the_file(
    carter: Write, tmp_path: Path, inside: str, words: str
) -> None:
    (tmp_path / "carter" / "tools").mkdir(parents=True)
    (tmp_path / "carter" / "broken.xacro").write_text("<robot>")
    with pytest.raises(RobotFileError, match=words):
        read_robot(carter(arm=(MACRO, inside + MACRO)))


def test_all_missing_packages_are_told_at_once(carter: Write, tmp_path: Path) -> None:
    more = tmp_path / "carter" / "more.xacro"
    more.parent.mkdir(exist_ok=True)
    more.write_text(
        f"""<robot {NAMESPACE}><!-- $(find commented) -->
        <xacro:include filename="$(find second)/x.xacro"/>
        <xacro:include filename="more.xacro"/>
        <xacro:include filename="${{anywhere}}/x.xacro"/></robot>"""
    )
    inside = (
        '<xacro:include filename="$(find first)/x.xacro"/><xacro:include filename="more.xacro"/>'
        '<xacro:property name="x" value="$(find xacro)"/>'
    )
    with pytest.raises(RobotFileError) as caught:
        read_robot(carter(arm=(MACRO, inside + MACRO)))
    assert "$(find first) is neither" in str(caught.value)
    assert "2 packages" in str(caught.value)
    assert "cannot be found: first, second;" in " ".join(str(caught.value).split())
    assert "commented" not in str(caught.value)


def test_one_missing_package_is_told_once(carter: Write) -> None:
    inside = '<xacro:include filename="$(find first)/x.xacro"/>'
    with pytest.raises(RobotFileError) as caught:
        read_robot(carter(arm=(MACRO, inside + MACRO)))
    assert "packages that the file" not in str(caught.value)


def test_nothing_of_ros_stays_behind(carter: Write) -> None:
    read_robot(carter())
    with pytest.raises(RobotFileError):
        read_robot(carter(arm=(MACRO, "<xacro:nothing/>" + MACRO)))
    assert "ament_index_python" not in sys.modules
    assert read_robot(carter()).name == "carter"
