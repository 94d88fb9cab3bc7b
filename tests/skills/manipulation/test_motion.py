"""Following trajectories, feeling contacts, judging pictures and the age of poses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from momantu_skills.manipulation.config import HandConfig
from momantu_skills.manipulation.hand.freshness import check_fresh
from momantu_skills.manipulation.hand.gripper import bump, move_gripper
from momantu_skills.manipulation.hand.verification import standing, stands_there
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import CollisionWorld, Obstacle, body_pairs
from momantu_skills.manipulation.motion.following import brake, expected, follow
from momantu_skills.manipulation.motion.planner import escape

from momantu_bt.failure import Failure
from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject, JointTrajectory
from tests.skills.scenery.table import Tabletop

Swing = tuple[Tabletop, JointTrajectory]
CAN = DetectedObject(
    "can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 0.9, 0.7
)


def run(generator: Any, robot: Any, each: Callable[[], None] | None = None) -> Any:
    """Let a generator run, one tick of the robot's time per yield; what it returns."""
    while True:
        try:
            next(generator)
        except StopIteration as end:
            return end.value
        robot.advance(0.05)
        if each is not None:
            each()


def test_it_arrives_and_rests(swing: Swing) -> None:
    robot, trajectory = swing
    assert run(follow(robot, robot, "arm", trajectory), robot) is True
    names = trajectory.names
    assert [robot.joints[n] for n in names] == pytest.approx(trajectory.positions[-1], abs=1e-6)
    assert robot.now() < trajectory.duration + 0.3


def test_the_same_trajectory_is_commanded_each_tick(swing: Swing) -> None:
    robot, trajectory = swing
    run(follow(robot, robot, "arm", trajectory), robot)
    times = [time for time, actuator, goal in robot.commands if goal is trajectory]
    assert len(times) >= trajectory.duration / 0.05
    assert np.diff(times).max() < 0.06


def test_an_arm_that_stays_behind_is_stuck_and_stopped(swing: Swing) -> None:
    robot, trajectory = swing
    robot.frozen.add("arm")
    with pytest.raises(Failure) as caught:
        run(follow(robot, robot, "arm", trajectory), robot)
    assert caught.value.code == "ARM_STUCK"
    assert caught.value.value.data["joint"] == "shoulder_pan_joint"
    assert robot.commands[-1] == (pytest.approx(robot.now()), "arm", None)


@pytest.mark.parametrize("pace", [0.3, 0.5, 0.8])
def test_an_arm_slower_than_its_trajectory_is_waited_for(swing: Swing, pace: float) -> None:
    robot, trajectory = swing
    command = robot.command
    times, speeds = trajectory.times / pace, trajectory.velocities * pace
    late = replace(trajectory, times=times, velocities=speeds)

    def slow(actuator: str, goal: Any) -> None:
        command(actuator, late if goal is trajectory else goal)

    robot.command = slow
    assert run(follow(robot, robot, "arm", trajectory), robot) is True
    names = trajectory.names
    assert [robot.joints[n] for n in names] == pytest.approx(trajectory.positions[-1], abs=0.02)
    assert robot.now() > 0.9 * trajectory.duration / pace


@pytest.mark.parametrize("share", [0.2, 0.5, 0.7])
def test_an_arm_that_stops_on_its_way_is_stuck_soon(swing: Swing, share: float) -> None:
    robot, trajectory = swing
    stops = share * trajectory.duration

    def hold() -> None:
        if robot.now() >= stops:
            robot.frozen.add("arm")

    with pytest.raises(Failure, match="ARM_STUCK"):
        run(follow(robot, robot, "arm", trajectory), robot, hold)
    assert robot.now() < trajectory.duration + 2.0


def test_an_arm_that_trembles_in_place_does_not_get_on(swing: Swing) -> None:
    robot, trajectory = swing
    robot.frozen.add("arm")
    random = np.random.default_rng(3)

    def tremble() -> None:
        robot.joints["shoulder_pan_joint"] += float(random.normal(0.0, 0.002))

    with pytest.raises(Failure, match="ARM_STUCK"):
        run(follow(robot, robot, "arm", trajectory), robot, tremble)
    assert robot.now() < trajectory.duration + 2.0


def test_a_watch_ends_it_early(swing: Swing) -> None:
    robot, trajectory = swing
    watched = follow(robot, robot, "arm", trajectory, until=lambda _: robot.now() > 0.5)
    assert run(watched, robot) is False
    assert robot.now() < 1.0
    assert robot.joints["shoulder_pan_joint"] < trajectory.positions[-1][1] - 0.1


def test_braking_ends_though_the_arm_never_rests(swing: Swing) -> None:
    robot, trajectory = swing
    robot.command("arm", trajectory)

    def shake() -> None:
        robot.joints["shoulder_pan_joint"] += 0.01

    run(brake(robot, robot, "arm"), robot, shake)
    assert robot.now() < 2.0


def test_expected_meets_the_points_and_stays_at_the_ends(swing: Swing) -> None:
    _, trajectory = swing
    for i, time in enumerate(trajectory.times):
        assert expected(trajectory, time) == pytest.approx(trajectory.positions[i])
    assert expected(trajectory, -1.0) == pytest.approx(trajectory.positions[0])
    assert expected(trajectory, 99.0) == pytest.approx(trajectory.positions[-1])


