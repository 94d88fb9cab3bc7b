"""Faults at the robot's boundary: outside of their time nothing is changed, in it what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from momantu_bt.engine.encode import encode
from momantu_bt.failure import Failure
from momantu_bt.fault import FaultError
from momantu_bt.faults.effects.robot import LAYERS, layer
from momantu_bt.faults.effects.robot.odometry import OdometryLayer
from momantu_bt.faults.spec import parse_fault
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import (
    BaseVelocity,
    CameraImage,
    GripperCommand,
    JointPositions,
    JointTrajectory,
    LaserScan,
)
from momantu_bt.robot import CameraSensor
from momantu_bt.testing import ExampleWorld, ScriptedRobot, small_robot
from momantu_bt.world import TICK, seeded

ARM = ("lift", "shoulder", "elbow")
SPEED = BaseVelocity(0.4, 0.3)
GRIP = GripperCommand(0.02, 40.0)


def trajectory(start=(0.0, 0.0, 0.0), end=(0.1, 0.5, -0.5), seconds=2.0):
    positions = np.array([start, end])
    return JointTrajectory(ARM, np.array([0.0, seconds]), positions, np.zeros((2, 3)))


def goals():
    return [
        ("base", SPEED),
        ("arm", trajectory()),
        ("head", JointPositions(("pan", "tilt"), (0.1, 0.2))),
        ("gripper", GRIP),
    ]


@pytest.fixture
def world():
    made = ExampleWorld(seed=3)
    yield made
    made.close()


def broken(text, robot, seed=1):
    return layer(robot, parse_fault(text), seed)


def passed(robot):
    """What the robot was commanded since the last look, without the time."""
    said = [(actuator, goal) for _, actuator, goal in robot.commands]
    robot.commands.clear()
    return said


def told(robot):
    """All that the robot tells at this instant, as bytes."""
    names = robot.description.sensors
    return encode((robot.state(), tuple(robot.read(name) for name in names)))


@pytest.mark.parametrize("name", sorted(LAYERS))
def test_outside_of_its_time_it_is_the_robot(world, name):
    inner = world.robot
    robot = broken(name, inner)
    for act in (lambda: None, robot.begin, robot.end):
        act()
        if robot.active:
            inner.advance(10 * TICK)
            continue
        inner.commands.clear()
        for actuator, goal in goals():
            robot.command(actuator, goal)
            robot.stop(actuator)
        wanted = [
            pair for actuator, goal in goals() for pair in ((actuator, goal), (actuator, None))
        ]
        for (actuator, got), (expected, goal) in zip(passed(inner), wanted, strict=True):
            assert actuator == expected
            assert encode(got) == encode(goal)
        inner.command("base", SPEED)
        inner.advance(TICK)
        if issubclass(LAYERS[name], OdometryLayer) and inner.time > 5 * TICK:
            assert robot.state().linear == inner.state().linear  # where it believes to be has moved
        else:
            assert told(robot) == told(inner)


@pytest.mark.parametrize("name", sorted(LAYERS))
def test_two_looks_at_one_instant_agree_and_a_repetition_gives_the_same(name):
    seen = []
    for seed in (1, 1, 2):
        world = ExampleWorld(seed=3)
        robot = broken(name, world.robot, seed)
        robot.begin()
        tale = []
        for _ in range(2):
            robot.command("base", SPEED)
            world.robot.advance(TICK)
            try:
                tale.append(told(robot))
                assert told(robot) == tale[-1]
            except Failure as failure:
                tale.append(failure.code.encode())
        seen.append(tale)
        world.close()
    assert seen[0] == seen[1]
    assert (seen[0] != seen[2]) is (name in ("camera.noisier", "camera.shifted"))


def test_dead_sensors_name_themselves(world):
    for name, sensor in (("camera.dead", "camera"), ("laser.dead", "laser")):
        robot = broken(name, world.robot)
        robot.begin()
        with pytest.raises(Failure) as caught:
            robot.read(sensor)
        assert caught.value.code == "SENSOR_DEAD"
        assert caught.value.value.data["sensor"] == sensor
        robot.read("wrench")


@pytest.mark.parametrize(
    ("name", "sensor"), [("camera.frozen", "camera"), ("laser.stuck", "laser")]
)
def test_repeating_sensors_give_the_reading_of_the_begin_with_new_stamps(world, name, sensor):
    robot = broken(name, world.robot)
    before = world.robot.read(sensor)
    robot.begin()
    for _ in range(3):
        world.robot.command("base", SPEED)
        world.robot.advance(0.2)
        reading = robot.read(sensor)
        assert reading.stamp == world.robot.time
        field = "depth" if isinstance(reading, CameraImage) else "ranges"
        assert np.array_equal(getattr(reading, field), getattr(before, field))
        assert not np.array_equal(getattr(reading, field), getattr(world.robot.read(sensor), field))


def test_dark_biased_and_noisier_pictures(world):
    bare = world.robot.read("camera")
    measured = bare.depth > 0.0
    dark = _picture("camera.dark:gain=0.1", world)
    assert dark.color.max() <= 0.1 * bare.color.max()
    assert np.array_equal(dark.depth, bare.depth)
    biased = _picture("camera.biased:scale=1.1,offset=2 cm", world)
    assert np.allclose(biased.depth[measured], 1.1 * bare.depth[measured] + 0.02, atol=1e-5)
    assert not biased.depth[~measured].any()
    noisy = _picture("camera.noisier:depth=0.01,color=20", world)
    error = (noisy.depth - bare.depth)[measured] / bare.depth[measured] ** 2
    assert 0.008 < error.std() < 0.012
    assert abs(error.mean()) < 0.001
    assert 5.0 < np.abs(noisy.color.astype(float) - bare.color).mean() < 20.0
    assert not noisy.depth[~measured].any()
    assert not noisy.depth.flags.writeable


def _picture(text, world):
    robot = broken(text, world.robot)
    robot.begin()
    return robot.read("camera")


def _plane_picture(robot, normal, distance, turned=None):
    """What a camera sees of the plane normal . x = distance (optical frame), colour by place.

    turned: the rotation (3, 3) of the camera, whose optical frame is meant by everything else.
    """
    camera = next(s for s in robot.description.sensors.values() if isinstance(s, CameraSensor))
    focal = camera.width / 2 / math.tan(camera.horizontal_fov / 2)
    middle = ((camera.width - 1) / 2, (camera.height - 1) / 2)
    K = np.array([[focal, 0, middle[0]], [0, focal, middle[1]], [0, 0, 1.0]])
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(K).T
    rays = rays if turned is None else rays @ turned.T
    along = distance / (rays @ normal)
    places = rays * along[..., None]
    color = np.clip(100 + 50 * places, 0, 255).astype(np.uint8)
    depth = (along if turned is None else (places @ turned)[..., 2]).astype(np.float32)
    return CameraImage(robot.time, camera.frame, color, depth, K)


@pytest.mark.parametrize("seed", range(5))
def test_a_shifted_picture_is_what_the_turned_camera_sees(seed):
    """Of a plane the turned camera's picture is known exactly."""
    turn = 0.1
    normal, distance = np.array([0.1, -0.2, 1.0]), 2.0
    inner = ScriptedRobot()
    inner.readings["camera"] = lambda robot: _plane_picture(robot, normal, distance)
    robot = broken(f"camera.shifted:turn={turn}", inner, seed)
    robot.begin()
    heading = seeded(seed, "camera.shifted", "camera").uniform(0.0, 2.0 * math.pi)
    x, y = math.cos(heading), math.sin(heading)
    cross = np.array([[0, 0, y], [0, 0, -x], [-y, x, 0]])
    # Rodrigues' formula, by hand
    turned = np.eye(3) + math.sin(turn) * cross + (1 - math.cos(turn)) * cross @ cross
    expected = _plane_picture(inner, normal, distance, turned)
    got = robot.read("camera")
    seen = got.depth > 0.0
    assert 0.5 < seen.mean() < 1.0
    assert np.abs(got.depth - expected.depth)[seen].max() < 0.05
    assert np.abs(got.depth - expected.depth)[seen].mean() < 0.01
    assert np.abs(got.color[seen].astype(int) - expected.color[seen]).max() <= 3
    assert not got.color[~seen].any()
    assert np.abs(got.depth - inner.read("camera").depth)[seen].mean() > 0.03


