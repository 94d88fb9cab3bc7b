"""Three fingers with tips that wrap hold things by friction alone, and not without it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Part
from momantu_worlds.testing import CAN_MASS, plain_episode

from momantu_bt.geometry import Transform
from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions
from momantu_bt.robot import RobotDescription

ROBOT = kinova_jackal()
ARM = ROBOT.actuators["arm"].joints
LOW = dict(zip(ARM, np.radians([162.14, 195.73, 30.74, 8.23, -90.28, 31.37]), strict=True))
"""The hand level, 0.45 m before the base and 0.80 m high."""
LIFTED = dict(zip(ARM, np.radians([164.61, 171.68, 60.1, -29.05, -30.45, 41.6]), strict=True))
"""The same 15 cm higher."""
FORCE = ROBOT.end_effector.max_force
GRAVITY = 9.81
CAN = Part(Cylinder(0.035, 0.13))
SLIM_CAN = Part(Cylinder(0.033, 0.122))
BOTTLE = Part(Cylinder(0.030, 0.24))
CARTON = Part(Box((0.05, 0.06, 0.16)))


def height(part: Part) -> float:
    return part.geometry.size[2] if isinstance(part.geometry, Box) else part.geometry.height  # type: ignore[union-attr]


def gripped(
    part: Part = CAN,
    *,
    force: float = FORCE,
    friction: float = 0.8,
    beside: float = 0.0,
    robot: RobotDescription = ROBOT,
) -> Simulator:
    """The hand has closed on a thing that stood on a post, `beside` m off the middle."""
    x, y, z = robot.kinematics().base_from_frame("hand", LOW).position
    tall = height(part)
    episode = plain_episode(can_at=(x, y + beside, z - tall / 2), stand=True)
    bodies = [body for body in episode.bodies if body.name != "can"]
    pose = Transform((x, y + beside, z))
    bodies.append(Body("thing", "thing", pose, (part,), False, CAN_MASS, friction))
    episode = dataclasses.replace(episode, bodies=tuple(bodies))
    simulator = Simulator(robot, episode, 0, render=False, pose=LOW)
    for _ in range(45):
        simulator.robot.command("gripper", GripperCommand(0.03, force))
        simulator.step()
    return simulator


def go(simulator: Simulator, pose: dict[str, float], ticks: int) -> None:
    goal = JointPositions(ARM, tuple(pose[name] for name in ARM))
    for _ in range(ticks):
        simulator.robot.command("arm", goal)
        simulator.step()


def hand_from_thing(simulator: Simulator) -> Transform:
    return simulator.truth.link("hand").inverse() @ simulator.truth.pose("thing")


def slipped(before: Transform, simulator: Simulator) -> tuple[float, float]:
    """How far a thing has moved in the hand since, m and rad."""
    after = hand_from_thing(simulator)
    return float(np.abs(after.position - before.position).max()), after.angle_to(before)


@pytest.mark.parametrize("part", [CAN, SLIM_CAN, BOTTLE, CARTON])
def test_it_is_lifted_shaken_and_kept_through_a_hard_stop(part: Part) -> None:
    simulator = gripped(part)
    before = hand_from_thing(simulator)
    go(simulator, LIFTED, 70)
    assert simulator.truth.pose("thing").position[2] == pytest.approx(0.95, abs=0.02)
    shaken = dict(LIFTED)
    for turn in (0.35, -0.35, 0.0):
        shaken["arm_joint_1"] = LIFTED["arm_joint_1"] + turn
        shaken["arm_joint_6"] = LIFTED["arm_joint_6"] + turn
        go(simulator, shaken, 20)
    for speed in (-1.0, 0.0):
        for _ in range(30):
            simulator.robot.command("base", BaseVelocity(speed, 0.0))
            simulator.step()
    moved, turned = slipped(before, simulator)
    assert moved < 3e-3
    assert turned < math.radians(2.0)


def test_a_can_beside_the_middle_is_drawn_into_it() -> None:
    simulator = gripped(beside=0.012)
    assert abs(hand_from_thing(simulator).position[1]) < 5e-3


def test_without_friction_it_slips() -> None:
    assert ROBOT.simulation is not None
    slippery = ROBOT.simulation.model_copy(update={"finger_friction": 0.02})
    simulator = gripped(friction=0.02, robot=ROBOT.model_copy(update={"simulation": slippery}))
    go(simulator, LIFTED, 70)
    assert simulator.truth.pose("thing").position[2] < 0.85


def test_a_weak_grip_slips_where_a_strong_one_holds() -> None:
    low = 0.12
    assert ROBOT.simulation is not None
    smooth = ROBOT.simulation.model_copy(update={"finger_friction": low})
    robot = ROBOT.model_copy(update={"simulation": smooth})
    lost = {}
    for force in (4.0, FORCE):
        simulator = gripped(CARTON, force=force, friction=low, robot=robot)
        before = hand_from_thing(simulator)
        go(simulator, LIFTED, 70)
        lost[force] = slipped(before, simulator)[0]
    assert lost[4.0] > 0.02 > lost[FORCE]


@pytest.mark.parametrize("part", [CAN, SLIM_CAN, BOTTLE])
def test_the_opening_tells_how_wide_the_thing_is(part: Part) -> None:
    simulator = gripped(part)
    wide = 2 * part.geometry.radius  # type: ignore[union-attr]
    assert simulator.robot.state().gripper_width == pytest.approx(wide, abs=6e-3)


@pytest.mark.parametrize("force", [8.0, 16.0, 25.0])
def test_thumb_and_fingers_press_with_the_force_that_was_asked_for(force: float) -> None:
    simulator = gripped(force=force)
    assert simulator.robot.state().gripper_effort == pytest.approx(force, abs=3.5)
    simulator.truth.watch_contacts()
    simulator.step()
    sides = {"1": np.zeros(3), "23": np.zeros(3)}
    for contact in simulator.truth.contacts():
        if "finger" in contact.first and contact.second == "thing":
            side = "1" if contact.first.endswith("1") else "23"
            sides[side] += contact.force
    assert np.mean([each[0] for each in sides.values()]) == pytest.approx(force, rel=0.25)


def test_the_wrist_feels_the_weight() -> None:
    simulator = gripped()
    go(simulator, LIFTED, 80)
    force, _ = simulator.robot.sensors["wrench"].exact()  # type: ignore[attr-defined]
    assert np.linalg.norm(force) == pytest.approx(CAN_MASS * GRAVITY, abs=0.15)


def test_the_tips_are_straight_until_the_fingers_are_stopped() -> None:
    x, y, z = ROBOT.kinematics().base_from_frame("hand", LOW).position
    away = plain_episode(can_at=(x + 1.0, y, z), stand=True)
    free = Simulator(ROBOT, away, 0, render=False, pose=LOW)
    tips = [f"arm_joint_finger_tip_{i}" for i in (1, 2, 3)]
    for _ in range(8):
        free.robot.command("gripper", GripperCommand(0.06, FORCE))
        free.step()
        assert max(free.truth.joint(tip) for tip in tips) < 0.2
    holding = gripped()
    assert min(holding.truth.joint(tip) for tip in tips) > 0.3


def test_stopping_the_gripper_keeps_its_grip_and_opening_lets_go() -> None:
    simulator = gripped()
    simulator.robot.stop("gripper")
    go(simulator, LIFTED, 70)
    assert simulator.truth.pose("thing").position[2] > 0.92
    for _ in range(40):
        simulator.robot.command("gripper", GripperCommand(ROBOT.end_effector.max_width, FORCE))
        simulator.step()
    assert simulator.truth.pose("thing").position[2] < 0.82
