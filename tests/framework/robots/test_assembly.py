"""Laws of assembly: names are unique, transforms are as given, masses and joints add up."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from momantu_bt.geometry import Transform
from momantu_bt.robot import RobotDescription
from momantu_bt.robots import RobotFileError, read_robot
from momantu_bt.robots.joining import VIRTUAL_JOINTS

Write = Callable[..., Path]
ANY = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15)
POSITIONS = st.tuples(*[st.floats(-2, 2).map(lambda x: round(x, 4))] * 3)
TURNS = st.tuples(*[st.floats(-3.1, 3.1).map(lambda x: round(x, 4))] * 3)
MOUNT = "arm: {on: base_link, xyz: [10 cm, 0, 30 cm], rpy: [0, 0, 90 deg]}"


def urdf(robot: RobotDescription | Path) -> etree._Element:
    path = robot.urdf if isinstance(robot, RobotDescription) else robot
    return etree.fromstring(path.read_bytes())


def names(root: etree._Element, tag: str) -> list[str]:
    return [str(element.get("name")) for element in root.findall(tag)]


def masses(root: etree._Element) -> float:
    return sum(float(mass.get("value", "0")) for mass in root.findall("link/inertial/mass"))


def test_names_are_unique_and_every_name_that_is_used_is_there(carter: Write) -> None:
    root = urdf(read_robot(carter()))
    for tag in ("link", "joint", "material"):
        assert len(names(root, tag)) == len(set(names(root, tag)))
    links, joints, materials = (set(names(root, tag)) for tag in ("link", "joint", "material"))
    assert {e.get("link") for e in (*root.iter("parent"), *root.iter("child"))} <= links
    assert {e.get("joint") for e in root.iter("mimic")} == {"arm_left_slide"}
    assert {"arm_left_slide"} <= joints
    assert {e.tag for e in root} == {"link", "joint", "material"}
    assert {e.get("name") for e in root.findall("link/visual/material")} == materials


def test_only_the_namespaced_part_is_renamed(carter: Write) -> None:
    root = urdf(read_robot(carter()))
    assert {"base_link", "mast", "arm_shoulder", "hand", "lens"} <= set(names(root, "link"))
    assert [m.get("name") for m in root.findall("material")] == ["grey", "arm_grey"]


def test_masses_and_joints_add_up(carter: Write) -> None:
    file = carter()
    root, cart = urdf(read_robot(file)), urdf(file.parent / "cart.urdf")
    assert masses(root) == pytest.approx(masses(cart) + 2 + 1.5 + 0.1 + 0.1)
    own, arm, mount, frames, base = len(names(cart, "joint")), 4, 1, 2, 3
    assert len(names(root, "joint")) == own + arm + mount + frames + base
    assert len(names(root, "link")) == len(names(root, "joint")) + 1


@ANY
@given(POSITIONS, TURNS)
def test_a_mount_has_the_transform_that_the_file_gives(
    carter: Write, xyz: tuple[float, ...], rpy: tuple[float, ...]
) -> None:
    mount = f"arm: {{on: base_link, xyz: {list(xyz)}, rpy: {list(rpy)}}}"
    kinematics = read_robot(carter(robot=(MOUNT, mount))).kinematics()
    found = kinematics.base_from_frame("arm_foot", {})
    expected = Transform.from_rpy(xyz, rpy)
    assert np.allclose(found.matrix, expected.matrix, atol=1e-9)


@ANY
@given(POSITIONS, TURNS)
def test_a_named_link_of_a_part_lies_where_the_mount_says(
    carter: Write, xyz: tuple[float, ...], rpy: tuple[float, ...]
) -> None:
    foot = '<link name="foot"/>'
    plate = '<joint name="plate_joint" type="fixed"><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.2 1"/>'
    plate += '<parent link="foot"/><child link="plate"/></joint><link name="plate"/>'
    mount = f"arm: {{on: base_link, link: plate, xyz: {list(xyz)}, rpy: {list(rpy)}}}"
    file = carter(robot=(MOUNT, mount), arm=(foot, foot + plate))
    found = read_robot(file).kinematics().base_from_frame("arm_plate", {})
    assert np.allclose(found.matrix, Transform.from_rpy(xyz, rpy).matrix, atol=1e-9)


def test_a_link_that_turns_straight_up_keeps_its_orientation(carter: Write) -> None:
    plate = '<joint name="up" type="fixed"><origin rpy="0.4 1.5707963267948966 0"/>'
    plate += '<parent link="foot"/><child link="plate"/></joint><link name="plate"/>'
    foot = '<link name="foot"/>'
    file = carter(robot=(MOUNT, "arm: {on: base_link, link: plate}"), arm=(foot, foot + plate))
    found = read_robot(file).kinematics().base_from_frame("arm_plate", {})
    assert np.allclose(found.matrix, np.eye(4), atol=1e-9)


def test_frames_may_hang_on_frames_in_any_order(carter: Write) -> None:
    frames = "frames:\n  tip: {on: hand, xyz: [1 cm, 0, 0]}\n"
    kinematics = read_robot(carter(robot=("frames:\n", frames))).kinematics()
    tip, forearm = (kinematics.base_from_frame(f, {}) for f in ("tip", "arm_forearm"))
    assert (forearm.inverse() @ tip).position == pytest.approx([0.56, 0, 0])


def test_virtual_joints_carry_the_base_in_the_plane(carter: Write) -> None:
    robot = read_robot(carter())
    assert robot.simulation is not None
    assert robot.simulation.base.joints == VIRTUAL_JOINTS
    root = urdf(robot)
    above = {j.find("child").get("link"): j for j in root.findall("joint")}  # type: ignore[union-attr]
    chain: list[tuple[str, str]] = []
    link = robot.base_frame
    while link in above:
        joint = above[link]
        axis, parent = joint.find("axis"), joint.find("parent")
        assert axis is not None
        assert parent is not None
        chain.append((str(joint.get("type")), str(axis.get("xyz"))))
        link = str(parent.get("link"))
    assert chain == [("continuous", "0 0 1"), ("prismatic", "0 1 0"), ("prismatic", "1 0 0")]


def test_a_floating_root_is_put_on_a_base_frame_of_its_own(carter: Write) -> None:
    file = carter(
        robot=("mounts:\n", "base_frame: floor\nmounts:\n  cart: {on: floor, xyz: [0, 0, 6 cm]}\n")
    )
    robot = read_robot(file)
    assert robot.kinematics().base_from_frame("base_link", {}).position == pytest.approx(
        [0, 0, 0.06]
    )
    assert robot.base_frame == "floor"


def test_gains_of_a_joint_win_over_its_actuators(carter: Write) -> None:
    robot = read_robot(carter())
    assert robot.simulation is not None
    gains = robot.simulation.drives
    assert (gains["arm_turn"].stiffness, gains["arm_turn"].damping) == (1000, 50)
    assert (gains["arm_bend"].stiffness, gains["arm_bend"].damping) == (400, 50)


def test_the_same_robot_is_the_same_file_and_is_written_once(carter: Write) -> None:
    file = carter()
    first = read_robot(file)
    stamp = first.urdf.stat().st_mtime_ns
    assert read_robot(file) == first
    assert first.urdf.stat().st_mtime_ns == stamp
    first.urdf.write_text("damaged")
    assert urdf(read_robot(file)).tag == "robot"
    assert read_robot(carter(arm=('mass="2"', 'mass="3"'))).urdf != first.urdf


def test_a_cache_that_cannot_be_written_is_done_without(
    carter: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "file"))
    robot = read_robot(carter())
    assert robot.urdf.is_file()
    assert tmp_path not in robot.urdf.parents


def test_a_robot_of_one_whole_part_is_its_own_file(carter: Write) -> None:
    file = carter()
    joined, text = read_robot(file), file.read_text()
    (file.parent / "all.urdf").write_text(joined.urdf.read_text())
    start, end = text.index("parts:"), text.index("base:\n")
    text = text[:start] + "parts:\n  carter: {urdf: all.urdf}\n" + text[end:]
    slides = "{x: base_x_joint, y: base_y_joint, yaw: base_yaw_joint}"
    file.write_text(text.replace("torque: 50}", f"torque: 50, joints: {slides}}}"))
    robot = read_robot(file)
    assert robot.urdf == file.parent / "all.urdf"
    assert robot.simulation == joined.simulation
    assert robot.kinematics().frames() == joined.kinematics().frames()


MAST = '<link name="mast"/>'
FLAG = '<link name="mast"/><link name="flag"/>'
FOOT = '<link name="foot"/>'
TWICE = '<link name="mast"/><joint name="stay" type="fixed"><parent link="foot"/>'
TWICE = f'{FOOT}{TWICE}<child link="mast"/></joint>'
UNFIT: list[tuple[dict[str, tuple[str, str]], str]] = [
    (
        {"robot": (", namespace: arm", ""), "arm": (FOOT, TWICE)},
        "robot.yaml:6:8: 'cart' and 'arm' both have a link called 'mast'; .*`namespace: arm`",
    ),
    ({"robot": ("on: base_link", "on: base_lnk")}, "8:13: .*'base_lnk'; did you mean base_link"),
    ({"robot": ("on: base_link", "on: arm_forearm")}, "8:13: 'arm' hangs on .*: a ring"),
    ({"robot": (f"mounts:\n  {MOUNT}\n", "")}, "6:8: .*'arm' has no mount; write `mounts: {arm"),
    ({"robot": ("  arm: {on", "  arn: {on")}, "there is no part 'arn'; did you mean arm"),
    ({"robot": ("on: base_link,", "on: base_link, link: hnad,")}, "'arm' has no link 'hnad'"),
    (
        {"robot": ("on: base_link,", "on: base_link, link: forearm,")},
        "'arm_forearm' moves against the part's root 'arm_foot', by arm_turn, arm_bend",
    ),
    (
        {"robot": ("  hand: {on: arm_forearm", "  mast: {on: arm_forearm")},
        "the link 'mast' is in cart already; choose another name",
    ),
    ({"robot": ("  lens: {on: mast", "  lens: {on: lens")}, "'lens' hangs on 'lens'.*: a ring"),
    (
        {"robot": ("height:", "base_frame: mast\nheight:")},
        "'mast' is not the root of 'cart', which is 'base_link'",
    ),
    ({"robot": ("cart.urdf}", "crat.urdf}")}, "5:16: .* no file .*crat.urdf; .*: .*cart.urdf"),
    ({"cart": (MAST, FLAG)}, "cart.urdf is not a tree of links: it has the roots base_link, flag"),
]


@pytest.mark.parametrize(("changes", "words"), UNFIT)
def test_what_cannot_be_assembled_is_refused(
    carter: Write, changes: dict[str, tuple[str, str]], words: str
) -> None:
    with pytest.raises(RobotFileError, match=words):
        read_robot(carter(**changes))


def test_two_materials_of_one_name_are_refused_unless_they_are_the_same(carter: Write) -> None:
    colors = ("0.2 0.2 0.2 1", "0.5 0.5 0.5 1")
    plain = (", namespace: arm", "")
    text = carter(robot=plain).read_text()
    for name in ("arm_turn", "arm_bend", "arm_left_slide", "arm_right_slide", "arm_forearm"):
        text = text.replace(name, name.removeprefix("arm_"))
    text = text.replace("[arm_left, arm_right]", "[left, right]")
    file = carter(robot=plain)
    file.write_text(text)
    with pytest.raises(RobotFileError, match="both have a material called 'grey'"):
        read_robot(file)
    carter(arm=colors)
    file.write_text(text)
    assert names(urdf(read_robot(file)), "material") == ["grey"]


def test_rpy_of_ninety_degrees_is_exact_in_the_text(carter: Write) -> None:
    mount = next(
        j for j in urdf(read_robot(carter())).findall("joint") if j.get("name") == "arm_mount"
    )
    origin = mount.find("origin")
    assert origin is not None
    assert [float(v) for v in origin.get("rpy", "").split()] == pytest.approx([0, 0, math.pi / 2])
    assert origin.get("xyz") == "0.1 0.0 0.3"
