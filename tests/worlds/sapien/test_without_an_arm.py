"""A simulated robot that drives and has neither arm nor hand nor named poses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_worlds.checking.measures import measured
from momantu_worlds.preview.robot_scene import robot_episode
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.referee.hand import hand_of

from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import LaserSensor, RobotDescription
from momantu_bt.robots import read_robot

CART = """<robot name="cart"><link name="base_link">
<inertial><mass value="10"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 0.2"/><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>
<link name="scan"/><joint name="scanner" type="fixed"><parent link="base_link"/>
<child link="scan"/><origin xyz="0.1 0 0.35"/></joint></robot>"""
FILE = """momantu_robot: 1
name: cart
parts: {cart: {urdf: cart.urdf}}
footprint: [[0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15], [0.2, -0.15]]
height: 0.4
working: {stand_off: 0.3, look_off: 0.5}
base: {linear: 0.8, angular: 1.5, linear_acceleration: 0.8, angular_acceleration: 2.0,
  drive: {force: 50, torque: 10}}
actuators: {base: {kind: base}}
sensors:
  laser: {kind: laser, frame: scan, angle_min: -1.9, angle_max: 1.9, beams: 90, range_min: 0.05,
    range_max: 10}
simulation: {floor_links: [base_link], finger_links: [], finger_friction: 1.0}
"""


@pytest.fixture
def cart(tmp_path: Path) -> RobotDescription:
    (tmp_path / "cart.urdf").write_text(CART)
    (tmp_path / "robot.yaml").write_text(FILE)
    return read_robot(tmp_path)


def test_it_drives(cart: RobotDescription) -> None:
    assert isinstance(cart.laser()[1], LaserSensor)
    simulator = Simulator(cart, robot_episode(cart), seed=0, render=False)
    try:
        for _ in range(40):
            simulator.robot.command("base", BaseVelocity(0.5, 0.0))
            simulator.step()
        state = simulator.robot.state()
        assert simulator.truth.base().x > 0.3
        assert state.names == ()
        assert (state.gripper_width, state.gripper_effort) == (0.0, 0.0)
        assert state.odom_from_base.position[0] == pytest.approx(simulator.truth.base().x, abs=0.1)
    finally:
        simulator.close()


def test_the_referee_and_the_checks_of_worlds_know_of_no_hand(cart: RobotDescription) -> None:
    assert hand_of(cart).gripper is None
    assert hand_of(cart).joints == frozenset()
    found = measured(cart)
    assert found.max_width == 0.0
    assert np.shape(found.hand) == (0, 2)
