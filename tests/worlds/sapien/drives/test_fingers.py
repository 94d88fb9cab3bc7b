"""Forces at the pads become torques of joints; fingers are coupled, tips follow their motors."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_worlds.robots import fetch, kinova_jackal
from momantu_worlds.sapien.config import Physics
from momantu_worlds.sapien.drives.fingers import (
    Finger,
    Hanging,
    Tips,
    fingers_of,
    knuckle_of,
    torques,
)
from momantu_worlds.sapien.drives.gains import Gains, arm_gains, with_own

from momantu_bt.robot import JointGains, Linkage, RobotDescription
from momantu_bt.world import WorldError

PHYSICS = Physics()


class FakeJoint:
    """Keeps what it was told."""

    def __init__(self, low: float = 0.0, high: float = 1.2) -> None:
        self.limits = np.array([[low, high]])
        self.target = 0.0
        self.force = 0.0

    def set_drive_target(self, target: float) -> None:
        self.target = target

    def set_drive_property(self, stiffness: float, damping: float, force: float) -> None:
        self.force = force


def fingers(description: RobotDescription) -> dict[str, Finger]:
    assert description.simulation is not None
    joints: dict[str, Any] = {name: FakeJoint() for name in description.end_effector.opening}
    return fingers_of(description, description.simulation, joints, PHYSICS)


def test_fingers_that_slide_have_no_lever() -> None:
    for finger in fingers(fetch()).values():
        assert finger.lever == 1.0
        assert finger.closing == -1.0
        assert finger.gains.stiffness == PHYSICS.finger_stiffness
        assert finger.span == pytest.approx(0.05)


def test_fingers_that_turn_have_the_distance_to_the_grasp_as_lever() -> None:
    for finger in fingers(kinova_jackal()).values():
        assert finger.lever == pytest.approx(0.16 - 0.115, abs=2e-3)
        assert finger.closing == 1.0
        assert finger.gains.stiffness == PHYSICS.finger_stiffness * finger.lever**2
        assert finger.gains.armature > 0.0


def test_each_side_presses_with_the_whole_force_however_many_fingers_it_has() -> None:
    pair, three = fingers(fetch()), fingers(kinova_jackal())
    assert set(torques(pair, 40.0).values()) == {40.0}
    for name, torque in torques(three, 25.0).items():
        assert torque / three[name].lever == pytest.approx(25.0 / 1.5)
    name, finger = next(iter(pair.items()))
    assert torques({name: finger}, 40.0) == {name: 40.0}


def hanging_tip() -> dict[str, Finger]:
    """One knuckle with a tip that turns against it."""
    gains = Gains(4.0, 0.2, 50.0, 0.0)
    return {
        "knuckle": Finger(FakeJoint(), gains, 0.1, -1.0, 0.5, 0.0),
        "tip": Finger(FakeJoint(), gains, 0.1, 1.0, 0.5, 0.0, knuckle="knuckle"),
    }


def test_what_hangs_on_a_finger_has_no_share_of_its_force() -> None:
    other = {"across": Finger(FakeJoint(), Gains(4.0, 0.2, 0.0, 0.0), 0.1, 1.0, 0.5, 0.0)}
    found = torques({**hanging_tip(), **other}, 40.0)
    assert found == {"knuckle": pytest.approx(4.0), "across": pytest.approx(4.0)}


def test_what_hangs_on_a_finger_turns_with_it() -> None:
    rows = {"knuckle": ((0.0, 0.0), (0.1, 0.5)), "tip": ((0.0, 0.0), (0.1, -0.5))}
    effector = fetch().hand.model_copy(update={"opening": rows})
    both = hanging_tip()
    hanging = Hanging(effector, both, {"knuckle": 1, "tip": 2})
    assert both["tip"].joint.force == 50.0
    for position in (0.5, 0.31, 0.0):
        hanging.follow(np.array([9.0, position, 9.0]))
        assert both["tip"].joint.target == pytest.approx(-position)


LINKED = """<robot name="r"><link name="base"/>
<link name="left"/><link name="pad_arm"/><link name="pad"/><link name="bar"/><link name="right"/>
<joint name="bar_joint" type="revolute"><parent link="base"/><child link="bar"/>
  <axis xyz="0 0 1"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>
<joint name="left_joint" type="revolute"><parent link="base"/><child link="left"/>
  <axis xyz="0 0 1"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>
