"""The laser sees walls and loose things where they are, and nothing of its own robot."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.sensors.laser import Laser
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Body, Cylinder, Episode, Part
from momantu_worlds.testing import WALL_FACE, plain_episode

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.messages import LaserScan

FETCH = fetch()
NAME, SENSOR = FETCH.laser()


def points(simulator: Simulator, ranges: Array) -> Array:
    """Where the beams end, in the map (n, 3); infinite ones left out."""
    angles = np.linspace(SENSOR.angle_min, SENSOR.angle_max, SENSOR.beams)
    hit = np.isfinite(ranges)
    flat = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    ends = ranges[hit, None] * flat[hit]
    return simulator.truth.link(SENSOR.frame).apply(ends)


def laser_of(simulator: Simulator) -> Laser:
    laser = simulator.robot.sensors[NAME]
    assert isinstance(laser, Laser)
    return laser


def turned(episode: Episode, start: Pose2D) -> Episode:
    return dataclasses.replace(episode, start=start)


@pytest.mark.parametrize("yaw", [0.0, 0.6, -0.6])
def test_a_wall_is_a_straight_line_where_it_stands(yaw: float) -> None:
    episode = turned(plain_episode(table=False), Pose2D(0.3, 0.2, yaw))
    simulator = Simulator(FETCH, episode, 0, render=False)
    ends = points(simulator, laser_of(simulator).exact())
    on_face = np.abs(ends[:, 1]) < 3.9
    assert on_face.sum() > 100
    assert np.allclose(ends[on_face, 0], WALL_FACE, atol=1e-4)


def test_noise_is_as_large_as_claimed_and_no_beam_falls_outside_the_range() -> None:
    simulator = Simulator(FETCH, plain_episode(table=False), 3, render=False)
    exact = laser_of(simulator).exact()
    errors = []
    for _ in range(15):
        simulator.step()
        scan = simulator.robot.read(NAME)
        assert isinstance(scan, LaserScan)
        assert scan.ranges.min() >= scan.range_min
        assert np.all(scan.ranges[~np.isfinite(exact)] == scan.range_max)
        near = scan.ranges < 10.0
        errors += list((scan.ranges - exact)[near])
    assert np.std(errors) == pytest.approx(simulator.config.laser.range_noise, rel=0.1)
    assert abs(np.mean(errors)) < 1e-3


def test_the_beam_angles_are_those_of_the_frame() -> None:
    episode = plain_episode(table=False)
    post = Body("post", "post", Transform((1.5, 1.0, 0)), (Part(Cylinder(0.1, 2.0)),))
    simulator = Simulator(
        FETCH, dataclasses.replace(episode, bodies=(*episode.bodies, post)), 0, render=False
    )
    simulator.step()
    scan = simulator.robot.read(NAME)
    assert isinstance(scan, LaserScan)
    i = int(np.argmin(scan.ranges))
    angle = scan.angle_min + i * scan.angle_increment
    end = Transform() @ simulator.truth.link(scan.frame)
    hit = end.apply(scan.ranges[i] * np.array([np.cos(angle), np.sin(angle), 0.0]))
    assert np.hypot(hit[0] - 1.5, hit[1] - 1.0) == pytest.approx(0.1, abs=0.05)


def test_a_loose_thing_is_seen_where_it_is_now() -> None:
    tall = Body(
        "barrel", "barrel", Transform((1.5, 0.3, 0.25)), (Part(Cylinder(0.15, 0.5)),), False, 5.0
    )
    low = Body("cup", "cup", Transform((1.2, -0.3, 0.05)), (Part(Cylinder(0.04, 0.1)),), False, 0.2)
    episode = plain_episode(table=False)
    simulator = Simulator(
        FETCH, dataclasses.replace(episode, bodies=(*episode.bodies, tall, low)), 0, render=False
    )
    ends = points(simulator, laser_of(simulator).exact())
    gap = np.abs(np.hypot(ends[:, 0] - 1.5, ends[:, 1] - 0.3) - 0.15)
    assert (gap < 3e-3).sum() > 5
    near_cup = np.hypot(ends[:, 0] - 1.2, ends[:, 1] + 0.3) < 0.1
    assert not near_cup.any()


def test_the_robot_itself_is_never_seen() -> None:
    for pose in ("home", "carry"):
        simulator = Simulator(
            FETCH, plain_episode(table=False), 0, render=False, pose=FETCH.named_poses[pose]
        )
        assert laser_of(simulator).exact().min() > 2.0
