"""The scripted robot behaves as a driver does, as far as it claims to."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.failure import Failure
from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions, JointTrajectory
from momantu_bt.robot import REQUIRED_POSES, WATCHDOG
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, small_robot
from momantu_bt.world import TICK


def drive(robot, goal, ticks, actuator="base"):
    for _ in range(ticks):
        robot.command(actuator, goal)
        robot.advance(TICK)


@given(linear=st.floats(-2, 2), angular=st.floats(-3, 3))
def test_the_base_keeps_its_limits(linear, angular):
    robot = ScriptedRobot()
    limits = robot.description.base
    before = 0.0
    for _ in range(60):
        drive(robot, BaseVelocity(linear, angular), 1)
        assert abs(robot.linear - before) <= limits.linear_acceleration * TICK + 1e-12
        assert abs(robot.linear) <= limits.linear + 1e-12
        assert abs(robot.angular) <= limits.angular + 1e-12
        before = robot.linear


def test_the_base_drives_where_it_looks():
    robot = ScriptedRobot()
    drive(robot, BaseVelocity(0.0, math.pi / 2), 40)
    drive(robot, BaseVelocity(0.5, 0.0), 40)
    assert robot.base.y > 0.5 or robot.base.x < -0.5
    assert robot.state().odom_from_base.yaw == pytest.approx(robot.base.yaw)


@pytest.mark.parametrize("actuator", ["base", "head"])
def test_nothing_moves_long_after_the_last_command(actuator):
    robot = ScriptedRobot()
    goal = {"base": BaseVelocity(0.2, 0.0), "head": JointPositions(("pan",), (1.4,))}[actuator]
    drive(robot, goal, 5, actuator)
    for _ in range(round(WATCHDOG / TICK) + 6):
        robot.advance(TICK)
    still = robot.state()
    robot.advance(1.0)
    assert robot.linear == 0.0
    assert np.array_equal(robot.state().positions, still.positions)


def test_a_trajectory_is_followed_while_it_is_commanded():
    robot = ScriptedRobot()
    goal = JointTrajectory(
        ("shoulder", "elbow"),
        np.array([0.0, 1.0]),
        np.array([[0.0, 0.0], [0.5, -0.5]]),
        np.zeros((2, 2)),
    )
    drive(robot, goal, 10, "arm")
    assert robot.joints["shoulder"] == pytest.approx(0.25)
    drive(robot, goal, 15, "arm")
    assert robot.joints["elbow"] == pytest.approx(-0.5)
    assert robot.state().position("lift") == 0.0


def test_the_gripper_stops_at_what_it_holds_and_keeps_its_force():
    robot = ScriptedRobot()
    robot.object_width = 0.07
    drive(robot, GripperCommand(0.0, 30.0), 20, "gripper")
    assert robot.gripper_width == pytest.approx(0.07)
    assert robot.gripper_effort == 30.0
    robot.stop("gripper")
    robot.advance(5.0)
    assert robot.gripper_effort == 30.0


def test_what_is_frozen_does_not_move():
    robot = ScriptedRobot()
    robot.frozen.add("head")
    drive(robot, JointPositions(("pan",), (1.0,)), 20, "head")
    assert robot.joints["pan"] == 0.0


@pytest.mark.parametrize(
    ("actuator", "goal", "error", "words"),
    [
        ("wings", BaseVelocity(0, 0), KeyError, "actuators: base"),
        ("arm", BaseVelocity(0, 0), ValueError, "JointTrajectory or JointPositions"),
        ("head", JointPositions(("lift",), (0.1,)), ValueError, "does not move lift"),
        ("head", JointPositions(("pan",), (3.0,)), ValueError, "limits"),
    ],
)
def test_goals_that_a_driver_cannot_take(actuator, goal, error, words):
    robot = ScriptedRobot()
    with pytest.raises(error, match=words):
        robot.command(actuator, goal)
    assert robot.commands == []


def test_sensors_answer_what_is_scripted():
    robot = ScriptedRobot(readings={"laser": lambda r: r.now()})
    robot.advance(0.5)
    assert robot.read("laser") == 0.5
    with pytest.raises(KeyError, match="scripted no reading"):
        robot.read("camera")
    with pytest.raises(KeyError, match="sensors: camera, laser, wrench"):
        robot.read("sonar")
    robot.dead.add("laser")
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        robot.read("laser")


def test_the_small_robot_has_what_every_robot_has():
    description = small_robot()
    assert set(REQUIRED_POSES) <= set(description.named_poses)
    frames = description.kinematics().frames()
    assert description.camera()[1].frame in frames
    assert description.end_effector.frame in frames


def test_a_scripted_world_scripts_what_happens():
    seen = []
    world = ScriptedWorld(on_step=lambda robot: seen.append(robot.now()))
    world.step()
    world.step()
    assert seen == pytest.approx([0.05, 0.1])
    assert world.verdict() is None
