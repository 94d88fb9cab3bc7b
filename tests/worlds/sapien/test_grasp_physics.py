"""A can is held by friction alone: through a lift and a hard stop, and not without friction."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import CAN_HEIGHT, CAN_MASS, CAN_RADIUS, plain_episode

from momantu_bt.geometry import Transform
from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions
from momantu_bt.robot import RobotDescription

FETCH = fetch()
ARM = FETCH.actuators["arm"].joints
LOW = {**FETCH.named_poses["carry"], "torso_lift_joint": 0.2}
LIFTED = JointPositions(ARM, tuple({**LOW, "torso_lift_joint": 0.35}[name] for name in ARM))
GRAVITY = 9.81


@cache
def hand() -> Transform:
    return FETCH.kinematics().base_from_frame("gripper_link", LOW)


def gripped(
    force: float,
    *,
    can_friction: float = 0.8,
    beside: float = 0.0,
    robot: RobotDescription = FETCH,
) -> Simulator:
    """The hand has closed on a can that stood on a post, `beside` m off the middle."""
    x, y, z = hand().position
    bottom = (x + 0.01, y + beside, z - CAN_HEIGHT / 2)
    episode = plain_episode(can_at=bottom, can_friction=can_friction, stand=True)
    simulator = Simulator(robot, episode, 0, render=False, pose=LOW)
    for _ in range(25):
        simulator.robot.command("gripper", GripperCommand(0.0, force))
        simulator.step()
    return simulator


def hand_from_can(simulator: Simulator) -> Transform:
    return simulator.truth.link("gripper_link").inverse() @ simulator.truth.pose("can")


def lift(simulator: Simulator) -> None:
    for _ in range(45):
        simulator.robot.command("arm", LIFTED)
        simulator.step()


def test_a_can_is_centred_lifted_and_kept_through_a_hard_stop() -> None:
    simulator = gripped(40.0, beside=0.01)
    before = hand_from_can(simulator)
    assert abs(before.position[1]) < 2e-3
    lift(simulator)
    for speed in (-0.9, 0.0):
        for _ in range(30):
            simulator.robot.command("base", BaseVelocity(speed, 0.0))
            simulator.step()
    after = hand_from_can(simulator)
    assert np.abs(after.position - before.position).max() < 2e-3
    assert after.angle_to(before) < math.radians(1.0)
    assert simulator.truth.pose("can").position[2] > hand().position[2] + 0.1


def test_width_effort_and_wrench_tell_of_the_can() -> None:
    simulator = gripped(40.0)
    robot = simulator.robot
    empty = robot.read("wrench")
    assert robot.state().gripper_width == pytest.approx(2 * CAN_RADIUS, abs=3e-3)
    assert robot.state().gripper_effort == pytest.approx(40.0, abs=5.0)
    lift(simulator)
    force, _ = robot.sensors["wrench"].exact()  # type: ignore[attr-defined]
    assert np.linalg.norm(force) == pytest.approx(CAN_MASS * GRAVITY, abs=0.1)
    assert force[2] < -0.9 * CAN_MASS * GRAVITY
    measured = robot.read("wrench")
    change = np.linalg.norm(measured.force - empty.force)  # type: ignore[union-attr]
    assert change > 0.5 * CAN_MASS * GRAVITY


@pytest.mark.parametrize("force", [15.0, 40.0])
def test_the_pads_press_with_the_force_that_was_asked_for(force: float) -> None:
    simulator = gripped(force)
    simulator.truth.watch_contacts()
    simulator.step()
    pads = [c.force for c in simulator.truth.contacts() if "finger" in c.first]
    assert len(pads) == 2
    assert np.mean(pads) == pytest.approx(force, rel=0.15)


def test_without_friction_the_can_slips() -> None:
    assert FETCH.simulation is not None
    slippery = FETCH.simulation.model_copy(update={"finger_friction": 0.02})
    robot = FETCH.model_copy(update={"simulation": slippery})
    simulator = gripped(40.0, can_friction=0.02, robot=robot)
    lift(simulator)
    assert simulator.truth.pose("can").position[2] < hand().position[2] + 0.05


def test_stopping_the_gripper_keeps_its_grip() -> None:
    simulator = gripped(40.0)
    simulator.robot.stop("gripper")
    lift(simulator)
    assert simulator.truth.pose("can").position[2] > hand().position[2] + 0.1
    assert simulator.robot.state().gripper_effort > 30.0


def pressed(simulator: Simulator) -> np.ndarray:
    """Directions (n, 3) in which pads press on the can, each in the hand's frame."""
    world_from_hand = simulator.truth.link("gripper_link").matrix[:3, :3]
    found = [
        np.sum([point.impulse for point in contact.points], axis=0)
        for contact in simulator.scene.get_contacts()
        if "can" in (names := [body.entity.name for body in contact.bodies])
        and any("finger" in name for name in names)
    ]
    return np.array([world_from_hand.T @ each / np.linalg.norm(each) for each in found])


def test_a_hand_that_turns_presses_along_its_own_axes() -> None:
    simulator = gripped(60.0)
    lift(simulator)
    before = hand_from_can(simulator)
    for tick in range(100):
        simulator.robot.command("base", BaseVelocity(0.0, 1.2 if tick < 70 else 0.0))
        simulator.step()
        if tick == 60:
            along = pressed(simulator)
            assert len(along) == 2
            assert np.abs(along[:, 1]).min() > math.cos(math.radians(2.0))
    after = hand_from_can(simulator)
    assert np.abs(after.position - before.position).max() < 1e-3
    assert after.angle_to(before) < math.radians(1.0)