def test_a_blocked_laser_gives_its_least_range_in_the_sector_alone(world):
    robot = broken("laser.blocked:at=90 deg,width=20 deg", world.robot)
    robot.begin()
    scan, bare = robot.read("laser"), world.robot.read("laser")
    assert isinstance(scan, LaserScan)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    inside = np.abs(np.degrees(angles) - 90) <= 10
    assert inside.any()
    assert (scan.ranges[inside] == scan.range_min).all()
    assert np.array_equal(scan.ranges[~inside], bare.ranges[~inside])


def _drive(robot, inner, ticks):
    """Drive an arc; the believed and true motion over it, each in the frame of its begin."""
    begin = [Pose2D.from_transform(r.state().odom_from_base) for r in (robot, inner)]
    for _ in range(ticks):
        robot.command("base", SPEED)
        inner.advance(TICK)
        robot.state()
    ends = [Pose2D.from_transform(r.state().odom_from_base) for r in (robot, inner)]
    return [b.inverse() @ e for b, e in zip(begin, ends, strict=True)]


def test_slipping_wheels_count_more_and_what_they_counted_stays():
    inner = ScriptedRobot()
    robot = broken("odometry.slip:scale=1.5", inner)
    _drive(robot, inner, 40)
    robot.begin()
    believed, true = _drive(robot, inner, 20)
    assert believed.yaw == pytest.approx(1.5 * true.yaw, rel=1e-6)
    arc = 0.4 / 0.3  # radius of the arc, the same for both
    assert math.hypot(believed.x, believed.y) == pytest.approx(
        2 * arc * math.sin(believed.yaw / 2), rel=0.5
    )
    assert robot.state().linear == pytest.approx(1.5 * inner.state().linear)
    jump = robot.state().odom_from_base
    robot.end()
    assert np.allclose(robot.state().odom_from_base.position, jump.position)
    believed, true = _drive(robot, inner, 20)
    assert (believed.x, believed.y, believed.yaw) == pytest.approx((true.x, true.y, true.yaw))


