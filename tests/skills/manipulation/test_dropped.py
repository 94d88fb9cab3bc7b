"""Where what fell out of the hand is supposed to lie."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.scene.dropped import ASIDE, dropped

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import GRAVITY, DetectedObject, Pose, RobotState
from momantu_bt.service import HeldObject
from tests.skills.scenery.table import SceneOf, Tabletop

NONE = np.empty(0)
CAN = DetectedObject(
    "can",
    Pose(Transform((0.8, 0.0, 0.785)), "odom", 0.0),
    (0.07, 0.07, 0.13),
    "cylinder",
    0.9,
    0.72,
)
HELD = HeldObject(CAN, Transform())


def moving(pose: Pose2D, linear: float = 0.0, angular: float = 0.0) -> RobotState:
    at = pose.transform()
    return RobotState(0.0, (), NONE, NONE, NONE, at, linear, angular, 0.07, 40.0)


places = st.builds(Pose2D, st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3))


@given(places, st.floats(0.2, 1.0), st.floats(-0.5, 0.5), st.floats(0.1, 1.5))
def test_below_a_hand_at_rest_lies_a_disc(pose: Pose2D, x: float, y: float, z: float) -> None:
    points = dropped(moving(pose), np.array([x, y, z]), 0.13, -math.inf)
    off = np.linalg.norm(points - pose.apply(np.array([[x, y]]))[0], axis=1)
    assert off.max() <= ASIDE + 0.065 + 1e-9
    assert len(points) > 100


@given(places, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_it_flies_on_as_the_hand_moved(pose: Pose2D, linear: float, angular: float) -> None:
    hand, seconds = np.array([0.6, 0.2, 0.8]), float(np.sqrt(2 * 0.8 / GRAVITY))
    ends = hand[:2] + seconds * np.array([linear - 0.2 * angular, 0.6 * angular])
    points = dropped(moving(pose, linear, angular), hand, 0.1, -math.inf)
    for there in (hand[:2], ends):
        assert np.linalg.norm(points - pose.apply(there[None])[0], axis=1).min() < 0.05


@given(places, st.floats(-0.2, 0.6), st.floats(-0.5, 0.5))
def test_a_base_under_the_hand_can_still_back_out(pose: Pose2D, x: float, y: float) -> None:
    points = dropped(moving(pose), np.array([x, y, 0.8]), 0.13, 0.3)
    assert (pose.inverse().apply(points)[:, 0] > 0.3 - 1e-9).all()


def lost(scene_of: SceneOf, map_from_odom: Transform) -> tuple[np.ndarray, np.ndarray]:
    """Low things (n, 2) after the fingers let go, and where the hand is (2,), both in the map."""
    robot = Tabletop(can=None, pose="carry")
    scene = scene_of(robot)
    scene.frames.add_state(robot.state())
    scene.frames.set_map_from_odom(map_from_odom, robot.now())
    scene.grasped(CAN, Transform())
    assert len(scene.low_things) == 0
    for _ in range(scene.config.doubt + 1):
        robot.advance(0.05)
        scene.update(robot, robot.now())
    assert scene.held is None
    hand = map_from_odom.apply(robot.odom_from_hand.position)
    return np.asarray(scene.low_things), hand[:2]


def test_what_the_fingers_lost_lies_below_the_hand(scene_of: SceneOf) -> None:
    low, hand = lost(scene_of, Transform((0.0, 5.0, 0.0)))
    assert np.linalg.norm(low - hand, axis=1).max() < ASIDE + 0.3
    assert np.linalg.norm(low.mean(axis=0) - hand) < 0.25


def test_what_was_lost_over_a_table_does_not_lie_on_the_floor(scene_of: SceneOf) -> None:
    """The site has table_a at (2, 0)."""
    _, hand = lost(scene_of, Transform())
    low, _ = lost(scene_of, Transform((2.0 - hand[0], -hand[1], 0.0)))
    assert len(low) == 0
