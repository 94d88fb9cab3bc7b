"""Cameras that see wrongly: the item is hidden or seen twice for some pictures, and no longer."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.rows import prepare
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.sensors.camera import Camera
from momantu_worlds.scenes.geometry.support import UprightCylinder

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.robot import read_camera

NAME = fetch().camera()[0]


@pytest.fixture(scope="module")
def looking(seeing, stand_before) -> Stage:
    """The robot looks at the table with the item."""
    stand_before(seeing, "table_a", "can")
    return seeing


def seen_at(stage: Stage, thing: Transform, *, own: bool = True) -> bool:
    """Whether the newest picture shows something at the middle of a thing of the item's size.

    own: the robot takes the picture itself, which counts.
    """
    robot, item = stage.simulator.robot, UprightCylinder(stage.item)
    image = read_camera(robot) if own else robot.peek(NAME)
    camera = robot.sensors[NAME]
    assert isinstance(camera, Camera)
    truth = stage.simulator.truth.link(image.frame) @ camera.link_from_camera
    at = truth.inverse().apply(thing.apply(np.array([0.0, 0.0, item.height / 2])))
    u, v = pixel(image.intrinsics, at)
    depth = float(camera.exact_depth()[v, u])
    return at[2] - 2 * item.radius < depth < at[2]


def pixel(intrinsics: Array, at: Array) -> tuple[int, int]:
    u, v, _ = intrinsics @ (at / at[2])
    return round(float(u)), round(float(v))


def test_the_item_is_missed_in_so_many_pictures_and_then_seen(looking, happening, step):
    assert seen_at(looking, looking.item_pose())
    shown = []
    with happening(looking, "camera.misses_object", frames=3):
        for _ in range(5):
            step(looking)
            shown.append(seen_at(looking, looking.item_pose()))
    assert shown == [False, False, False, True, True]


def test_two_reads_of_one_instant_and_films_do_not_count(looking, happening, step):
    item = looking.item_pose()
    with happening(looking, "camera.misses_object", frames=2):
        for _ in range(3):
            step(looking)
            assert not seen_at(looking, item, own=False)
        step(looking)
        assert not seen_at(looking, item, own=False)
        assert not seen_at(looking, item)
        assert not seen_at(looking, item)
        step(looking)
        assert not seen_at(looking, item)
        step(looking)
        assert seen_at(looking, item)


def test_pictures_of_elsewhere_do_not_count(looking, happening, step):
    base, robot = looking.base(), looking.simulator.robot
    with happening(looking, "camera.misses_object", frames=1):
        robot.carry(base @ Pose2D(0.0, 0.0, 2.5))
        for _ in range(3):
            step(looking)
            read_camera(robot)
        robot.carry(base)
        step(looking)
        assert not seen_at(looking, looking.item_pose())


def test_it_ends_when_it_is_mended(looking, happening, step):
    with happening(looking, "camera.misses_object", frames=100):
        step(looking)
        assert not seen_at(looking, looking.item_pose())
    assert seen_at(looking, looking.item_pose())
    camera = looking.simulator.robot.sensors[NAME]
    assert isinstance(camera, Camera)
    assert camera.hidden == []
    assert looking.simulator.robot.listeners == []


def test_a_phantom_is_seen_on_the_same_top_where_nothing_is(looking, happening, step, stand_before):
    truth = looking.simulator.truth
    with happening(looking, "camera.phantom", frames=3):
        (phantom,) = looking.simulator.added
        there = phantom.map_from_body
        away = there.position - looking.item_pose().position
        assert np.hypot(*away[:2]) >= 0.15
        assert abs(away[2]) < 1e-3
        stand_before(looking, "table_a", phantom.name)
        shown = []
        for _ in range(4):
            step(looking)
            shown.append(seen_at(looking, there))
        assert shown == [True, True, True, False]
        height, _ = truth.height_below("nothing", there.apply(np.array([[0.0, 0.0, 0.3]])))
        assert height == pytest.approx(0.3, abs=1e-3)
    assert looking.simulator.added == ()


def test_no_phantom_where_the_item_stands_on_nothing(looking, fault):
    pose = looking.item_pose()
    effect = prepare(looking, fault("camera.phantom", frames=1))
    looking.move_item(Transform((20.0, 20.0, 0.0)))
    with pytest.raises(FaultError, match="can stands on no table now"):
        effect.begin()
    looking.move_item(pose)
