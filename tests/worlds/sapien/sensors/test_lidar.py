"""The lidar meets walls, floor and loose things where they are, and never its own robot."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from momantu_worlds.robots import kinova_jackal
from momantu_worlds.sapien.sensors.laser import BandLaser
from momantu_worlds.sapien.sensors.lidar import Lidar
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Episode, Part
from momantu_worlds.testing import WALL_FACE, plain_episode

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import BaseVelocity, LaserScan, PointCloud, frozen
from momantu_bt.motion import Motion
from momantu_bt.robot import LaserSensor

ROBOT = kinova_jackal()
NAME, SENSOR = ROBOT.lidar()
LASER, SCAN = ROBOT.laser()
FRONT = max(corner[0] for corner in ROBOT.footprint)
HEIGHT = 0.34
"""m; of the lidar's origin above the floor."""


def world(*bodies: Body, start: Pose2D | None = None) -> Episode:
    episode = plain_episode(table=False)
    return dataclasses.replace(
        episode, bodies=(*episode.bodies, *bodies), start=start or episode.start
    )


def simulated(episode: Episode, pose: str = "home") -> Simulator:
    return Simulator(ROBOT, episode, 3, render=False, pose=ROBOT.named_poses[pose])


def lidar_of(simulator: Simulator) -> Lidar:
    lidar = simulator.robot.sensors[NAME]
    assert isinstance(lidar, Lidar)
    return lidar


def cloud(simulator: Simulator) -> Array:
    """The lidar's points of now, in the map."""
    reading = simulator.robot.read(NAME)
    assert isinstance(reading, PointCloud)
    return simulator.truth.link(reading.frame).apply(reading.points)


def scan(simulator: Simulator) -> LaserScan:
    reading = simulator.robot.read(LASER)
    assert isinstance(reading, LaserScan)
    return reading