def test_biased_odometry_turns_only_while_the_base_moves():
    inner = ScriptedRobot()
    robot = broken("odometry.bias:rate=0.1", inner)
    robot.begin()
    for _ in range(20):
        inner.advance(TICK)
        robot.state()
    assert robot.state().odom_from_base.yaw == 0.0
    believed, true = _drive(robot, inner, 40)
    assert believed.yaw - true.yaw == pytest.approx(0.1 * 40 * TICK, rel=1e-6)
    assert robot.state().angular == pytest.approx(inner.state().angular + 0.1)


@pytest.mark.parametrize(
    ("name", "actuator", "goal"),
    [
        ("base.stuck", "base", SPEED),
        ("arm.stuck", "arm", trajectory()),
        ("gripper.stuck", "gripper", GRIP),
    ],
)
def test_what_is_stuck_stays_where_it_is_and_moves_again_afterwards(name, actuator, goal):
    inner = ScriptedRobot()
    robot = broken(name, inner)

    def at():
        state = inner.state()
        pose = Pose2D.from_transform(state.odom_from_base)
        return pose.x, pose.yaw, *state.positions, state.gripper_width

    def move(ticks):
        for _ in range(ticks):
            robot.command(actuator, goal)
            inner.advance(TICK)

    move(4)
    robot.begin()
    inner.advance(1.0)  # to brake
    before = at()
    move(20)
    assert at() == before
    robot.end()
    move(20)
    assert at() != before


def test_a_gripper_that_sticks_while_it_holds_goes_on_pressing():
    inner = ScriptedRobot()
    inner.object_width = 0.05
    robot = broken("gripper.stuck", inner)
    for _ in range(20):
        robot.command("gripper", GRIP)
        inner.advance(TICK)
    robot.begin()
    robot.command("gripper", GripperCommand(0.1, 40.0))
    inner.advance(1.0)
    assert inner.state().gripper_effort == GRIP.max_force
    assert inner.state().gripper_width == pytest.approx(0.05)


def test_slow_and_pulling_bases():
    inner = ScriptedRobot()
    slow = broken("base.slow:factor=0.5", inner)
    slow.begin()
    slow.command("base", SPEED)
    pulling = broken("base.offset:curvature=1.0", inner)
    pulling.begin()
    pulling.command("base", SPEED)
    pulling.command("base", BaseVelocity(1.0, 1.4))
    pulling.command("base", BaseVelocity(0.0, 0.4))
    assert [goal for _, goal in passed(inner)] == [
        BaseVelocity(0.2, 0.15),
        BaseVelocity(0.4, 0.7),
        BaseVelocity(1.0, 1.5),
        BaseVelocity(0.0, 0.4),
    ]


