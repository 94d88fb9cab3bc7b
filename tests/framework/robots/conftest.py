"""A robot of two parts in a folder: a cart, and an arm with two fingers from a xacro file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

CART = """<?xml version="1.0"?>
<robot name="cart">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base_link">
    <inertial><origin xyz="0 0 0.2"/><mass value="30"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1.2"/></inertial>
    <visual><geometry><box size="0.5 0.4 0.2"/></geometry><material name="grey"/></visual>
    <collision><origin xyz="0 0 0.2"/><geometry><box size="0.5 0.4 0.2"/></geometry></collision>
  </link>
  <link name="mast"/>
  <joint name="mast_joint" type="fixed">
    <origin xyz="-0.1 0 0.3" rpy="0 0 0"/><parent link="base_link"/><child link="mast"/>
  </joint>
</robot>
"""
ARM = """<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="reach" default="0.4"/>
  <xacro:property name="reach" value="$(arg reach)"/>
  <material name="grey"><color rgba="0.2 0.2 0.2 1"/></material>
  <xacro:macro name="part" params="name mass size">
    <link name="${name}">
      <inertial><origin xyz="${size / 2} 0 0"/><mass value="${mass}"/>
        <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
      <visual><geometry><sphere radius="0.03"/></geometry><material name="grey"/></visual>
      <collision><geometry><box size="${size} 0.05 0.05"/></geometry></collision>
    </link>
  </xacro:macro>
  <link name="foot"/>
  <xacro:part name="shoulder" mass="2" size="0.1"/>
  <xacro:part name="forearm" mass="1.5" size="${reach}"/>
  <xacro:part name="left" mass="0.1" size="0.05"/>
  <xacro:part name="right" mass="0.1" size="0.05"/>
  <joint name="turn" type="revolute">
    <origin xyz="0 0 0.1"/><parent link="foot"/><child link="shoulder"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="50"/>
  </joint>
  <joint name="bend" type="continuous">
    <origin xyz="0.1 0 0"/><parent link="shoulder"/><child link="forearm"/><axis xyz="0 1 0"/>
    <limit velocity="1" effort="50"/>
  </joint>
  <joint name="left_slide" type="prismatic">
    <origin xyz="${reach} 0 0"/><parent link="forearm"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" velocity="0.1" effort="20"/>
  </joint>
  <joint name="right_slide" type="prismatic">
    <origin xyz="${reach} 0 0"/><parent link="forearm"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" velocity="0.1" effort="20"/>
    <mimic joint="left_slide"/>
  </joint>
  <transmission name="turning"><joint name="turn"/><actuator name="motor"/></transmission>
  <gazebo reference="forearm"><mu1>1</mu1></gazebo>
</robot>
"""
ROBOT = """# A cart with an arm.
momantu_robot: 1
name: carter
parts:
  cart: {urdf: cart.urdf}
  arm: {xacro: arm.urdf.xacro, namespace: arm, args: {reach: 0.5}}
mounts:
  arm: {on: base_link, xyz: [10 cm, 0, 30 cm], rpy: [0, 0, 90 deg]}
frames:
  hand: {on: arm_forearm, xyz: [0.55, 0, 0]}
  lens: {on: mast, xyz: [0, 0, 0.5], rpy: [-90 deg, 0, -90 deg]}
base:
  linear: 1.0
  angular: 1.5
  linear_acceleration: 1.0
  angular_acceleration: 3.0
  drive: {force: 200, torque: 50}
drives:
  arm: {stiffness: 1000, damping: 50}
  arm_bend: {stiffness: 400}
height: 0.9
working: {stand_off: 0.4, look_off: 0.6, reach: [0.4, 0.6, 0.8]}
footprint: [[0.25, 0.2], [-0.25, 0.2], [-0.25, -0.2], [0.25, -0.2]]
actuators:
  base: {kind: base}
  arm: {kind: joints, joints: [arm_turn, arm_bend]}
  gripper: {kind: gripper, joints: [arm_left_slide, arm_right_slide]}
joint_limits:
  arm_turn: {lower: -90 deg, upper: 90 deg, velocity: 1.0, acceleration: 1.5}
  arm_bend: {velocity: 60 deg/s, acceleration: 1.5}
  arm_left_slide: {lower: 0, upper: 4 cm, velocity: 0.1, acceleration: 0.5}
  arm_right_slide: {lower: 0, upper: 4 cm, velocity: 0.1, acceleration: 0.5}
sensors:
  camera:
    kind: camera
    frame: lens
    horizontal_fov: 60 deg
    min_depth: 0.3
    max_depth: 4.0
groups:
  arm: {joints: [arm_turn, arm_bend], tip: hand}
end_effector:
  frame: hand
  max_width: 8 cm
  max_force: 20
  pad_length: 4 cm
  pad_height: 2 cm
  hand_clearance: 3 cm
  touch_links: [arm_left, arm_right]
named_poses:
  home: {arm_turn: 0, arm_bend: 90 deg}
  ready: {arm_turn: 0, arm_bend: 0}
  carry: {arm_turn: 30 deg, arm_bend: 0}
  look_around: {arm_turn: 0.5, arm_bend: 0.1}
simulation:
  floor_links: [base_link]
  finger_links: [arm_left, arm_right]
  finger_friction: 1.0
"""


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MOMANTU_BT_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def carter(tmp_path: Path) -> Callable[..., Path]:
    """Writes the robot's folder, texts of its files changed: `carter(robot=(old, new))`."""

    def write(**changes: tuple[str, str]) -> Path:
        folder = tmp_path / "carter"
        folder.mkdir(exist_ok=True)
        texts = {"robot": ("robot.yaml", ROBOT), "cart": ("cart.urdf", CART)}
        texts["arm"] = ("arm.urdf.xacro", ARM)
        for key, (file, text) in texts.items():
            old, new = changes.pop(key, ("", ""))
            assert old in text
            (folder / file).write_text(text.replace(old, new, 1))
        assert not changes
        return folder / "robot.yaml"

    return write