@pytest.mark.parametrize(("thing", "rests_at"), [(None, 0.04), (0.07, 0.07)])
def test_closing_ends_at_the_width_or_on_the_thing(
    tabletop: type[Tabletop], thing: float | None, rests_at: float
) -> None:
    robot = tabletop(can=None)
    robot.object_width = thing
    reached = run(move_gripper(robot, robot, 0.04, 45.0, 3.0, "closing"), robot)
    assert reached == pytest.approx(rests_at, abs=0.002)
    assert robot.now() < 1.5


def test_opening_waits_while_the_force_is_let_go(tabletop: type[Tabletop]) -> None:
    robot = tabletop(can=None)
    robot.gripper_width, robot.gripper_effort = 0.07, 45.0
    robot.frozen.add("gripper")

    def later() -> None:
        if robot.now() > 0.6:
            robot.frozen.clear()

    reached = run(move_gripper(robot, robot, 0.1, 45.0, 3.0, "opening"), robot, later)
    assert reached == pytest.approx(0.1, abs=0.006)


def test_only_an_upward_change_is_contact_from_below(tabletop: type[Tabletop]) -> None:
    robot = tabletop(pose="carry")
    frames = FrameBuffer(robot.description.kinematics())
    frames.add_state(robot.state())
    robot.hold(Transform())
    light, heavy = np.array([0.0, 0.0, -9.9]), np.array([0.0, 0.0, 2.0])
    for rest, felt in ((light, True), (heavy, False)):
        watch = bump(frames, rest, 5.0, vertical=True)
        assert watch is not None
        assert watch(robot) is felt
    assert bump(frames, heavy, 5.0)(robot)  # type: ignore[misc]
    assert bump(frames, None, 5.0) is None


def moved(points: np.ndarray, x: float = 0.0, z: float = 0.0) -> np.ndarray:
    return Transform((x, 0.0, z)).apply(points)


def can_points(upright: bool = True) -> np.ndarray:
    """Points on a can that stands or lies at the origin of a table 0.7 m high."""
    turn = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    ring = np.stack([0.035 * np.cos(turn), 0.035 * np.sin(turn)], axis=1)
    rows = [np.column_stack([ring, np.full(20, z)]) for z in np.linspace(-0.065, 0.065, 14)]
    points = np.vstack(rows)
    return moved(points, z=0.765) if upright else moved(points[:, [2, 1, 0]], z=0.735)


def test_what_a_picture_says_of_a_spot() -> None:
    pose = Transform((0.0, 0.0, 0.765))
    assert standing(can_points(), pose, CAN, 0.7) == "there"
    assert standing(can_points(upright=False), pose, CAN, 0.7) == "toppled"
    assert standing(np.empty((0, 3)), pose, CAN, 0.7) == "gone"
    assert standing(moved(can_points(), x=0.5), pose, CAN, 0.7) == "gone"
    assert stands_there(can_points(), pose, CAN, 0.7)
    assert not stands_there(moved(can_points(), x=0.2), pose, CAN, 0.7)


@pytest.mark.parametrize(
    ("frame", "stamp", "says"),
    [("map", 99.0, "'odom'"), ("odom", 10.0, "90 s ago"), ("odom", 94.0, "last touched")],
)
def test_what_makes_a_pose_stale(frame: str, stamp: float, says: str) -> None:
    pose = Pose(Transform(), frame, stamp)
    with pytest.raises(Failure, match=says) as caught:
        check_fresh(pose, "can", 100.0, 95.0, HandConfig())
    assert caught.value.code == "STALE_POSE"


@pytest.mark.parametrize(("age", "stale"), [(0.0, False), (59.9, False), (60.1, True)])
@pytest.mark.parametrize(("since_contact", "touched"), [(0.0, False), (0.1, False), (-0.1, True)])
def test_a_pose_goes_stale_with_time_and_with_contact(
    age: float, stale: bool, since_contact: float, touched: bool
) -> None:
    """since_contact: s from the last contact to the picture that the pose is from."""
    now = 100.0
    pose = Pose(Transform(), "odom", now - age)
    refused = False
    try:
        check_fresh(pose, "can", now, pose.stamp - since_contact, HandConfig())
    except Failure:
        refused = True
    assert refused is (stale or touched)


def test_an_escape_leaves_and_touches_nothing_new(
    model: ArmModel, tabletop: type[Tabletop]
) -> None:
    robot = tabletop(pose="carry")
    q = model.joints(robot.state())
    hand = model.group.tip_pose(q).position
    low, high = hand - (0.13, 0.06, 0.3), hand - (0.05, -0.06, 0.046)
    corners = np.array(list(product(*zip(low, high, strict=True))))
    shelf, body = Obstacle("shelf", corners), body_pairs(model)
    full = model.configuration(robot.state())
    world = CollisionWorld(body, full, [shelf], margin=0.012)
    bare = CollisionWorld(body, full, [shelf])
    assert not world.free(q)
    path = escape(model.group, q, world, bare, np.random.default_rng(0))
    assert path is not None
    assert world.free(path[-1])
    assert bare.path_free(path)


def test_there_is_no_escape_from_a_closed_box(model: ArmModel, tabletop: type[Tabletop]) -> None:
    robot = tabletop(pose="carry")
    q = model.joints(robot.state())
    hand = model.group.tip_pose(q).position
    cube = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    block = Obstacle("block", hand + 0.5 * cube)
    world = CollisionWorld(body_pairs(model), model.configuration(robot.state()), [block])
    assert escape(model.group, q, world, world, np.random.default_rng(0)) is None
