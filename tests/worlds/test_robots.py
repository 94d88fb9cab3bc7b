"""The robots of this package: their descriptions fit their URDF and the contract."""

from __future__ import annotations

import importlib.util
import math
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from momantu_worlds.robots import FOLDER, fetch
from ruamel.yaml import YAML

from momantu_bt.robot import CAMERA_CARRIER, REQUIRED_POSES, ActuatorKind, CameraSensor
from momantu_bt.robots import RobotFileError, RobotNotInstalled, read_robot
from momantu_bt.robots.plugins import ROBOTS
from momantu_bt.robots.reader import read_robot_file

FETCH = fetch()
MOVING = [
    joint
    for actuator in FETCH.actuators.values()
    if actuator.kind is ActuatorKind.JOINTS
    for joint in actuator.joints
]


def test_loading_it_loads_no_simulator() -> None:
    code = (
        "import sys; from momantu_worlds.robots import fetch; fetch(); "
        "print([m for m in ('sapien', 'torch', 'trimesh', 'mani_skill') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_required_pose_names_every_joint_within_its_limits() -> None:
    assert set(REQUIRED_POSES) <= set(FETCH.named_poses)
    for pose in FETCH.named_poses.values():
        assert set(pose) == set(MOVING)
        for joint, value in pose.items():
            limit = FETCH.joint_limits[joint]
            assert limit.lower is None or limit.lower <= value
            assert limit.upper is None or value <= limit.upper


def test_frames_joints_and_links_exist_in_the_urdf() -> None:
    frames = set(FETCH.kinematics().frames())
    named = {sensor.frame for sensor in FETCH.sensors.values()}
    named |= {FETCH.end_effector.frame, *FETCH.end_effector.touch_links}
    named |= {link for pair in FETCH.ignored_collisions for link in pair}
    assert named <= frames
    assert FETCH.resolve_use(CAMERA_CARRIER) == "head"
    assert FETCH.groups["arm"].joints == FETCH.actuators["arm"].joints


def test_the_camera_looks_along_z_with_y_down() -> None:
    _, camera = FETCH.camera()
    assert isinstance(camera, CameraSensor)
    view = FETCH.kinematics().base_from_frame(camera.frame, {"head_tilt_joint": 0.0}).rotation
    assert np.allclose(view[:, 2], [1, 0, 0], atol=1e-6)
    assert np.allclose(view[:, 1], [0, 0, -1], atol=1e-6)


def test_the_footprint_surrounds_the_base_counter_clockwise() -> None:
    path = FETCH.mesh_directories[0] / "fetch_description/meshes/base_link_collision.STL"
    mesh = trimesh.load(path, force="mesh")
    corners = np.array(FETCH.footprint)
    edges = np.roll(corners, -1, axis=0) - corners
    to_points = mesh.vertices[:, None, :2] - corners[None]
    left = edges[:, 0] * to_points[..., 1] - edges[:, 1] * to_points[..., 0]
    assert np.all(left > 0.0)


def test_pads_lie_about_the_grasp_frame_as_described() -> None:
    pads = FETCH.mesh_directories[0] / "fetch_description/meshes/r_gripper_finger_link.STL"
    low, high = trimesh.load(pads, force="mesh").bounds
    effector = FETCH.end_effector
    assert high[0] - low[0] == pytest.approx(effector.pad_length, abs=1e-3)
    assert high[2] - low[2] == pytest.approx(effector.pad_height, abs=1e-3)
    assert abs(high[0] + low[0]) < 5e-3
    palm = FETCH.mesh_directories[0] / "fetch_description/meshes/gripper_link.STL"
    assert -trimesh.load(palm, force="mesh").bounds[1][0] == pytest.approx(
        effector.hand_clearance, abs=1e-3
    )


def test_the_folded_arm_stays_near_the_base() -> None:
    radius = max(math.hypot(*corner) for corner in FETCH.footprint)
    kinematics = FETCH.kinematics()
    for frame in ("elbow_flex_link", "wrist_flex_link", "gripper_link"):
        for pose in ("home", "ready", "look_around"):
            position = kinematics.base_from_frame(frame, FETCH.named_poses[pose]).position
            assert math.hypot(position[0], position[1]) < radius


def test_without_the_mesh_package_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(RobotNotInstalled, match=r"mani_skill.*make setup"):
        fetch()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("kind: base}", "kind: wheels}"), "actuators.base.kind"),
        (("grasp_offset: 0.0", "grasp_ofset: 0.0"), "grasp_ofset"),
        (("name: fetch", "name: [fetch"), "is never closed"),
    ],
)
def test_a_broken_robot_file_is_named_with_the_place(
    tmp_path: Path, change: tuple[str, str], words: str
) -> None:
    text = (FOLDER / "fetch" / "robot.yaml").read_text().replace(*change)
    (tmp_path / "robot.yaml").write_text(text)
    with pytest.raises(RobotFileError, match=words):
        read_robot(tmp_path)


def test_it_can_be_simulated_with_a_friction_that_rubber_has() -> None:
    assert FETCH.simulation is not None
    assert 1.0 <= FETCH.simulation.finger_friction <= 2.0


@pytest.mark.parametrize("file", sorted(FOLDER.glob("*/robot.yaml")), ids=lambda f: f.parent.name)
def test_every_robot_of_the_package_reads_the_same_when_it_is_written_again(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "robot"
    shutil.copytree(file.parent, folder)
    model, robot = read_robot_file(folder / "robot.yaml"), read_robot(folder)
    with (folder / "robot.yaml").open("w") as out:
        YAML().dump(model.as_written(), out)
    assert read_robot(folder) == robot
    assert robot.name == file.parent.name == ROBOTS.load(robot.name)().name