<joint name="fixed" type="fixed"><parent link="left"/><child link="pad_arm"/></joint>
<joint name="tip_joint" type="revolute"><parent link="pad_arm"/><child link="pad"/>
  <axis xyz="0 0 -1"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>
<joint name="right_joint" type="revolute"><parent link="base"/><child link="right"/>
  <axis xyz="0 0 -1"/><limit lower="0" upper="1" velocity="1" effort="1"/></joint>
</robot>"""


def test_a_bar_follows_the_finger_beside_it_and_a_tip_the_one_below_it(tmp_path: Path) -> None:
    path = tmp_path / "hand.urdf"
    path.write_text(LINKED)
    opening = {
        f"{name}_joint": ((0.0, 0.5), (0.08, 0.0)) for name in ("bar", "left", "tip", "right")
    }
    hand = fetch().hand.model_copy(update={"opening": opening})
    robot = fetch().model_copy(update={"end_effector": hand, "urdf": path, "base_frame": "base"})
    found = {name: knuckle_of(robot, ("pad", "right"), name) for name in opening}
    assert found == {
        "bar_joint": "left_joint",
        "left_joint": None,
        "tip_joint": "left_joint",
        "right_joint": None,
    }
    assert knuckle_of(robot, (), "bar_joint") is None


def test_a_gripper_that_cannot_close_is_refused_with_the_reason() -> None:
    robot = kinova_jackal()
    hand = robot.end_effector
    sideways = robot.model_copy(
        update={"end_effector": hand.model_copy(update={"frame": "arm_finger_1"})}
    )
    with pytest.raises(WorldError, match=r"arm_joint_finger_1.* along y of 'arm_finger_1'"):
        fingers(sideways)
    bare = robot.model_copy(update={"end_effector": hand.model_copy(update={"opening": {}})})
    with pytest.raises(WorldError, match="no joints"):
        fingers(bare)


def test_a_joints_own_gains_take_the_place_of_the_usual_ones() -> None:
    usual = Gains(1.0, 2.0, 3.0, 0.0)
    assert with_own(None, usual) == usual
    assert with_own(JointGains(damping=0.0, armature=0.5), usual) == Gains(1.0, 0.0, 3.0, 0.5)


def test_forces_are_the_urdfs_where_the_description_gives_none() -> None:
    robot = kinova_jackal()
    assert robot.simulation is not None
    gains = arm_gains(robot, robot.simulation, PHYSICS)
    assert [gains[f"arm_joint_{i}"].force for i in (1, 2, 6)] == [40.0, 80.0, 20.0]
    weak = robot.simulation.model_copy(update={"drives": {"arm_joint_2": JointGains(force=5.0)}})
    assert arm_gains(robot, weak, PHYSICS)["arm_joint_2"].force == 5.0


def test_an_effort_of_0_limits_nothing(tmp_path: Path) -> None:
    robot = kinova_jackal()
    assert robot.simulation is not None
    text = robot.urdf.read_text(encoding="utf-8")
    assert 'effort="40"' in text
    (tmp_path / "idle.urdf").write_text(text.replace('effort="40"', 'effort="0"'), encoding="utf-8")
    idle = robot.model_copy(update={"urdf": tmp_path / "idle.urdf"})
    gains = arm_gains(idle, robot.simulation, PHYSICS)
    assert [gains[f"arm_joint_{i}"].force for i in (1, 2)] == [math.inf, 80.0]


@pytest.mark.parametrize("closing", [1.0, -1.0])
def test_a_tip_takes_the_travel_that_its_finger_cannot(closing: float) -> None:
    motor, tip = FakeJoint(), FakeJoint()
    gains = Gains(4.0, 0.2, 0.0, 0.0)
    linkage = Linkage(motor="finger", ratio=4.0, share=0.25, preload=0.03)
    finger = Finger(motor, gains, 0.05, closing, 1.3, 0.0)
    tips = Tips({"tip": linkage}, {"finger": finger}, {"tip": tip}, {"tip": gains}, {"finger": 1})
    for left, wanted in ((0.0, 0.0), (0.02, 0.0), (0.13, 0.4), (2.0, 1.2), (-0.5, 0.0)):
        tips.follow({"finger": 0.5 + closing * left}, np.array([9.0, 0.5]))
        assert tip.target == pytest.approx(wanted)
    tips.press({"finger": 0.8})
    assert tip.force == pytest.approx(0.2)