def ahead(reading: LaserScan) -> float:
    return float(reading.ranges[SCAN.beams // 2])


def post(name: str, x: float, y: float, height: float, *, loose: bool = False) -> Body:
    part = Part(Cylinder(0.1, height), Transform((0, 0, height / 2)))
    return Body(name, name, Transform((x, y, 0)), (part,), not loose, 5.0)


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_the_wall_is_flat_and_the_floor_is_level(yaw: float) -> None:
    simulator = simulated(world(start=Pose2D(0.2, 0.1, yaw)))
    points = cloud(simulator)
    wall = points[points[:, 2] > 0.1]
    floor = points[(points[:, 2] < 0.1) & (points[:, 0] < WALL_FACE - 0.2)]
    assert len(wall) > 500
    assert len(floor) > 500
    assert np.abs(wall[:, 0] - WALL_FACE).max() < 0.06
    assert np.abs(floor[:, 2]).max() < 0.02


def test_the_lowest_ring_meets_the_floor_where_it_must() -> None:
    simulator = simulated(world())
    rings = lidar_of(simulator).exact().reshape(SENSOR.columns, len(SENSOR.elevations))
    lowest = rings[SENSOR.columns // 4, 0]
    assert lowest == pytest.approx(HEIGHT / math.sin(math.radians(15.0)), abs=1e-3)
    assert np.isinf(rings[SENSOR.columns // 4, -1])


def test_some_rays_are_lost_and_which_depends_on_the_stamp() -> None:
    simulator = simulated(world())
    lidar = lidar_of(simulator)
    exact = lidar.exact()
    shares = [len(lidar.at_once(0.05 * i).points) / np.isfinite(exact).sum() for i in range(10)]
    assert 1.0 - np.mean(shares) == pytest.approx(simulator.config.lidar.drop_out, rel=0.3)
    assert np.array_equal(lidar.read(0.1).points, lidar.read(0.1).points)
    assert not np.array_equal(lidar.read(0.1).points[:50], lidar.read(0.2).points[:50])


def test_range_noise_about_the_wall() -> None:
    simulator = simulated(world())
    offsets = []
    for _ in range(5):
        simulator.step()
        points = cloud(simulator)
        straight = (points[:, 0] > 2.0) & (np.abs(points[:, 1]) < 0.2) & (points[:, 2] > 0.1)
        offsets += list(points[straight, 0] - WALL_FACE)
    assert np.std(offsets) == pytest.approx(simulator.config.lidar.range_noise, rel=0.15)


@pytest.mark.parametrize("pose", ["home", "ready", "carry", "look_around"])
def test_the_robot_itself_is_never_seen(pose: str) -> None:
    simulator = simulated(world(start=Pose2D(-5.0, 0.0, 0.0)), pose)
    points = cloud(simulator)
    near = points[np.hypot(points[:, 0] + 5.0, points[:, 1]) < 1.1]
    assert len(near) == 0


def test_an_arm_before_the_lidar_hides_what_is_behind_it() -> None:
    simulator = simulated(world())
    lidar = lidar_of(simulator)
    before = np.isfinite(lidar.exact()).sum()
    low = np.radians([-169.5, 244.2, 82.0, -174.8, -20.6, -164.3])
    down = dict(zip(ROBOT.actuators["arm"].joints, low, strict=True))
    lowered = Simulator(ROBOT, world(), 3, render=False, pose=down)
    exact = lidar_of(lowered).exact()
    assert np.isfinite(exact).sum() < before - 20
    assert exact.min() > 1.0


def test_loose_things_are_met_where_they_are_now() -> None:
    simulator = simulated(world(post("barrel", 1.5, 0.4, 0.6, loose=True)))

    def on_barrel(x: float, y: float) -> int:
        points = cloud(simulator)
        points = points[points[:, 2] > 0.1]
        gap = np.hypot(points[:, 0] - x, points[:, 1] - y) - 0.1
        return int((np.abs(gap) < 0.04).sum())

    assert on_barrel(1.5, 0.4) > 20
    simulator.put("barrel", Transform((1.2, -0.8, 0.0)))
    simulator.step()
    assert on_barrel(1.5, 0.4) == 0
    assert on_barrel(1.2, -0.8) > 20
    simulator.add(post("visitor", 1.0, 0.9, 1.5))
    simulator.step()
    assert on_barrel(1.0, 0.9) > 20
    simulator.remove("visitor")
    simulator.step()
    assert on_barrel(1.0, 0.9) == 0


# turns that take time


def driven(linear: float, angular: float) -> Simulator:
    """A robot that has driven for a second, its lidar read throughout."""
    simulator = simulated(world(start=Pose2D(-1.0, 0.3, 0.0)))
    simulator.robot.read(NAME)
    for _ in range(20):
        simulator.robot.command("base", BaseVelocity(linear, angular))
        simulator.step()
    return simulator


def turned(simulator: Simulator) -> PointCloud:
    reading = simulator.robot.read(NAME)
    assert isinstance(reading, PointCloud)
    return reading


def test_points_of_a_turn_tell_when_they_were_measured() -> None:
    reading = turned(driven(0.0, 0.0))
    assert reading.times is not None
    assert SENSOR.turn is not None
    assert np.all(np.diff(reading.times) >= 0.0)
    assert reading.times[-1] <= 0.0
    assert reading.times[0] >= -SENSOR.turn
    assert np.ptp(reading.times) > 0.9 * SENSOR.turn


def test_the_head_turns_evenly_whenever_it_is_read() -> None:
    simulator = driven(0.0, 0.0)
    for _ in range(3):
        reading = turned(simulator)
        assert reading.times is not None
        angles = np.arctan2(reading.points[:, 1], reading.points[:, 0])
        phase = 2 * np.pi * (reading.stamp + reading.times) / SENSOR.turn
        apart = np.angle(np.exp(1j * (phase - angles)))
        assert np.ptp(apart) < 0.01
        simulator.step()


@pytest.mark.parametrize(("linear", "angular"), [(0.9, 0.0), (0.0, 1.4), (0.7, -1.0)])
def test_a_turn_on_the_move_is_skewed_and_its_motion_sets_it_right(
    linear: float, angular: float
) -> None:
    simulator = driven(linear, angular)
    before = simulator.truth.link(SENSOR.frame)
    simulator.robot.command("base", BaseVelocity(linear, angular))
    simulator.step()
    middle = simulator.truth.link(SENSOR.frame)
    simulator.robot.command("base", BaseVelocity(linear, angular))
    simulator.step()
    reading, now = turned(simulator), simulator.truth.link(SENSOR.frame)
    assert reading.times is not None
    turns, places = Motion.of([-0.1, -0.05, 0.0], [before, middle, now]).at(reading.times)
    straight = np.einsum("nij,nj->ni", turns, reading.points) + places
    wall = np.abs(straight[:, 0] - WALL_FACE) < 0.06
    assert np.count_nonzero(wall) > 300
    assert np.std(straight[wall, 0]) < 0.012
    skewed = now.apply(reading.points[wall])
    assert np.abs(skewed - straight[wall]).max() > 0.04


def test_a_scan_made_from_it_is_of_one_instant() -> None:
    asked, other = driven(0.8, 0.6), simulated(world(start=Pose2D(-1.0, 0.3, 0.0)))
    for _ in range(20):
        other.robot.command("base", BaseVelocity(0.8, 0.6))
        other.step()
    assert not lidar_of(other).asked
    assert np.array_equal(scan(asked).ranges, scan(other).ranges)


# the scan that is made from it


@pytest.mark.parametrize("yaw", [0.0, 0.5, -0.5])
def test_the_scan_of_a_wall_is_a_straight_line(yaw: float) -> None:
    simulator = simulated(world(start=Pose2D(0.3, 0.2, yaw)))
    reading = scan(simulator)
    angles = reading.angle_min + reading.angle_increment * np.arange(len(reading.ranges))
    flat = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    hit = reading.ranges < reading.range_max
    ends = simulator.truth.link(reading.frame).apply(flat[hit] * reading.ranges[hit, None])
    assert hit.sum() > 100
    assert np.median(np.abs(ends[:, 0] - WALL_FACE)) < 0.02
    assert np.abs(ends[:, 0] - WALL_FACE).max() < 0.08


@pytest.mark.parametrize("height", [0.2, 0.3, 0.4, 1.0])
@pytest.mark.parametrize("gap", [0.5, 1.0])
def test_what_may_be_run_into_is_seen_half_a_metre_before_it(height: float, gap: float) -> None:
    simulator = simulated(world(post("crate", FRONT + gap + 0.1, 0.0, height)))
    origin = ROBOT.kinematics().base_from_frame(SCAN.frame, {}).position[0]
    assert ahead(scan(simulator)) == pytest.approx(FRONT + gap - origin, abs=0.04)


def test_what_lies_below_or_above_the_band_is_not_in_the_scan() -> None:
    low = post("sill", 1.2, 0.0, 0.05)
    top = Body("top", "table", Transform((1.2, 0, 0.75)), (Part(Box((0.6, 1.2, 0.04))),))
    reading = scan(simulated(world(low, top)))
    assert ahead(reading) > 2.5


def test_every_direction_of_the_scan_is_free_of_the_robot() -> None:
    around = [post(f"p{i}", 2.0 * math.cos(a), 2.0 * math.sin(a), 1.0) for i, a in _ring()]
    reading = scan(simulated(world(*around)))
    angles = reading.angle_min + reading.angle_increment * np.arange(len(reading.ranges))
    for _, angle in _ring():
        if reading.angle_min + 0.1 < angle < reading.angle_min * -1 - 0.1:
            beam = int(np.argmin(np.abs(angles - angle)))
            assert reading.ranges[beam - 3 : beam + 4].min() < 2.3


def _ring() -> list[tuple[int, float]]:
    return [(i, -math.pi + 2 * math.pi * i / 24) for i in range(24)]


def test_the_nearest_point_of_a_sector_counts_and_others_do_not() -> None:
    sensor = LaserSensor(
        frame="laser",
        angle_min=-0.1,
        angle_max=0.1,
        beams=3,
        range_min=0.5,
        range_max=5.0,
        source="lidar",
        band=(0.2, 0.6),
    )
    points = np.array(
        [[2.0, 0.0, 0.0], [1.5, 0.01, 0.1], [1.0, 0.0, 0.5], [0.3, 0.0, 0.0], [3.0, 0.3, 0.0]],
        dtype=np.float32,
    )
    made = BandLaser(
        lambda stamp: PointCloud(stamp, "lidar", frozen(points)),
        sensor,
        Transform((0.0, 0.0, 0.4)),
        Transform((0.0, 0.0, 0.3)),
    )
    assert made.read(1.0).ranges == pytest.approx([5.0, 1.5, math.hypot(3.0, 0.3)], abs=1e-3)
