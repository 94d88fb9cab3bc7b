"""The Kinova-Jackal is what its makers publish, and stands, drives and never touches itself."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.sensors.own_body import OwnBody
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import plain_episode

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import BaseVelocity, JointPositions
from momantu_bt.robot import laser_band

ROBOT = kinova_jackal()
ARM = ROBOT.actuators["arm"].joints
TREE = ROBOT.kinematics()
POSES = sorted(ROBOT.named_poses)
STRAIGHT = dict(zip(ARM, [0.0, math.pi, math.pi, 0.0, 0.0, 0.0], strict=True))
"""The arm stretched upwards, as Kinova counts its angles."""


def simulated(pose: str = "home") -> Simulator:
    start = Pose2D(-3.0, 0.0, 0.0)
    episode = dataclasses.replace(plain_episode(table=False), start=start)
    return Simulator(ROBOT, episode, 0, render=False, pose=ROBOT.named_poses[pose])


def body(simulator: Simulator) -> Array:
    """Corners (n, 3) of everything of the robot, in the base frame."""
    own = OwnBody(simulator.model.links.values())
    return own.triangles(own.poses(simulator.truth.link(ROBOT.base_frame))).reshape(-1, 3)


def test_the_arm_has_the_published_lengths() -> None:
    names = ("link_base", "link_2", "link_3", "link_4", "link_5", "link_6", "end_effector")
    at = {name: TREE.base_from_frame(f"arm_{name}", STRAIGHT).position for name in names}
    assert at["link_2"][2] - at["link_base"][2] == pytest.approx(0.2755, abs=1e-4)
    assert at["link_3"][2] - at["link_2"][2] == pytest.approx(0.4100, abs=1e-4)
    assert at["link_4"][2] - at["link_3"][2] == pytest.approx(0.2073, abs=1e-4)
    assert abs(at["link_4"][1] - at["link_base"][1]) == pytest.approx(0.0098, abs=1e-4)
    assert np.linalg.norm(at["link_5"] - at["link_4"]) == pytest.approx(0.0741, abs=1e-4)
    assert np.linalg.norm(at["link_6"] - at["link_5"]) == pytest.approx(0.0741, abs=1e-4)
    assert np.linalg.norm(at["end_effector"] - at["link_6"]) == pytest.approx(0.16, abs=1e-4)


def test_the_base_has_the_published_size_and_weight() -> None:
    simulator = simulated()
    base = [
        link
        for name, link in simulator.model.links.items()
        if name == "chassis_link" or "wheel" in name
    ]
    own = OwnBody(base)
    points = own.triangles(own.poses(simulator.truth.link(ROBOT.base_frame))).reshape(-1, 3)
    size = points.max(axis=0) - points.min(axis=0)
    assert size == pytest.approx([0.508, 0.416, 0.2475], abs=0.015)
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-3)
    assert sum(link.mass for link in base) == pytest.approx(17.0, abs=0.01)
    assert sum(link.mass for link in simulator.model.links.values()) < 17.0 + 20.0


@pytest.mark.parametrize("pose", POSES)
def test_named_poses_touch_nothing_and_stay(pose: str) -> None:
    simulator = simulated(pose)
    simulator.truth.watch_contacts()
    for _ in range(10):
        simulator.step()
        assert simulator.truth.contacts() == ()
    for joint, value in ROBOT.named_poses[pose].items():
        assert simulator.truth.joint(joint) == pytest.approx(value, abs=1e-3)


@pytest.mark.parametrize(("pose", "beyond"), [("home", 0.03), ("carry", 0.08)])
def test_driving_poses_stay_above_the_base(pose: str, beyond: float) -> None:
    points = body(simulated(pose))
    corners = np.array(ROBOT.footprint)
    assert np.all(points[:, :2].max(axis=0) < corners.max(axis=0) + beyond)
    assert np.all(points[:, :2].min(axis=0) > corners.min(axis=0) - beyond)
    assert points[:, 2].max() < ROBOT.height


def test_the_hand_is_level_when_it_carries_and_looks_where_the_poses_say() -> None:
    carry = TREE.base_from_frame("hand", ROBOT.named_poses["carry"]).rotation
    assert carry[2, 2] > math.cos(math.radians(1.0))
    dips = {}
    for pose in POSES:
        axis = TREE.base_from_frame("arm_camera_optical_frame", ROBOT.named_poses[pose]).rotation[
            :, 2
        ]
        assert axis[0] > 0.8
        dips[pose] = math.degrees(math.asin(-axis[2]))
    assert 25.0 < dips["home"] < 40.0
    assert 15.0 < dips["look_around"] < 30.0


def test_the_grasp_frame_lies_between_the_fingers() -> None:
    hand_from_base = TREE.base_from_frame("hand", STRAIGHT).inverse()
    tips = []
    for i in (1, 2, 3):
        tip = TREE.base_from_frame(f"arm_finger_tip_{i}", STRAIGHT) @ Transform((0.05, 0, 0))
        tips.append((hand_from_base @ tip).position)
    thumb, second, third = tips
    assert thumb[1] > 0.05
    assert second[1] < -0.05
    assert third[1] < -0.05
    assert second[2] == pytest.approx(-third[2], abs=1e-3)
    palm = (hand_from_base @ TREE.base_from_frame("arm_link_6", STRAIGHT)).position
    assert palm == pytest.approx([-0.16, 0.0, 0.0], abs=1e-6)


def test_the_hand_is_outside_the_picture_or_at_its_lower_border() -> None:
    simulator = simulated("carry")
    _, camera = ROBOT.camera()
    fingers = [link for name, link in simulator.model.links.items() if "finger" in name]
    own = OwnBody([*fingers, simulator.model.links["arm_link_6"]])
    points = own.triangles(own.poses(simulator.truth.link(camera.frame))).reshape(-1, 3)
    before = points[points[:, 2] > 0.01]
    tall = math.tan(camera.horizontal_fov / 2) * camera.height / camera.width
    assert np.all(before[:, 1] / before[:, 2] > 0.8 * tall)


def test_the_scan_sees_a_band_around_the_lidar() -> None:
    low, high = laser_band(ROBOT)
    lidar = TREE.base_from_frame(ROBOT.lidar()[1].frame, {}).position[2]
    assert 0.05 < low < lidar < high


def test_it_drives_straight_turns_and_stops() -> None:
    simulator = simulated()
    for _ in range(60):
        simulator.robot.command("base", BaseVelocity(1.0, 0.0))
        simulator.step()
    there = simulator.truth.base()
    assert there.x == pytest.approx(-0.5, abs=0.05)
    assert abs(there.y) < 0.01
    for _ in range(20):
        simulator.robot.command("base", BaseVelocity(0.0, 1.5))
        simulator.step()
    assert simulator.truth.base().yaw == pytest.approx(1.5 * (1.0 - 0.25), abs=0.03)
    for _ in range(30):
        simulator.robot.command("base", BaseVelocity(0.0, 0.0))
        simulator.step()
    assert max(simulator.truth.base_speed()) < 1e-3


def test_the_arm_goes_from_pose_to_pose_at_its_speed_without_giving_way() -> None:
    simulator = simulated("home")
    goal = ROBOT.named_poses["look_around"]
    positions = tuple(goal[name] for name in ARM)
    fastest = dict.fromkeys(ARM, 0.0)
    for _ in range(60):
        simulator.robot.command("arm", JointPositions(ARM, positions))
        simulator.step()
        for name, speed in simulator.truth.joint_speeds().items():
            if name in fastest:
                fastest[name] = max(fastest[name], speed.speed)
    for name in ARM:
        assert simulator.robot.state().position(name) == pytest.approx(goal[name], abs=5e-3)
        assert fastest[name] < ROBOT.joint_limits[name].velocity * 1.05


def test_a_load_in_the_hand_bends_the_arm_little() -> None:
    simulator = simulated("carry")
    before = simulator.truth.link("hand").position
    hand = simulator.model.links["arm_link_6"]
    for _ in range(20 * 12):
        hand.add_force_at_point([0.0, 0.0, -10.0], hand.entity_pose.p)
        simulator._system.step()
    sag = before[2] - simulator.truth.link("hand").position[2]
    assert 0.0 < sag < 2e-3
