"""A robot that nobody here has seen, given by its file, stands, drives and moves in physics."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import plain_episode

from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions
from momantu_bt.robot import RobotDescription
from momantu_bt.robots import read_robot
from momantu_bt.robots.summary import summary
from momantu_bt.world import WorldError

FILE = Path(__file__).parents[2] / "robots" / "carter" / "robot.yaml"


@pytest.fixture
def carter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RobotDescription:
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path))
    return read_robot(FILE)


def test_its_masses_arrive_in_physics_and_frames_weigh_nothing(carter: RobotDescription) -> None:
    simulator = Simulator(carter, plain_episode(table=False), 0, render=False)
    links = simulator.model.links
    told = summary(carter)["mass"]
    assert sum(link.mass for link in links.values()) == pytest.approx(told, rel=1e-4)
    assert all(links[frame].mass < 1e-5 for frame in ("hand", "lens", "mast"))
    assert len(simulator.model.joints) == 3 + len(carter.joint_limits)


def test_it_drives_turns_its_arm_and_opens_its_hand(carter: RobotDescription) -> None:
    simulator = Simulator(carter, plain_episode(table=False), 0, render=False)
    robot = simulator.robot
    before = simulator.truth.link("base_link")
    for _ in range(60):
        robot.command("base", BaseVelocity(0.5, 0.0))
        robot.command("arm", JointPositions(("arm_turn", "arm_bend"), (0.5, -0.2)))
        robot.command("gripper", GripperCommand(0.07, 10.0))
        simulator.step()
    moved = (before.inverse() @ simulator.truth.link("base_link")).position
    assert moved[0] == pytest.approx(3.0 * 0.5 - 0.125, abs=0.03)
    assert abs(moved[1]) < 1e-3
    state = robot.state()
    assert state.position("arm_turn") == pytest.approx(0.5, abs=0.02)
    assert state.position("arm_bend") == pytest.approx(-0.2, abs=0.02)
    assert state.gripper_width == pytest.approx(0.07, abs=3e-3)
    reached = {"arm_turn": 0.5, "arm_bend": -0.2}
    expected = carter.kinematics().base_from_frame("hand", reached).position
    hand = simulator.truth.link("base_link").inverse() @ simulator.truth.link("hand")
    assert hand.position == pytest.approx(expected, abs=0.02)


def test_without_what_a_simulator_needs_it_is_refused_with_what_to_write(
    carter: RobotDescription,
) -> None:
    bare = carter.model_copy(update={"simulation": None})
    with pytest.raises(WorldError, match=r"carter.*robot.yaml needs a section `simulation`"):
        Simulator(bare, plain_episode(table=False), 0, render=False)


@pytest.mark.parametrize("role", ["visual", "collision"])
def test_a_mesh_that_is_none_is_told_with_its_link_before_anything_moves(
    role: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "cache"))
    robot = tmp_path / "carter"
    shutil.copytree(FILE.parent, robot)
    (robot / "words.stl").write_text("these are words")
    cart = (robot / "cart.urdf").read_text()
    mesh = f'<geometry><mesh filename="{robot / "words.stl"}"/></geometry>'
    shape, count = re.subn(f"(<{role}>.*?)<geometry>.*?</geometry>", rf"\1{mesh}", cart, count=1)
    assert count
    (robot / "cart.urdf").write_text(shape)
    with pytest.raises(WorldError, match=rf"the {role} mesh .*words.stl of the link .* as a mesh"):
        Simulator(read_robot(robot / "robot.yaml"), plain_episode(table=False), 0)
