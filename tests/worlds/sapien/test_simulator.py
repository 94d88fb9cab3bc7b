"""Fetch in physics: it tracks what it is told, stops by itself, and does the same every time."""

from __future__ import annotations

import dataclasses
import math
import subprocess
import sys
import weakref

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.sensors.laser import Laser
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.catalogue.furniture import furniture
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.testing import CAN_HEIGHT, TABLE_HEIGHT, WALL_FACE, plain_episode

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import BaseVelocity, GripperCommand, JointPositions, JointTrajectory

FETCH = fetch()
ARM = FETCH.actuators["arm"].joints


def empty_room(seed: int = 0) -> Simulator:
    """The robot alone with a wall."""
    return Simulator(FETCH, plain_episode(table=False), seed, render=False)


def run(simulator: Simulator, ticks: int, **goals: object) -> None:
    for _ in range(ticks):
        for actuator, goal in goals.items():
            simulator.robot.command(actuator, goal)  # type: ignore[arg-type]
        simulator.step()


def test_the_base_tracks_its_speed_and_the_watchdog_stops_it() -> None:
    simulator = empty_room()
    run(simulator, 60, base=BaseVelocity(0.4, 0.8))
    before = simulator.truth.base()
    run(simulator, 20, base=BaseVelocity(0.4, 0.8))
    after = simulator.truth.base()
    assert (before.inverse() @ after).yaw == pytest.approx(0.8, abs=0.01)
    radius = 0.4 / 0.8
    assert before.distance_to(after) == pytest.approx(2 * radius * math.sin(0.4), abs=0.005)
    state = simulator.robot.state()
    assert (state.linear, state.angular) == pytest.approx((0.4, 0.8), abs=0.04)
    run(simulator, 20)
    resting = simulator.truth.base()
    run(simulator, 10)
    assert simulator.truth.base().distance_to(resting) < 1e-4


def test_a_bump_is_limited_by_the_wheels_force() -> None:
    simulator = empty_room()
    simulator.truth.watch_contacts()
    forces = []
    for _ in range(140):
        run(simulator, 1, base=BaseVelocity(0.5, 0.0))
        forces += [c.force for c in simulator.truth.contacts() if "wall" in (c.first, c.second)]
    assert simulator.truth.base().x < WALL_FACE - 0.25
    pushing = np.mean(forces[-10:])
    assert 200.0 < pushing < 560.0


def test_the_arm_follows_a_trajectory_closely() -> None:
    simulator = empty_room()
    start = np.array([simulator.robot.state().position(name) for name in ARM])
    end = np.array([FETCH.named_poses["carry"][name] for name in ARM])
    duration = 8.0
    times = np.linspace(0.0, duration, 61)
    u = (times / duration)[:, None]
    shape, slope = u**3 * (10 - 15 * u + 6 * u * u), 30 * u**2 * (1 - u) ** 2 / duration
    trajectory = JointTrajectory(ARM, times, start + shape * (end - start), slope * (end - start))
    worst = 0.0
    for tick in range(170):
        run(simulator, 1, arm=trajectory)
        u = min((tick + 1) * 0.05 / duration, 1.0)
        wanted = start + u**3 * (10 - 15 * u + 6 * u * u) * (end - start)
        measured = [simulator.robot.state().position(name) for name in ARM]
        worst = max(worst, float(np.abs(wanted - measured).max()))
    assert worst < 0.01
    assert np.abs(np.array([simulator.robot.state().position(n) for n in ARM]) - end).max() < 2e-3


def test_joint_speed_limits_are_kept_in_physics() -> None:
    simulator = empty_room()
    goal = tuple(FETCH.named_poses["carry"][name] for name in ARM)
    limits = np.array([FETCH.joint_limits[name].velocity for name in ARM])
    fastest = np.zeros(len(ARM))
    for _ in range(80):
        run(simulator, 1, arm=JointPositions(ARM, goal))
        speeds = np.abs(simulator.robot.state().velocities[: len(ARM)])
        fastest = np.maximum(fastest, speeds)
    assert np.all(fastest <= 1.05 * limits + 0.01)
    assert np.any(fastest > 0.5 * limits)


