"""A sensor that repeats itself while the robot moves, or is covered, is as good as dead."""

from __future__ import annotations

import numpy as np
import pytest

from momantu_bt.engine.skills.actuators import Actuators
from momantu_bt.engine.skills.sensor_check import same
from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import CameraImage, LaserScan
from momantu_bt.testing import ScriptedRobot


def scan(stamp: float, first: float = 1.0, rest: float = 2.0) -> LaserScan:
    ranges = np.full(10, rest)
    ranges[0] = first
    return LaserScan(stamp, "laser", -1.0, 0.2, 0.05, 10.0, ranges)


def picture(stamp: float, depth: float = 1.0, color: int = 9) -> CameraImage:
    shape = (4, 6)
    return CameraImage(
        stamp,
        "camera",
        np.full((*shape, 3), color, np.uint8),
        np.full(shape, depth, np.float32),
        np.eye(3),
    )


@pytest.fixture
def robot():
    return ScriptedRobot(
        readings={
            "laser": lambda robot: scan(robot.now()),
            "camera": lambda robot: picture(robot.now()),
        }
    )


@pytest.fixture
def lease(robot):
    return Actuators(robot).lease("service", ())


def moved(robot: ScriptedRobot, x: float = 0.0, yaw: float = 0.0) -> None:
    robot.base = robot.base @ Pose2D(x, 0.0, yaw)
    robot.time += 0.1


@pytest.mark.parametrize("sensor", ["laser", "camera"])
@pytest.mark.parametrize("motion", [{"x": 0.05}, {"yaw": 0.05}, {"x": -0.2, "yaw": 1.0}])
def test_the_same_reading_after_a_motion_is_a_dead_sensor(robot, lease, sensor, motion):
    lease.read(sensor)
    moved(robot, **motion)
    with pytest.raises(Failure, match=f"{sensor} has repeated the same reading") as caught:
        lease.read(sensor)
    assert caught.value.code == "SENSOR_DEAD"
    assert caught.value.value.data["sensor"] == sensor


def test_a_camera_that_turned_must_see_something_else(robot, lease):
    lease.read("camera")
    carrier = robot.description.actuators[robot.description.camera()[1].carrier].joints[0]
    robot.joints[carrier] += 0.1
    robot.time += 0.1
    lease.read("laser")
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        lease.read("camera")


def test_small_motions_add_up_while_it_repeats_itself(robot, lease):
    lease.read("laser")
    moved(robot, x=0.03)
    lease.read("laser")
    moved(robot, x=0.03)
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        lease.read("laser")


def test_at_rest_it_may_repeat_itself(robot, lease):
    stamps = []
    for _ in range(5):
        stamps.append((lease.read("laser").stamp, lease.read("camera").stamp))
        robot.time += 0.1
    assert stamps == [(pytest.approx(0.1 * n), pytest.approx(0.1 * n)) for n in range(5)]
    moved(robot, x=0.1)
    for sensor in ("laser", "camera"):
        with pytest.raises(Failure, match="SENSOR_DEAD"):
            lease.read(sensor)


def test_another_skill_does_not_begin_from_nothing(robot):
    book = Actuators(robot)
    book.lease("first", ()).read("laser")
    moved(robot, x=0.1)
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        book.lease("second", ()).read("laser")


def test_it_is_alive_again_with_the_first_new_reading(robot, lease):
    lease.read("laser")
    moved(robot, x=0.1)
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        lease.read("laser")
    robot.readings["laser"] = lambda robot: scan(robot.now(), first=1.5)
    assert lease.read("laser").ranges[0] == 1.5


@pytest.mark.parametrize(
    ("sensor", "nothing"),
    [
        ("laser", lambda robot: scan(robot.now(), 10.0, 10.0)),
        ("camera", lambda robot: picture(robot.now(), 0.0, 0)),
    ],
)
def test_seeing_nothing_twice_is_no_repetition(robot, lease, sensor, nothing):
    robot.readings[sensor] = nothing
    first = lease.read(sensor)
    moved(robot, x=1.0)
    second = lease.read(sensor)
    assert second.stamp > first.stamp
    assert not same(first, second)


def test_an_old_stamp_is_an_old_reading_not_a_new_one(robot, lease):
    robot.readings["laser"] = scan(0.0)
    lease.read("laser")
    moved(robot, x=1.0)
    assert lease.read("laser").stamp == 0.0


def test_new_pictures_are_no_repetition(robot, lease):
    for depth in (1.0, 1.1, 1.2):
        robot.readings["camera"] = picture(robot.now(), depth)
        assert lease.read("camera").depth[0, 0] == np.float32(depth)
        moved(robot, x=0.3)
    robot.readings["camera"] = picture(robot.now(), 1.2)
    with pytest.raises(Failure, match="SENSOR_DEAD"):
        lease.read("camera")


def covered(robot, first: int, count: int, beams: int = 220):
    ranges = np.full(beams, 2.0)
    ranges[first : first + count] = 0.05
    robot.readings["laser"] = LaserScan(robot.now(), "laser", -1.1, 0.01, 0.05, 10.0, ranges)


@pytest.mark.parametrize("first", [0, 100, 200])
def test_a_laser_that_sees_its_own_lens_over_a_sector_is_dead(robot, lease, first):
    covered(robot, first, 20)
    with pytest.raises(Failure, match="something covers its lens") as caught:
        lease.read("laser")
    assert caught.value.code == "SENSOR_DEAD"
    assert caught.value.value.data["middle"] == pytest.approx(-1.1 + (first + 9.5) * 0.01)


def test_a_few_beams_at_the_least_range_are_noise_or_something_thin(robot, lease):
    covered(robot, 100, 14)
    assert np.count_nonzero(lease.read("laser").ranges < 0.1) == 14
    for first in range(0, 200, 20):
        robot.readings["laser"].ranges[first : first + 10] = 0.05
    assert np.count_nonzero(lease.read("laser").ranges < 0.1) > 100
    covered(robot, 100, 16)
    with pytest.raises(Failure, match="something covers its lens"):
        lease.read("laser")
