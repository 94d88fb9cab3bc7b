"""What is found out about two small robots whose every measure is known, and about Fetch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_skills.manipulation.model.hulls import placed
from momantu_skills.robot_setup.find.poses import HELD
from momantu_skills.robot_setup.find.proposal import Proposal, propose
from momantu_skills.robot_setup.urdf.body import Body
from momantu_skills.robot_setup.urdf.skeleton import read_skeleton
from momantu_skills.robot_setup.write.sensor_writer import sensor_names
from momantu_skills.robot_setup.write.writer import robot_file
from momantu_worlds.robots import fetch
from scipy.spatial import ConvexHull

from momantu_bt.formats.urdf import read_urdf
from momantu_bt.geometry import Transform
from momantu_bt.robot import RobotDescription
from momantu_bt.robots import read_robot


def test_the_rolling_robot_stands_on_its_wheels(rolling_proposal: Proposal) -> None:
    stand = rolling_proposal.stand
    assert rolling_proposal.base.frame == "base_link"
    assert set(stand.wheels) == {"left_wheel", "right_wheel"}
    assert set(stand.grounded) == {"left_wheel", "right_wheel"}
    assert stand.floor == pytest.approx(0.0, abs=3e-3)
    assert stand.footprint is not None
    assert np.ptp(stand.footprint, axis=0) == pytest.approx((0.5, 0.44), abs=0.003)
    assert stand.mass == pytest.approx(37.1, abs=0.2)


def test_a_parallel_gripper_is_measured(rolling_proposal: Proposal) -> None:
    grasp = rolling_proposal.grasp
    assert grasp is not None
    assert grasp.link_from_grasp is not None
    assert grasp.link == "palm"
    assert grasp.max_width == pytest.approx(0.08, abs=1e-3)
    assert grasp.opening["left_slide"] == ((0.0, 0.0), (0.08, 0.04))
    assert grasp.link_from_grasp.position == pytest.approx((0, 0, 0.085), abs=1e-3)
    assert grasp.link_from_grasp.rotation[:, 0] == pytest.approx((0, 0, 1), abs=1e-6)
    assert abs(grasp.link_from_grasp.rotation[0, 1]) == pytest.approx(1.0)
    assert (grasp.pad_length, grasp.pad_height) == pytest.approx((0.03, 0.02), abs=1e-3)
    assert grasp.hand_clearance == pytest.approx(0.025, abs=1e-3)
    assert grasp.max_force == pytest.approx(40.0)


def test_hinged_fingers_are_measured_at_their_tips(bolted_proposal: Proposal) -> None:
    grasp = bolted_proposal.grasp
    assert grasp is not None
    assert grasp.link_from_grasp is not None
    # closed they stay 2 cm apart; each turns out by 0.6 rad about a hinge 2 cm off the middle,
    # and the opening is measured where the pads' inner part is nearest
    assert grasp.thinnest == pytest.approx(0.02, abs=1e-3)
    height = grasp.link_from_grasp.position[2] - 0.07 - 0.2 * grasp.pad_length
    along = (height - 0.01 * np.sin(0.6)) / np.cos(0.6)
    inner = 0.02 - 0.01 * np.cos(0.6) + along * np.sin(0.6)
    assert grasp.max_width == pytest.approx(2 * inner, abs=1e-3)
    assert set(grasp.opening) == {"left_hinge", "right_hinge"}
    rows = grasp.opening["left_hinge"]
    assert rows[0][0] == 0.0
    assert rows[0][1] < 0.0 == rows[1][1]
    assert grasp.link_from_grasp.rotation[:, 0] == pytest.approx((0, 0, 1), abs=1e-6)
    assert abs(grasp.link_from_grasp.rotation[1, 1]) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["rolling_proposal", "bolted_proposal"])
def test_openings_rise(name: str, request: pytest.FixtureRequest) -> None:
    grasp = request.getfixturevalue(name).grasp
    for rows in grasp.opening.values():
        widths, positions = np.array(rows).T
        assert widths[0] == 0.0
        assert widths[-1] == grasp.max_width
        assert (np.diff(widths) > 0).all()
        assert (np.diff(positions) > 0).all() or (np.diff(positions) < 0).all()


def test_arms_heads_and_cameras(rolling_proposal: Proposal, bolted_proposal: Proposal) -> None:
    rolling, bolted = rolling_proposal.limbs, bolted_proposal.limbs
    assert rolling.arm is not None
    assert bolted.arm is not None
    assert rolling.arm.joints == ("pan", "lift", "elbow", "flex", "roll")
    assert rolling.head is not None
    assert rolling.head.joints == ("head_pan", "head_tilt")
    assert bolted.arm.joints == ("a1", "a2", "a3", "a4", "a5", "a6")
    assert bolted.head is None
    assert list(sensor_names(rolling_proposal)) == ["head_camera", "laser"]
    (name, camera), *others = sensor_names(bolted_proposal).items()
    assert not others
    assert name == "hand_camera"
    assert camera.written
    assert (camera.fov, camera.size) == (1.2, (320, 240))


@pytest.mark.parametrize("name", ["rolling_proposal", "bolted_proposal"])
def test_poses_are_clear_and_within_limits(name: str, request: pytest.FixtureRequest) -> None:
    proposal: Proposal = request.getfixturevalue(name)
    assert set(proposal.poses) == {"home", "ready", "carry", "look_around"}
    for pose in proposal.poses.values():
        assert pose.clear is not None
        for joint, value in pose.joints.items():
            limit = proposal.limits[joint].limit
            assert limit.lower is None or limit.lower <= value
            assert limit.upper is None or value <= limit.upper
    assert proposal.poses["home"].outside < 0.08


def test_a_second_time_gives_the_same(rolling_proposal: Proposal) -> None:
    source = rolling_proposal.prepared.source
    again = propose(source, samples=500)
    assert again.poses == rolling_proposal.poses
    assert again.grasp == rolling_proposal.grasp
    assert again.reach.reach == rolling_proposal.reach.reach


@pytest.fixture(scope="module")
def by_hand() -> RobotDescription:
    return fetch()


def test_fetch_comes_near_to_what_a_person_wrote(by_hand: RobotDescription) -> None:
    found = propose(by_hand.urdf, samples=300)
    arm, hand, grasp = by_hand.groups["arm"], by_hand.end_effector, found.grasp
    assert found.limbs.arm is not None
    assert grasp is not None
    assert found.limbs.arm.joints == arm.joints
    assert found.limbs.head is not None
    assert found.limbs.head.joints == by_hand.actuators["head"].joints
    assert found.virtual == ("root_x_axis_joint", "root_y_axis_joint", "root_z_rotation_joint")
    assert (grasp.link, grasp.link_from_grasp) == (hand.frame, None)
    assert grasp.max_width == pytest.approx(hand.max_width, abs=2e-3)
    assert grasp.pad_length == pytest.approx(hand.pad_length, abs=3e-3)
    assert grasp.pad_height == pytest.approx(hand.pad_height, abs=3e-3)
    assert grasp.hand_clearance == pytest.approx(hand.hand_clearance, abs=3e-3)
    assert found.reach.stand_off == pytest.approx(by_hand.working.stand_off, abs=0.05)
    assert found.reach.reach == pytest.approx(by_hand.working.reach, abs=0.15)
    camera, laser = found.sensors[:2]
    assert camera.link == by_hand.camera()[1].frame
    assert laser.link == by_hand.laser()[1].frame


@pytest.mark.parametrize("name", ["rolling_proposal", "bolted_proposal"])
def test_what_is_carried_is_clear_of_the_robot(
    name: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    proposal: Proposal = request.getfixturevalue(name)
    (tmp_path / "robot.yaml").write_text(robot_file(proposal, tmp_path))
    robot = read_robot(tmp_path)
    carry = robot.named_poses["carry"]
    hand = robot.kinematics().base_from_frame(robot.hand.frame, carry)
    held = (hand @ Transform((robot.hand.grasp_offset, 0.0, 0.0))).position
    body = Body(read_skeleton(read_urdf(robot.urdf)), robot)
    poses = body.link_poses(carry)
    for link, corners in body.hulls.items():
        if link not in robot.hand.touch_links:
            planes = ConvexHull(placed(corners, poses[link])).equations
            assert (planes[:, :3] @ held + planes[:, 3]).max() > 0.9 * HELD, link
