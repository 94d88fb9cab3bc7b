"""The fingers of a gripper that is no end effector stay where they are: nothing moves them."""

from __future__ import annotations

from pathlib import Path

import pytest
from momantu_worlds.preview.robot_scene import robot_episode
from momantu_worlds.sapien.simulator import Simulator

from momantu_bt.messages import BaseVelocity, GripperCommand
from momantu_bt.robots import read_robot

INERTIA = '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/>'
FINGER = """<link name="{name}"><inertial><origin xyz="0.1 0 0"/><mass value="0.1"/>{inertia}
</inertial><collision><origin xyz="0.1 0 0"/><geometry><box size="0.15 0.01 0.02"/></geometry>
</collision></link><joint name="{name}_joint" type="{kind}"><parent link="base_link"/>
<child link="{name}"/><origin xyz="{place}"/><axis xyz="{axis}"/>
<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>{mimic}</joint>"""
SLIDE = {"kind": "prismatic", "inertia": INERTIA, "mimic": ""}
HINGE = {"kind": "revolute", "axis": "0 0 1", "inertia": INERTIA}
MIMIC = '<mimic joint="swing_joint" multiplier="-1"/>'
CART = "".join(
    [
        '<robot name="cart"><link name="base_link"><inertial><mass value="10"/>',
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision>',
        '<origin xyz="0 0 0.2"/><geometry><box size="0.4 0.3 0.2"/></geometry></collision></link>',
        FINGER.format(name="left", place="0.2 0.02 0.4", axis="0 1 0", **SLIDE),
        FINGER.format(name="right", place="0.2 -0.02 0.4", axis="0 -1 0", **SLIDE),
        FINGER.format(name="swing", place="-0.1 0.1 0.4", mimic="", **HINGE),
        FINGER.format(name="after", place="-0.1 -0.1 0.4", mimic=MIMIC, **HINGE),
        "</robot>",
    ]
)
LIMIT = "{lower: -1.5, upper: 1.5, velocity: 1, acceleration: 1}"
FILE = f"""momantu_robot: 1
name: cart
parts: {{cart: {{urdf: cart.urdf}}}}
footprint: [[0.2, 0.15], [-0.2, 0.15], [-0.2, -0.15], [0.2, -0.15]]
height: 0.5
working: {{stand_off: 0.3, look_off: 0.5}}
base: {{linear: 0.8, angular: 1.5, linear_acceleration: 2.0, angular_acceleration: 4.0,
  drive: {{force: 200, torque: 50}}}}
actuators:
  base: {{kind: base}}
  gripper: {{kind: gripper, joints: [left_joint, right_joint]}}
  gripper_2: {{kind: gripper, joints: [swing_joint, after_joint]}}
joint_limits:
  left_joint: {LIMIT}
  right_joint: {LIMIT}
  swing_joint: {LIMIT}
  after_joint: {LIMIT}
end_effector: {{frame: base_link, max_width: 0.04, max_force: 10, pad_length: 0.02,
  pad_height: 0.02,
  hand_clearance: 0.05, touch_links: [left, right]}}
simulation: {{floor_links: [base_link], finger_links: [left, right], finger_friction: 1.0}}
"""


def test_the_fingers_of_a_gripper_that_nobody_moves_stay_still(tmp_path: Path) -> None:
    (tmp_path / "cart.urdf").write_text(CART)
    (tmp_path / "robot.yaml").write_text(FILE)
    cart = read_robot(tmp_path)
    simulator = Simulator(cart, robot_episode(cart), seed=0, render=False)
    try:
        model = simulator.robot._model
        swung = 0.0
        for _ in range(60):
            simulator.robot.command("base", BaseVelocity(0.4, 1.5))
            simulator.step()
            at = model.positions()
            swung = max(swung, *(abs(at[model.index[f"{n}_joint"]]) for n in ("swing", "after")))
        assert swung < 0.01
        with pytest.raises(ValueError, match="gripper_2 is not the end effector's gripper"):
            simulator.robot.command("gripper_2", GripperCommand(0.0, 1.0))
    finally:
        simulator.close()
