"""What is measured of a robot, against what its description says."""

import math

import numpy as np
import pytest
from momantu_worlds.checking.measures import measured
from momantu_worlds.robots import fetch

from momantu_bt.geometry import Pose2D

FETCH = measured(fetch())


def test_half_the_width_is_the_nearest_edge_of_the_footprint() -> None:
    corners = np.array(fetch().footprint)
    edges = (corners + np.roll(corners, -1, axis=0)) / 2
    assert FETCH.half_width == pytest.approx(np.hypot(*edges.T).min(), abs=1e-5)


def test_the_outline_stands_where_the_base_stands() -> None:
    pose = Pose2D(1.0, 2.0, math.pi / 2)
    x, y = fetch().footprint[0]
    assert FETCH.outline(pose)[0] == pytest.approx((1.0 - y, 2.0 + x))


def test_a_hand_works_at_tables_and_not_below_the_floor_or_under_the_ceiling() -> None:
    assert all(FETCH.works_at(height) for height in (0.4, 0.5, 0.72, 0.9, 1.1))
    assert not FETCH.works_at(-1.0)
    assert not FETCH.works_at(2.3)


def test_eyes_are_where_the_camera_is_in_the_poses_for_looking() -> None:
    robot = fetch()
    frame = robot.camera()[1].frame
    heights = [
        robot.kinematics().base_from_frame(frame, robot.named_poses[name]).position[2]
        for name in ("look_around", "ready")
    ]
    assert FETCH.eyes == pytest.approx(heights)


def test_measuring_is_the_same_each_time() -> None:
    assert np.array_equal(measured(fetch()).hand, FETCH.hand)
