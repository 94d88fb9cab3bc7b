"""Things that lie: grasped across their axis, set down as they lay, seen where they were put."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.hand.choosing import floor_below
from momantu_skills.manipulation.hand.grasps import DOWN, Grasp, grasps_for
from momantu_skills.manipulation.hand.lying_down import at, beside
from momantu_skills.manipulation.hand.placing import _resting
from momantu_skills.manipulation.hand.resting import (
    held_level,
    levelled,
    lies,
    put_right,
    rise,
)
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_skills.manipulation.model.hulls import object_corners
from momantu_worlds.robots import fetch, kinova_jackal

from momantu_bt.geometry import Array, Pose, Transform, quaternion_from_axis_angle
from momantu_bt.messages import DetectedObject
from momantu_bt.service import HeldObject

TABLE = 0.7
MODELS = (arm_model(fetch()), arm_model(kinova_jackal()))
YAWS = st.floats(-math.pi, math.pi)
ROUND = st.tuples(st.floats(0.056, 0.08), st.floats(0.11, 0.26))
"""Diameters, m, from the least on that fingers take from a surface, and lengths, m."""


def lying(
    yaw: float, size: tuple[float, float] = (0.066, 0.2), category: str = "can", roll: float = 0.0
) -> DetectedObject:
    """A round thing (diameter, length) on its side, its axis towards `yaw`."""
    wide, length = size
    turn = Transform.from_rpy((0.0, 0.0, 0.0), (0.0, math.pi / 2, yaw))
    turn = turn @ Transform((0.0, 0.0, 0.0), quaternion_from_axis_angle((0.0, 0.0, 1.0), roll))
    pose = Transform((0.8, 0.1, TABLE + wide / 2), turn.quaternion)
    return DetectedObject(
        category, Pose(pose, "odom", 0.0), (wide, wide, length), "cylinder", 0.9, TABLE
    )


def grasps(thing: DetectedObject, model: int = 0) -> list[Grasp]:
    arm = MODELS[model]
    hand = arm.description.hand
    return grasps_for(
        thing,
        hand,
        arm.palm,
        arm.open_fingers,
        closing=arm.fingers_at,
        floor=floor_below(thing),
    )


@settings(max_examples=12, deadline=None)
@given(YAWS, YAWS, ROUND)
def test_a_grasp_closes_across_the_axis_from_above(
    yaw: float, roll: float, size: tuple[float, float]
) -> None:
    thing = lying(yaw, size, roll=roll)
    axis, found = thing.pose.transform.rotation[:, 2], grasps(thing)
    assert found
    for grasp in found:
        hand = thing.pose.transform.rotation @ grasp.object_from_grasp.rotation
        assert abs(float(hand[:, 1] @ axis)) < 1e-9
        assert hand[2, 0] <= DOWN * math.cos(math.radians(50)) + 1e-9
        assert grasp.width == pytest.approx(size[0])


@settings(max_examples=8, deadline=None)
@given(YAWS, ROUND, st.integers(0, 1))
def test_neither_open_nor_closed_fingers_reach_into_the_surface(
    yaw: float, size: tuple[float, float], model: int
) -> None:
    thing = lying(yaw, size)
    floor = floor_below(thing).points
    for grasp in grasps(thing, model):
        own = grasp.object_from_grasp.inverse().apply(floor)
        for width in (MODELS[model].description.hand.max_width, size[0]):
            for planes in MODELS[model].fingers_at(width):
                assert not (own @ planes[:, :3].T + planes[:, 3] < 0.006).all(axis=1).any()


def test_a_bottle_is_held_below_its_shoulder() -> None:
    for grasp in grasps(lying(0.3, (0.066, 0.23), "bottle")):
        assert grasp.object_from_grasp.position[2] <= 0.03


@given(YAWS, YAWS, st.floats(-0.3, 0.3), st.sampled_from([1.0, -1.0]))
def test_a_lying_pose_is_made_level_and_keeps_its_direction(
    yaw: float, roll: float, tilt: float, way: float
) -> None:
    thing = lying(yaw, roll=roll)
    axis = thing.pose.transform.rotation[:, 2]
    leaned = Transform(
        thing.pose.position + np.array((0.0, 0.0, 0.02)),
        quaternion_from_axis_angle(np.cross(axis, (0.0, 0.0, way)), tilt),
    ) @ Transform((0.0, 0.0, 0.0), thing.pose.transform.quaternion)
    seen = DetectedObject("can", Pose(leaned, "odom", 0.0), thing.size, "cylinder", 0.9, TABLE)
    right = put_right(seen).pose.transform
    assert lies(seen)
    assert abs(right.rotation[2, 2]) < 1e-9
    assert float(right.rotation[:, 2] @ axis) > 0.999
    assert right.position[2] == pytest.approx(TABLE + thing.size[0] / 2)


@given(YAWS, st.sampled_from([0, 1, 2]), st.booleans())
def test_a_box_stands_on_whichever_side_is_down(yaw: float, up: int, flipped: bool) -> None:
    turns = {0: (0.0, math.pi / 2, 0.0), 1: (math.pi / 2, 0.0, 0.0), 2: (0.0, 0.0, 0.0)}
    turn = Transform.from_rpy((0.0, 0.0, 0.0), turns[up])
    if flipped:
        turn = Transform.from_rpy((0.0, 0.0, 0.0), (math.pi, 0.0, 0.0)) @ turn
    pose = Transform.from_rpy((0.5, 0.0, 0.9), (0.0, 0.0, yaw)) @ turn
    thing = DetectedObject("box", Pose(pose, "odom", 0.0), (0.05, 0.08, 0.2), "box", 0.9, TABLE)
    right = put_right(thing)
    assert abs(right.pose.transform.rotation[2, 2]) > 0.999
    before = pose.apply(object_corners(thing))
    after = right.pose.transform.apply(object_corners(right))
    assert sorted(map(tuple, before.round(6))) == sorted(map(tuple, after.round(6)))


def test_what_stands_stays_as_it_was_seen() -> None:
    pose = Pose(Transform.from_rpy((0.5, 0.0, 0.9), (0.0, 0.0, 0.4)), "odom", 0.0)
    for shape in ("box", "cylinder"):
        thing = DetectedObject("thing", pose, (0.05, 0.08, 0.2), shape, 0.9, TABLE)
        assert put_right(thing) is thing
        assert rise(thing, pose.transform) == 0.1


@given(YAWS, st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_pads_turn_an_axis_along_them(roll: float, askew: float, tilt: float) -> None:
    held = Transform.from_rpy((0.01, 0.0, 0.0), (askew, tilt, roll))
    turned = held_level(held)
    assert abs(turned.rotation[1, 2]) < 1e-9
    assert np.allclose(turned.position, held.position)
    # along the pads it keeps its direction
    before, after = held.rotation[[0, 2], 2], turned.rotation[[0, 2], 2]
    assert float(before @ after) / float(np.linalg.norm(before)) == pytest.approx(1.0)


@settings(max_examples=20, deadline=None)
@given(YAWS, YAWS, st.floats(-0.4, 0.4), st.floats(-math.pi, math.pi))
def test_it_is_set_down_as_it_lay_whatever_the_spot_and_the_grasp(
    yaw: float, spot_yaw: float, askew: float, roll: float
) -> None:
    thing = lying(yaw, roll=roll)
    hand = Transform.from_rpy((0.014, 0.0, 0.0), (0.0, 0.0, 0.0))
    odom_from_grasp = thing.pose.transform @ hand
    held = HeldObject(thing, odom_from_grasp.inverse() @ thing.pose.transform)
    spot = Pose(Transform.from_rpy((1.0, 2.0, 0.5), (0.0, 0.0, spot_yaw)), "odom", 0.0)
    poses = list(_resting(spot, held, upright=False))
    down = odom_from_grasp.rotation[2, 0]
    same = [pose for pose, cost in poses if cost == 0.0]
    assert len(same) == 16
    for pose, _ in poses:
        assert abs(pose.rotation[2, 2]) < 1e-9
        assert np.allclose(pose.position, (1.0, 2.0, 0.5 + thing.size[0] / 2))
    for pose in same:
        # the hand points down as much as when it grasped
        back = pose @ held.grasp_from_object.inverse()
        assert back.rotation[2, 0] == pytest.approx(down, abs=1e-9)


def test_it_can_be_made_to_stand() -> None:
    held = HeldObject(lying(0.7), Transform())
    spot = Pose(Transform((1.0, 2.0, 0.5)), "odom", 0.0)
    for pose, _ in _resting(spot, held, upright=True):
        assert pose.rotation[2, 2] == pytest.approx(1.0)
        assert pose.position[2] == pytest.approx(0.5 + 0.1)


def upper_side(pose: Transform, size: tuple[float, float, float]) -> Array:
    """Points (n, 3) that a camera above sees of a lying cylinder."""
    radius, half = size[0] / 2, size[2] / 2
    up, side = pose.rotation[2], np.cross(pose.rotation[2], (0.0, 0.0, 1.0))
    turns, places = np.meshgrid(np.linspace(-1.4, 1.1, 14), np.linspace(-half, half, 20))
    around = np.cos(turns).ravel()[:, None] * up + np.sin(turns).ravel()[:, None] * side
    local = radius * around + places.ravel()[:, None] * np.array((0.0, 0.0, 1.0))
    random = np.random.default_rng(0)
    return np.asarray(pose.apply(local) + random.normal(0.0, 0.002, local.shape))


@settings(max_examples=20, deadline=None)
@given(YAWS, st.floats(-0.05, 0.05), st.floats(-0.03, 0.03), st.floats(-0.35, 0.35))
def test_it_is_found_where_it_rolled_to(
    yaw: float, aside: float, along: float, turn: float
) -> None:
    thing = lying(yaw)
    planned = thing.pose.transform
    side = np.cross(planned.rotation[2], (0.0, 0.0, 1.0))
    local = aside * side + np.array((0.0, 0.0, along))
    real = planned @ Transform(local, quaternion_from_axis_angle(planned.rotation[2], turn))
    found = beside(upper_side(real, thing.size), planned, thing, TABLE)
    assert found is not None
    assert np.linalg.norm(found.position - real.position) < 0.012
    assert float(found.rotation[:, 2] @ real.rotation[:, 2]) > math.cos(math.radians(4))


def test_nothing_and_something_else_are_not_the_lying_thing() -> None:
    thing = lying(0.4)
    pose = thing.pose.transform
    nothing = np.empty((0, 3))
    assert beside(nothing, pose, thing, TABLE) is None
    assert at(nothing, pose, thing, TABLE) == "gone"
    flat = pose.position + np.random.default_rng(0).uniform(-0.1, 0.1, (300, 3)) * (1, 1, 0.02)
    assert beside(flat, pose, thing, TABLE) is None
    assert at(upper_side(pose, thing.size), pose, thing, TABLE) == "there"


@given(YAWS)
def test_the_nearest_axis_is_made_upright(yaw: float) -> None:
    turn = Transform.from_rpy((0.0, 0.0, 0.0), (0.05, -0.04, yaw)).rotation
    assert levelled(turn)[2, 2] == pytest.approx(1.0)
    head = Transform.from_rpy((0.0, 0.0, 0.0), (math.pi - 0.05, 0.0, yaw)).rotation
    assert levelled(head)[2, 2] == pytest.approx(-1.0)


def test_a_part_that_is_seen_does_not_move_the_whole() -> None:
    thing = lying(0.4)
    pose = thing.pose.transform
    seen = upper_side(pose, thing.size)
    part = seen[pose.inverse().apply(seen)[:, 2] > -0.03]
    found = beside(part, pose, thing, TABLE)
    assert found is not None
    assert np.linalg.norm(found.position - pose.position) < 0.012
