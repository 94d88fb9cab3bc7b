"""Grasps: the fingers straddle the object, the palm clears it, and there are many directions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.hand.grasps import OPENING, TIGHT, Grasp, grasps_for
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.manipulation.model.hulls import object_corners
from momantu_worlds.robots import fetch, kinova_jackal

from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject

HAND = fetch().end_effector
FETCH, KINOVA = arm_model(fetch()), arm_model(kinova_jackal())
PALM = arm_model(fetch()).hulls[HAND.frame]


def thing(shape: str, size: tuple[float, float, float]) -> DetectedObject:
    pose = Pose(Transform((0.8, 0.0, 0.8)), "odom", 0.0)
    return DetectedObject("thing", pose, size, shape, 0.9, 0.8 - size[2] / 2)


def grasps(shape: str, size: tuple[float, float, float]) -> list[Grasp]:
    return grasps_for(thing(shape, size), HAND, PALM)


def across(grasp: Grasp, size: tuple[float, float, float], shape: str) -> float:
    """Extent of the object along the closing direction, between the pads."""
    corners = object_corners(thing(shape, size))
    return float(np.ptp(grasp.object_from_grasp.inverse().apply(corners)[:, 1]))


CANS = st.tuples(st.floats(0.04, 0.08), st.floats(0.08, 0.2))


@settings(max_examples=25)
@given(CANS)
def test_a_can_is_grasped_from_all_around_and_from_above(can: tuple[float, float]) -> None:
    size = (can[0], can[0], can[1])
    found = grasps("cylinder", size)
    ways = np.array([grasp.object_from_grasp.rotation[:, 0] for grasp in found])
    level = ways[np.abs(ways[:, 2]) < 0.1]
    headings = np.sort(np.unique(np.round(np.arctan2(level[:, 1], level[:, 0]), 3)))
    assert np.diff(headings).max() < 0.3
    assert (ways[:, 2] < -0.99).any()


@settings(max_examples=25)
@given(CANS)
def test_the_axis_lies_between_the_pads(can: tuple[float, float]) -> None:
    size = (can[0], can[0], can[1])
    for grasp in grasps("cylinder", size):
        r, p = grasp.object_from_grasp.rotation, grasp.object_from_grasp.position
        line = np.array([[0.0, 0.0, z] for z in np.linspace(-size[2] / 2, size[2] / 2, 60)])
        local = (line - p) @ r
        assert np.abs(local[:, 1]).max() < 1e-9 or abs(r[2, 0]) > 0.99
        between = (np.abs(local[:, 0]) < HAND.pad_length / 2) & (np.abs(local[:, 2]) < 0.02)
        assert between.any()
        assert grasp.width == pytest.approx(can[0])


@settings(max_examples=25)
@given(CANS)
def test_the_palm_clears_the_object(can: tuple[float, float]) -> None:
    size = (can[0], can[0], can[1])
    for grasp in grasps("cylinder", size):
        corners = grasp.object_from_grasp.inverse().apply(object_corners(thing("box", size)))
        if abs(grasp.object_from_grasp.rotation[2, 0]) > 0.99:
            assert corners[:, 0].min() > -HAND.hand_clearance
    level = [g for g in grasps("cylinder", size) if abs(g.object_from_grasp.rotation[2, 0]) < 0.01]
    for grasp in level:
        assert can[0] / 2 - np.linalg.norm(grasp.object_from_grasp.position[:2]) <= (
            HAND.hand_clearance - 0.003
        )


@pytest.mark.parametrize("size", [(0.05, 0.15, 0.1), (0.15, 0.05, 0.1), (0.06, 0.06, 0.2)])
def test_a_box_is_held_across_narrow_faces(size: tuple[float, float, float]) -> None:
    found = grasps("box", size)
    assert found
    for grasp in found:
        assert across(grasp, size, "box") == pytest.approx(grasp.width)
        assert grasp.width <= HAND.max_width - 0.014


@pytest.mark.parametrize("size", [(0.05, 0.15, 0.14), (0.12, 0.07, 0.14)])
def test_a_deep_box_is_held_level_by_enough_of_its_faces(size: tuple[float, float, float]) -> None:
    level = [g for g in grasps("box", size) if abs(g.object_from_grasp.rotation[2, 0]) < 0.01]
    assert level
    for grasp in level:
        corners = grasp.object_from_grasp.inverse().apply(object_corners(thing("box", size)))
        near, far = corners[:, 0].min(), corners[:, 0].max()
        assert near >= -HAND.hand_clearance
        pad = HAND.pad_length / 2
        assert min(far, pad) - max(near, -pad) >= 0.035 - 1e-9


def test_the_deeper_a_box_reaches_beyond_the_pads_the_less_it_is_liked() -> None:
    least = [min(g.penalty for g in grasps("box", (0.05, y, 0.14))) for y in (0.06, 0.10, 0.15)]
    assert least == sorted(least)
    assert least[0] < least[-1]


def test_what_is_wider_than_the_gripper_has_grasps_by_its_rim_alone() -> None:
    assert all(grasp.rim for grasp in grasps("cylinder", (0.12, 0.12, 0.1)))
    assert all(grasp.rim for grasp in grasps("box", (0.12, 0.12, 0.1)))


@pytest.mark.parametrize("width", [0.06, 0.088, 0.091, 0.095])
def test_a_hand_that_is_hardly_wider_than_the_object_is_enough_where_it_must_be(
    width: float,
) -> None:
    one = thing("cylinder", (width, width, 0.1))
    held = [g for g in grasps_for(one, HAND, PALM, tight=True) if not g.rim]
    assert bool(held) is (width <= HAND.max_width - TIGHT)
    assert TIGHT < OPENING


def test_every_grasp_has_its_twin_turned_by_half_a_turn() -> None:
    found = grasps("cylinder", (0.07, 0.07, 0.13))
    for one, other in zip(found[::2], found[1::2], strict=True):
        a, b = one.object_from_grasp, other.object_from_grasp
        assert a.position == pytest.approx(b.position)
        assert a.rotation[:, 0] == pytest.approx(b.rotation[:, 0])
        assert a.rotation[:, 1] == pytest.approx(-b.rotation[:, 1])


def test_level_grasps_are_preferred_to_those_from_above() -> None:
    best = min(grasps("cylinder", (0.07, 0.07, 0.13)), key=lambda grasp: grasp.penalty)
    assert abs(best.object_from_grasp.rotation[2, 0]) < 1e-9


@settings(max_examples=5, deadline=None)
@given(CANS, st.sampled_from(["cylinder", "box"]))
def test_open_fingers_are_nowhere_in_the_object(can: tuple[float, float], shape: str) -> None:
    size = (can[0], can[0], can[1])
    corners = object_corners(thing(shape, size))
    for model in (FETCH, KINOVA):
        hand = model.description.end_effector
        found = grasps_for(thing(shape, size), hand, model.palm, model.open_fingers)
        weights = np.random.default_rng(0).dirichlet(np.full(len(corners), 0.1), 300)
        points = weights @ corners
        for grasp in found[::29]:
            local = grasp.object_from_grasp.inverse().apply(points)
            for planes in model.open_fingers:
                depth = (local @ planes[:, :3].T + planes[:, 3]).max(axis=1)
                assert float(depth.min()) > -1e-3


def test_parallel_fingers_change_nothing() -> None:
    model = arm_model(fetch())
    for shape, size in (("cylinder", (0.07, 0.07, 0.13)), ("box", (0.05, 0.07, 0.12))):
        plain = grasps(shape, size)
        found = grasps_for(thing(shape, size), HAND, PALM, model.open_fingers)
        assert [g.object_from_grasp for g in found] == [g.object_from_grasp for g in plain]


def test_fingers_that_leave_no_room_leave_no_grasp() -> None:
    everywhere = np.array([[1.0, 0, 0, -1], [-1, 0, 0, -1], [0, 1, 0, -1], [0, -1, 0, -1]])
    assert grasps_for(thing("cylinder", (0.07, 0.07, 0.13)), HAND, PALM, [everywhere]) == []


@pytest.mark.parametrize("model", [FETCH, KINOVA])
def test_fingers_that_close_on_a_deep_box_meet_it_with_their_pads(model: ArmModel) -> None:
    deep, width = thing("box", (0.11, 0.07, 0.14)), 0.07
    hand = (model.description.hand, model.palm, model.open_fingers)
    found = grasps_for(deep, *hand, closing=model.fingers_at)
    along = np.linspace(-0.055, 0.055, 45)
    faces = np.array([(x, y, z) for x in along for y in (-0.035, 0.035) for z in (0.0, 0.02)])
    level = [g for g in found if g.object_from_grasp.rotation[0, 0] > 0.99]
    assert level
    for grasp in level:
        local = grasp.object_from_grasp.inverse().apply(faces)
        for planes in model.fingers_at(width):
            assert (local @ planes[:, :3].T + planes[:, 3]).max(axis=1).min() >= -0.003


def test_short_pads_still_hold_a_can_from_the_side() -> None:
    """Innermost edges of fingers that turn are pads of 2 cm: with them a can is held too."""
    short = HAND.model_copy(update={"pad_length": 0.02, "hand_clearance": 0.05})
    found = grasps_for(thing("cylinder", (0.07, 0.07, 0.13)), short, PALM)
    level = [g.object_from_grasp for g in found if abs(g.object_from_grasp.rotation[2, 0]) < 0.01]
    assert level
    for frame in level:
        behind = -float(frame.position[:2] @ frame.rotation[:2, 0])
        assert 0.0 <= behind < short.pad_length / 2
