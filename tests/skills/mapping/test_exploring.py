"""`momantu-bt map --world`: the tree runs, and what there is is saved however it ends."""

from __future__ import annotations

import os
import signal

import numpy as np
import pytest
from momantu_skills.mapping import exploring, results

from momantu_bt.errors import InputError
from momantu_bt.formats.maps import OCCUPIED, read_map
from momantu_bt.messages import ImuReading, PointCloud, frozen
from momantu_bt.robot import ImuSensor, LidarSensor
from momantu_bt.site_file import read_names
from momantu_bt.testing import ScriptedWorld, scripted_site, small_robot
from tests.skills.mapping import halls
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot


@pytest.fixture
def flat_world():
    robot = FlatRobot(START)
    robot.boxes = [*ROOMS, DESK]
    robot.dead.add("wrench")
    return ScriptedWorld(robot, scripted_site(start=START))


def test_the_flat_is_explored_and_saved(flat_world, tmp_path):
    told = []
    out = tmp_path / "flat"
    explored = exploring.explore(
        flat_world, None, 0, out, lambda now, mapping: told.append((now, mapping.known))
    )
    assert (explored.status, explored.why) == ("SUCCESS", "")
    assert explored.about["free_m2"] > 55.0
    assert {each.name for each in out.iterdir()} == results.FILES
    assert list(read_names(out / "site.yaml").places) == ["start"]
    assert told[-1][1] > 55.0


@pytest.mark.parametrize(("end", "status"), [("interrupt", "INTERRUPTED"), ("stuck", "FAILURE")])
def test_what_there_is_is_saved_when_it_ends_early(flat_world, tmp_path, end, status):
    def disturb(now, mapping):
        if now > 5.0 and end == "interrupt":
            os.kill(os.getpid(), signal.SIGINT)
        elif now > 5.0:
            flat_world.robot.frozen.add("base")

    explored = exploring.explore(flat_world, None, 0, tmp_path / "flat", disturb)
    assert explored.status == status
    assert bool(explored.why) == (end == "stuck")
    assert explored.about["free_m2"] > 5.0
    assert {each.name for each in (tmp_path / "flat").iterdir()} == results.FILES


class RingedRobot(FlatRobot):
    """Has a lidar of many rings, whose turns are of one instant, and an IMU, too."""

    def __init__(self, truth):
        lidar = LidarSensor(
            frame="laser_link",
            elevations=tuple(halls.RINGS),
            columns=halls.COLUMNS,
            range_min=0.3,
            range_max=50.0,
        )
        small = small_robot()
        sensors = {**small.sensors, "lidar": lidar, "imu": ImuSensor(frame="base_link", rate=20)}
        super().__init__(truth, description=small.model_copy(update={"sensors": sensors}))
        self.boxes = [*ROOMS, DESK]
        self.dead.add("wrench")
        self.readings |= {"lidar": _turn, "imu": _samples}


def _turn(robot):
    boxes = [(x0, y0, 0.0, x1, y1, 2.0) for x0, y0, x1, y1 in robot.boxes]
    map_from_lidar = robot.truth.transform() @ robot.mount
    turns, rises = np.meshgrid(np.linspace(-np.pi, np.pi, halls.COLUMNS), halls.RINGS)
    flat = np.cos(rises.ravel())
    beams = np.column_stack(
        [flat * np.cos(turns.ravel()), flat * np.sin(turns.ravel()), np.sin(rises.ravel())]
    )
    ways = beams @ map_from_lidar.rotation.T
    ranges = halls.cast(np.tile(map_from_lidar.position, (len(ways), 1)), ways, boxes)
    hit = np.isfinite(ranges)
    points = (beams[hit] * ranges[hit, None]).astype(np.float32)
    return PointCloud(robot.time, "laser_link", frozen(points))


def _samples(robot):
    rate = robot.angular * (1 - robot.drift)
    return ImuReading(
        robot.time,
        "base_link",
        np.array([robot.time]),
        np.array([[0.0, 0.0, rate]]),
        halls.GRAVITY[None],
    )


def test_a_map_in_three_dimensions_is_saved_whole(tmp_path):
    robot, out = RingedRobot(START), tmp_path / "flat"
    world = ScriptedWorld(robot, scripted_site(start=START))

    def disturb(now, mapping):
        if now > 4.0:
            os.kill(os.getpid(), signal.SIGINT)

    explored = exploring.explore(world, None, 0, out, disturb, spatial=True)
    assert explored.status == "INTERRUPTED"
    assert explored.about["dimensions"] == 3
    assert {each.name for each in out.iterdir()} == (
        results.FILES - {results.SURVEY} | results.SPATIAL_FILES
    )
    header, _, data = (out / "cloud.pcd").read_bytes().partition(b"DATA binary\n")
    assert f"POINTS {explored.about['points']}\n".encode() in header
    points = np.frombuffer(data, "<f4").reshape(-1, 3)
    assert len(points) == explored.about["points"] > 1000
    walls = points[(points[:, 2] > 0.2) & (points[:, 0] < -3.5)]
    assert np.median(walls[:, 0]) == pytest.approx(-4.0, abs=0.03)
    plan, over = read_map(out / "map.yaml"), read_map(out / "overhang.yaml")
    assert plan.levels.shape == over.levels.shape
    assert (plan.cells() == OCCUPIED).sum() > 100
    assert np.loadtxt(out / "trajectory.tum").shape == (explored.about["turns_read"], 8)


def test_a_robot_without_such_a_lidar_is_told_what_it_lacks(flat_world, tmp_path):
    with pytest.raises(InputError, match=r"lacks a lidar .* and an IMU .* leave out --dimensions"):
        exploring.explore(
            flat_world, None, 0, tmp_path / "flat", lambda now, mapping: None, spatial=True
        )
    assert not (tmp_path / "flat").exists()


def test_a_lidar_that_does_not_answer_for_a_while_is_bridged(tmp_path):
    robot = RingedRobot(START)
    world = ScriptedWorld(robot, scripted_site(start=START))

    def disturb(now, mapping):
        dead = 1.0 < now < 1.6
        robot.dead = {"wrench", "lidar"} if dead else {"wrench"}
        if now > 2.5:
            os.kill(os.getpid(), signal.SIGINT)

    explored = exploring.explore(world, None, 0, tmp_path / "flat", disturb, spatial=True)
    assert explored.about["turns_read"] < 22
    assert explored.about["turns_doubtful"] < 5