def test_a_blocked_arm_gives_way_before_it_hurts() -> None:
    episode = dataclasses.replace(plain_episode(), start=Pose2D(0.45, 0.3, 0.0))
    low = {**FETCH.named_poses["carry"], "torso_lift_joint": 0.35}
    simulator = Simulator(FETCH, episode, 0, render=False, pose=low)
    simulator.truth.watch_contacts()
    down = JointPositions(("torso_lift_joint",), (0.1,))
    forces = []
    for _ in range(80):
        run(simulator, 1, arm=down)
        hand = [
            c.force for c in simulator.truth.contacts() if c.first in simulator.truth.robot_links
        ]
        forces.append(sum(hand))
    assert max(forces) > 5.0
    assert max(forces) < 150.0
    assert simulator.robot.state().position("torso_lift_joint") > 0.15


@pytest.mark.parametrize(("speed", "most"), [(0.1, 65.0), (0.4, 170.0)])
def test_how_hard_a_straight_arm_hits_a_wall_depends_on_its_speed(
    speed: float, most: float
) -> None:
    """The first is `careful_speed` of the planned arm; a straight one has the most inertia."""
    episode = dataclasses.replace(
        plain_episode(table=False), start=Pose2D(WALL_FACE - 0.9, 0.0, 0.0)
    )
    pose = dict.fromkeys(ARM, 0.0) | {"torso_lift_joint": 0.3, "shoulder_pan_joint": 0.9}
    simulator = Simulator(FETCH, episode, 0, render=False, pose=pose)
    simulator.truth.watch_contacts()
    start = np.array([simulator.robot.state().position(name) for name in ARM])
    forces = [0.0]
    trajectory = swing(start, -0.9, speed)
    for _ in range(int(trajectory.duration / 0.05)):
        run(simulator, 1, arm=trajectory)
        forces += [c.force for c in simulator.truth.contacts() if c.second == "wall"]
    assert 30.0 < max(forces) < most
    assert max(forces[-10:]) < 30.0


def swing(start: np.ndarray, turn: float, speed: float) -> JointTrajectory:
    """The shoulder turns by `turn` rad at a speed, rad/s, between soft ends."""
    duration = 1.875 * abs(turn) / speed
    times = np.linspace(0.0, duration, 200)
    u = times / duration
    shape, slope = u**3 * (10 - 15 * u + 6 * u * u), 30 * u**2 * (1 - u) ** 2 / duration
    way = np.zeros(len(ARM))
    way[ARM.index("shoulder_pan_joint")] = turn
    return JointTrajectory(ARM, times, start + shape[:, None] * way, np.outer(slope, way))


def test_a_closed_hand_feels_nothing_and_an_open_one_has_its_width() -> None:
    simulator = empty_room()
    assert simulator.robot.state().gripper_width == pytest.approx(0.1, abs=3e-3)
    run(simulator, 40, gripper=GripperCommand(0.0, 40.0))
    state = simulator.robot.state()
    assert state.gripper_width < 3e-3
    assert abs(state.gripper_effort) < 8.0


@pytest.mark.parametrize("pose", sorted(FETCH.named_poses))
def test_no_named_pose_makes_links_touch(pose: str) -> None:
    simulator = Simulator(
        FETCH, plain_episode(table=False), 0, render=False, pose=FETCH.named_poses[pose]
    )
    simulator.truth.watch_contacts()
    run(simulator, 10)
    assert simulator.truth.contacts() == ()


def test_two_reads_of_one_instant_are_the_same_object() -> None:
    simulator = empty_room()
    robot = simulator.robot
    assert robot.read("laser") is robot.read("laser")
    assert robot.state() is robot.state()
    first = robot.read("laser")
    simulator.step()
    assert robot.read("laser") is not first


def test_unknown_names_are_answered_with_the_known_ones() -> None:
    simulator = empty_room()
    with pytest.raises(KeyError, match=r"'leg'.*base, arm, head, gripper"):
        simulator.robot.command("leg", BaseVelocity(0, 0))
    with pytest.raises(KeyError, match=r"'radar'.*laser"):
        simulator.robot.read("radar")
    with pytest.raises(KeyError, match=r"'cat'.*wall"):
        simulator.truth.pose("cat")
    with pytest.raises(RuntimeError, match="watch_contacts"):
        simulator.truth.contacts()
    with pytest.raises(ValueError, match="GripperCommand"):
        simulator.robot.command("gripper", BaseVelocity(0, 0))


@pytest.mark.parametrize(
    "goal", [GripperCommand(0.2, 10.0), GripperCommand(-0.1, 10.0), GripperCommand(0.0, 90.0)]
)
def test_the_gripper_refuses_what_it_cannot_do(goal: GripperCommand) -> None:
    with pytest.raises(ValueError, match="the gripper"):
        empty_room().robot.command("gripper", goal)