def test_a_slow_arm_stretches_a_trajectory_once_and_keeps_what_has_begun():
    inner = ScriptedRobot()
    robot = broken("arm.slow:factor=0.5", inner)
    begun, later = trajectory(), trajectory((0.1, 0.5, -0.5), (0.0, 0.0, 0.0))
    robot.command("arm", begun)
    robot.begin()
    robot.command("arm", begun)
    for _ in range(3):
        robot.command("arm", later)
    robot.end()
    robot.command("arm", later)
    robot.command("arm", begun)
    sent = [goal for _, goal in passed(inner)]
    assert sent[0] is sent[1] is begun
    stretched = sent[2]
    assert stretched.duration == 2 * later.duration
    assert np.array_equal(stretched.positions, later.positions)
    assert all(goal is stretched for goal in sent[2:6])
    assert sent[6] is begun


def test_an_arm_that_is_offset_arrives_elsewhere_than_it_says():
    inner = ScriptedRobot()
    robot = broken("arm.offset:by=5 deg,joint=shoulder", inner)
    robot.begin()
    by = math.radians(5)
    assert robot.state().position("shoulder") == pytest.approx(by)
    start = tuple(robot.state().position(name) for name in ARM)
    goal = trajectory(start, (0.1, 0.8, -0.5))
    for _ in range(60):
        robot.command("arm", goal)
        inner.advance(TICK)
    assert robot.state().position("shoulder") == pytest.approx(0.8)
    assert inner.state().position("shoulder") == pytest.approx(0.8 - by)
    assert inner.state().position("elbow") == pytest.approx(-0.5)
    robot.command("arm", trajectory((0.1, 0.8, -0.5), (0.1, -1.6, -0.5)))
    assert inner.commands[-1][2].positions[1, 1] == -1.6  # the joint's own limit
    assert robot.joint == "shoulder"
    assert broken("arm.offset", inner).joint == "shoulder"  # lift does not turn


def test_weak_and_slipping_grippers():
    inner = ScriptedRobot()
    weak = broken("gripper.weak:factor=0.25", inner)
    weak.begin()
    weak.command("gripper", GRIP)
    assert passed(inner) == [("gripper", GripperCommand(0.02, 10.0))]
    inner.object_width = 0.05
    slipping = broken("gripper.slips:force=2 N", inner)
    for _ in range(20):
        slipping.command("gripper", GRIP)
        inner.advance(TICK)
    passed(inner)
    slipping.begin()
    slipping.command("gripper", GRIP)
    weakened = ("gripper", GripperCommand(0.02, 2.0))
    assert passed(inner) == [weakened, weakened]
    opening = GripperCommand(0.1, 40.0)
    for goal in (opening, GRIP):
        slipping.command("gripper", goal)
    assert passed(inner) == [("gripper", opening), ("gripper", GRIP)]


def test_layers_on_layers(world):
    robot = broken("camera.dark:gain=0", broken("camera.biased:scale=2", world.robot))
    bare = world.robot.read("camera")
    robot.inner.begin()
    robot.begin()
    both = robot.read("camera")
    assert not both.color.any()
    assert np.allclose(both.depth, 2 * bare.depth)


def test_what_a_robot_lacks_cannot_break():
    bare = small_robot().model_copy(update={"sensors": {}})
    for name in ("camera.dead", "laser.blocked"):
        with pytest.raises(FaultError, match=r"on small: the robot has no (camera|laser).*none"):
            broken(name, ScriptedRobot(bare))
    with pytest.raises(FaultError, match="no joint 'nose'; it has: lift, shoulder, elbow"):
        broken("arm.offset:joint=nose", ScriptedRobot())
    armless = small_robot().model_copy(update={"actuators": {}})
    for name in ("base.slow", "arm.stuck", "gripper.weak"):
        with pytest.raises(
            FaultError, match=r"the robot has no (base|arm|gripper); its actuators: none"
        ):
            broken(name, ScriptedRobot(armless))
