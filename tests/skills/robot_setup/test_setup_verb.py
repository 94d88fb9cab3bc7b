"""`robots setup` on a command line: files that the reader takes, and what stands in the way."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from momantu_skills.robot_setup.find.proposal import Proposal
from momantu_skills.robot_setup.setup_verb import setup
from momantu_skills.robot_setup.write.writer import missing, robot_file
from typer import Typer
from typer.testing import CliRunner

from momantu_bt.errors import MomantuError
from momantu_bt.robot import CameraSensor
from momantu_bt.robots import read_robot
from tests.skills.robot_setup.conftest import box, joint, link

app = Typer()
app.command()(setup)


def run(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(app, [str(a) for a in arguments], standalone_mode=False)
    if isinstance(result.exception, MomantuError):
        return result.exception.exit_code, result.exception.printed()
    assert result.exception is None, result.exception
    return result.return_value, result.output


@pytest.mark.parametrize("name", ["rolling_proposal", "bolted_proposal"])
def test_the_file_reads_as_what_was_found(
    name: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    proposal: Proposal = request.getfixturevalue(name)
    assert missing(proposal) == ()
    (tmp_path / "robot.yaml").write_text(robot_file(proposal, tmp_path))
    robot = read_robot(tmp_path)
    assert proposal.limbs.arm is not None
    assert proposal.grasp is not None
    assert robot.groups["arm"].joints == proposal.limbs.arm.joints
    assert robot.end_effector.opening == proposal.grasp.opening
    assert robot.named_poses == {n: p.joints for n, p in proposal.poses.items()}
    assert robot.working.reach == proposal.reach.reach
    assert robot.height == proposal.height
    assert robot.ignored_collisions == proposal.matrix.ignored
    assert robot.simulation is not None
    assert robot.simulation.finger_links == ("left_finger", "right_finger")
    assert {n: limit.limit for n, limit in proposal.limits.items()} == robot.joint_limits


def test_an_optical_frame_is_added_where_there_is_none(
    rolling_proposal: Proposal, tmp_path: Path
) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(rolling_proposal, tmp_path))
    robot = read_robot(tmp_path)
    name, camera = robot.camera()
    assert isinstance(camera, CameraSensor)
    assert (name, camera.carrier) == ("head_camera", "head")
    tree = robot.kinematics()
    link = tree.base_from_frame("head_camera_link", {})
    optical = tree.base_from_frame(camera.frame, {})
    assert optical.rotation[:, 2] == pytest.approx(link.rotation[:, 0], abs=1e-5)
    assert optical.rotation[:, 1] == pytest.approx(-link.rotation[:, 2], abs=1e-5)


def test_a_base_below_another_link_is_put_on_the_floor(
    bolted_proposal: Proposal, tmp_path: Path
) -> None:
    (tmp_path / "robot.yaml").write_text(robot_file(bolted_proposal, tmp_path))
    robot = read_robot(tmp_path)
    assert robot.base_frame == "base_footprint"
    base = robot.kinematics().base_from_frame("base_link", {})
    assert base.position == pytest.approx((0, 0, 0), abs=1e-6)


def test_a_base_above_the_floor_is_put_on_it_whatever_its_links_are_called(
    rolling_urdf: Path, tmp_path: Path
) -> None:
    text = rolling_urdf.read_text().replace('"0 0.2 0.1"', '"0 0.2 0"')
    text = text.replace('"0 -0.2 0.1"', '"0 -0.2 0"')
    floor = '<joint name="below" type="fixed"><parent link="base_link"/>'
    floor += '<child link="base_footprint"/><origin xyz="0 0 -0.1"/></joint>'
    own = f'<link name="base_footprint"/>{floor}</robot>'
    (tmp_path / "high.urdf").write_text(text.replace("</robot>", own))
    code, said = run(tmp_path / "high.urdf", "-o", tmp_path, "--samples", 20)
    assert code == 0, said
    robot = read_robot(tmp_path)
    assert robot.base_frame == "base_on_floor"
    for name, height in (("base_footprint", 0.0), ("base_link", 0.1)):
        place = robot.kinematics().base_from_frame(name, {})
        assert place.position == pytest.approx((0, 0, height), abs=3e-3)


def test_the_verb_writes_and_says_what_it_found(rolling_urdf: Path, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    code, said = run(rolling_urdf, "-o", folder, "--samples", 50)
    assert code == 0
    assert "5 joints to palm" in said
    assert "opens to 80 mm" in said
    assert "50 postures" in said
    text = (folder / "robot.yaml").read_text()
    assert "# Guessed" in text
    assert "# Measured" in text
    assert "FILL IN:" in text.splitlines()[4]
    assert text.count("FILL IN") == 1
    assert read_robot(folder).name == "rolling_arm"


def test_nothing_is_written_over_without_force(rolling_urdf: Path, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("mine")
    code, said = run(rolling_urdf, "-o", tmp_path, "--samples", 1)
    assert code == 2
    assert "--force" in said
    assert (tmp_path / "robot.yaml").read_text() == "mine"
    code, _ = run(rolling_urdf, "-o", tmp_path, "--samples", 1, "--force")
    assert code == 0
    assert (tmp_path / "robot.yaml").read_text() != "mine"


def test_json_has_the_whole_matrix(bolted_xacro: Path, tmp_path: Path) -> None:
    code, said = run(bolted_xacro, "-o", tmp_path, "--samples", 20, "--json")
    told = json.loads(said)
    assert code == 0
    assert told["arm"] == ["a1", "a2", "a3", "a4", "a5", "a6"]
    assert told["collisions"]["samples"] == 20
    assert {p["why"] for p in told["collisions"]["pairs"]} >= {"adjacent", "never"}
    assert told["fill_in"] == []


CART = "".join(
    [
        '<robot name="cart">',
        link("base_link", box(0.4, 0.3, 0.2), "0 0 0.2", 20),
        link("left_wheel", '<cylinder radius="0.1" length="0.04"/>', rpy="1.5708 0 0"),
        link("right_wheel", '<cylinder radius="0.1" length="0.04"/>', rpy="1.5708 0 0"),
        joint("left", "base_link", "left_wheel", "0 0.17 0.1", "0 1 0", "continuous"),
        joint("right", "base_link", "right_wheel", "0 -0.17 0.1", "0 1 0", "continuous"),
        link("camera_link", box(0.02, 0.1, 0.02), mass=0.1),
        joint("camera_joint", "base_link", "camera_link", "0.2 0 0.4", kind="fixed"),
        link("laser_link"),
        joint("laser_joint", "base_link", "laser_link", "0.15 0 0.35", kind="fixed"),
        "</robot>",
    ]
)

BARE = '<robot name="Bare 1"><link name="base"/><link name="flag"/>' + (
    '<joint name="j" type="continuous"><parent link="base"/><child link="flag"/></joint></robot>'
)


def test_what_cannot_be_found_is_left_to_fill_in(tmp_path: Path) -> None:
    urdf = tmp_path / "bare.urdf"
    urdf.write_text(BARE)
    code, said = run(urdf, "-o", tmp_path / "bare", "--samples", 5)
    assert code == 1
    text = (tmp_path / "bare" / "robot.yaml").read_text()
    assert any("FILL IN" in line and "footprint" in line for line in said.splitlines())
    for what in ("no arm", "no camera", "no laser"):
        assert any("without" in line and what in line for line in said.splitlines()), what
    assert "name: bare_1" in text
    assert "# FILL IN: the base has no collision shape" in text


def test_a_robot_without_an_arm_is_whole(tmp_path: Path) -> None:
    urdf = tmp_path / "cart.urdf"
    urdf.write_text(CART)
    code, said = run(urdf, "-o", tmp_path / "cart", "--samples", 5)
    assert code == 0, said
    assert "reach" not in said
    robot = read_robot(tmp_path / "cart")
    assert not robot.has_arm
    assert robot.end_effector is None
    assert robot.working.reach is None
    assert robot.named_poses == {}
    assert set(robot.actuators) == {"base"}
    assert robot.simulation is not None


def test_an_arm_without_a_hand_is_whole(rolling_urdf: Path, tmp_path: Path) -> None:
    handless = tmp_path / "handless.urdf"
    text = rolling_urdf.read_text()
    slides = re.sub(r'(<joint name="(?:left|right)_slide[^"]*" type=")prismatic', r"\1fixed", text)
    assert slides != text
    handless.write_text(slides)
    code, said = run(handless, "-o", tmp_path / "handless", "--samples", 50)
    assert code == 0, said
    assert "no hand" in said
    robot = read_robot(tmp_path / "handless")
    assert robot.has_arm
    assert robot.end_effector is None
    assert {"home", "ready", "carry", "look_around"} <= set(robot.named_poses)
    assert "gripper" not in robot.actuators


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "no file"),
        ("not xml", "not XML"),
        ("<sdf/>", "not a URDF"),
        ("<robot name='r'/>", "no <link>"),
        ("<robot name='r'><link name='a'/><link name='b'/></robot>", "one root"),
    ],
)
def test_what_is_no_urdf_is_refused(tmp_path: Path, text: str | None, words: str) -> None:
    urdf = tmp_path / "bad.urdf"
    if text is not None:
        urdf.write_text(text)
    code, said = run(urdf, "-o", tmp_path / "out")
    assert code == 2
    assert words in said
    assert not (tmp_path / "out").exists()


def test_a_broken_xacro_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.xacro"
    path.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">${nothing}</robot>'
    )
    code, said = run(path, "-o", tmp_path / "out")
    assert code == 2
    assert "nothing" in said


def test_shapes_that_nobody_can_use_are_left_out(tmp_path: Path, rolling_urdf: Path) -> None:
    flat = '<collision><geometry><box size="0.1 0.1 0"/></geometry></collision>'
    capsule = '<collision><geometry><capsule radius="1" length="1"/></geometry></collision>'
    lost = '<collision><geometry><mesh filename="package://x/lost.stl"/></geometry></collision>'
    text = rolling_urdf.read_text()
    for name, shape in (("wrist", flat), ("palm", capsule), ("mast", lost)):
        text = text.replace(f'<link name="{name}">', f'<link name="{name}">{shape}')
    path = tmp_path / "odd.urdf"
    path.write_text(text)
    code, said = run(path, "-o", tmp_path / "odd", "--samples", 5)
    assert "wrist has no volume" in said
    assert "<capsule>" in said
    assert "lost.stl" in said
    assert code == 1  # the reader insists on the mesh