FINGERPRINT = """
import hashlib
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import plain_episode
from momantu_bt.messages import BaseVelocity, GripperCommand

digest = hashlib.sha256()
simulator = Simulator(fetch(), plain_episode(), 11, render=False)
robot = simulator.robot
for _ in range(60):
    robot.command("base", BaseVelocity(0.6, 0.2))
    robot.command("gripper", GripperCommand(0.0, 30.0))
    simulator.step()
    state = robot.state()
    digest.update(simulator.state_bytes() + state.positions.tobytes() + state.efforts.tobytes())
    digest.update(repr((state.linear, state.gripper_width)).encode())
    digest.update(robot.read("laser").ranges.tobytes() + robot.read("wrench").force.tobytes())
print(digest.hexdigest())
"""


def test_two_processes_do_the_same_bit_for_bit() -> None:
    runs = [
        subprocess.run(
            [sys.executable, "-c", FINGERPRINT], capture_output=True, text=True, check=True
        )
        for _ in range(2)
    ]
    assert len(runs[0].stdout.strip()) == 64
    assert runs[0].stdout == runs[1].stdout


def test_another_seed_measures_differently_but_moves_alike() -> None:
    first, second = empty_room(0), empty_room(1)
    for simulator in (first, second):
        run(simulator, 20, base=BaseVelocity(0.3, 0.1))
    assert first.state_bytes() == second.state_bytes()
    assert not np.array_equal(first.robot.state().positions, second.robot.state().positions)
    assert not np.array_equal(
        first.robot.read("laser").ranges,  # type: ignore[union-attr]
        second.robot.read("laser").ranges,  # type: ignore[union-attr]
    )


def test_a_closed_simulator_is_gone_once_another_is_built() -> None:
    """Also when something that lives on in a circle held it, as a run does."""
    before = empty_room()
    before.itself = before  # type: ignore[attr-defined]
    lives = weakref.ref(before)
    before.close()
    del before
    empty_room()
    assert lives() is None


def test_bodies_come_into_a_running_world_and_leave_it() -> None:
    simulator = empty_room()
    run(simulator, 3)
    laser = simulator.robot.sensors["laser"]
    assert isinstance(laser, Laser)
    free = laser.exact()
    crate = Body("crate", "crate", Transform((1.5, 0.0, 0.0)), furniture("crate"))
    simulator.add(crate)
    assert simulator.added == (crate,)
    assert laser.exact()[len(free) // 2] < free[len(free) // 2] - 0.5
    with pytest.raises(ValueError, match="there is a body 'crate' already"):
        simulator.add(crate)
    simulator.remove("crate")
    assert "crate" not in simulator.truth.bodies
    assert np.array_equal(laser.exact(), free)
    with pytest.raises(KeyError):
        simulator.remove("wall")


def test_a_carried_base_rests_where_it_is_set_down_and_odometry_does_not_know() -> None:
    simulator = empty_room()
    run(simulator, 20, base=BaseVelocity(0.5, 0.0))
    before = simulator.robot.state().odom_from_base
    goal = Pose2D(-1.0, 2.0, 1.0)
    simulator.robot.carry(goal)
    run(simulator, 1)
    assert simulator.truth.base().distance_to(goal) < 0.01
    assert simulator.truth.base_speed() == pytest.approx((0.0, 0.0), abs=0.1)
    after = simulator.robot.state().odom_from_base
    assert np.abs(after.position - before.position).max() < 0.01


def test_what_lies_under_a_point_is_found_and_the_robot_does_not_count() -> None:
    simulator = Simulator(FETCH, plain_episode(), 0, render=False)
    point = np.array([[0.95, 0.0, TABLE_HEIGHT + 0.4]])
    below = simulator.truth.height_below
    assert below("can", point) == (pytest.approx(0.4, abs=1.1e-3), "table_a")
    assert below("other", point) == (pytest.approx(0.4 - CAN_HEIGHT, abs=1e-3), "can")
    assert below("can", np.array([[0.0, 0.0, 2.0]])) == (pytest.approx(2.0, abs=1.1e-3), "floor")
    beside = np.array([[0.95, 0.0, 1.0], [0.2, 1.5, 0.9]])
    assert below("can", beside) == (pytest.approx(1.0 - TABLE_HEIGHT, abs=1.1e-3), "table_a")
