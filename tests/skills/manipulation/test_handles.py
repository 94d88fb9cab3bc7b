"""Handles: seen where pictures show one, and pinched from both sides without touching the mug."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.hand.grasps import THINNEST
from momantu_skills.manipulation.hand.handles import (
    THICK,
    Handle,
    handle_grasps,
    seen_handle,
    surface_of,
)
from momantu_skills.manipulation.hand.reaching import plan_pick
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_worlds.robots import fetch

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.testing.painting import Block, Round
from tests.skills.manipulation.test_motions import arm_of
from tests.skills.scenery.table import TABLE, SceneOf, Tabletop

MODEL = arm_model(fetch())
AT = (0.72, 0.0)
SIZE = (0.082, 0.082, 0.092)
BEARINGS = st.floats(-math.pi, math.pi)


def mug(yaw: float = 0.0, category: str = "mug") -> DetectedObject:
    pose = Transform.from_rpy((*AT, TABLE + SIZE[2] / 2), (0.0, 0.0, yaw))
    return DetectedObject(category, Pose(pose, "odom", 0.0), SIZE, "cylinder", 0.9, TABLE)


def body_points(thing: DetectedObject) -> Array:
    random = np.random.default_rng(0)
    points = thing.pose.transform.apply(surface_of(thing))
    return np.asarray(points + random.normal(0.0, 0.002, points.shape))


def handle_points(thing: DetectedObject, bearing: float) -> Array:
    """A plate beside the mug, 31 mm out and 50 mm high, 10 mm thick."""
    out = np.array([math.cos(bearing), math.sin(bearing), 0.0])
    away, high = np.meshgrid(np.linspace(0.041, 0.072, 5), np.linspace(-0.023, 0.030, 8))
    local = away.ravel()[:, None] * out + high.ravel()[:, None] * np.array((0.0, 0.0, 1.0))
    random = np.random.default_rng(1)
    noise = random.uniform(-0.005, 0.005, local.shape) * (1.0, 1.0, 0.2)
    return np.asarray(thing.pose.transform.apply(local + noise))


@settings(max_examples=25)
@given(BEARINGS, BEARINGS)
def test_a_handle_is_seen_where_it_is(yaw: float, bearing: float) -> None:
    thing = mug(yaw)
    points = np.vstack([body_points(thing), handle_points(thing, bearing)])
    found = seen_handle(points, thing)
    assert found is not None
    assert math.cos(found.bearing - bearing) > math.cos(math.radians(6))
    assert found.outer == pytest.approx(0.072, abs=0.005)


def test_a_can_has_none_nor_has_what_stands_around_it() -> None:
    thing = mug()
    assert seen_handle(body_points(thing), thing) is None
    around = [handle_points(thing, turn) for turn in (0.0, 2.1, 4.2)]
    assert seen_handle(np.vstack([body_points(thing), *around]), thing) is None
    far = handle_points(thing, 0.0) + np.array((0.06, 0.0, 0.0))
    assert seen_handle(np.vstack([body_points(thing), far]), thing) is None


@settings(max_examples=10, deadline=None)
@given(BEARINGS)
def test_the_pads_close_on_the_handles_flat_sides(bearing: float) -> None:
    handle = Handle(bearing, 0.072, -0.023, 0.03)
    found = handle_grasps(mug(), handle, MODEL.description.hand, MODEL.palm, MODEL.fingers_at)
    assert found
    out = np.array([math.cos(bearing), math.sin(bearing), 0.0])
    half = MODEL.description.hand.pad_length / 2
    for grasp in found:
        pose = grasp.object_from_grasp
        assert abs(float(pose.rotation[:, 1] @ out)) < 1e-9
        assert abs(float(pose.rotation[2, 1])) < 1e-9
        # the handle's middle plane is between the pads, and part of it along them
        corners = pose.inverse().apply(handle.corners(0.041))
        assert np.abs(corners[:, 1]).max() < 0.02
        assert corners[:, 0].max() > -half + 0.01
        assert corners[:, 0].min() < half


@settings(max_examples=10, deadline=None)
@given(BEARINGS)
def test_closed_fingers_do_not_touch_the_mug(bearing: float) -> None:
    handle = Handle(bearing, 0.072, -0.023, 0.03)
    thing = mug()
    body = surface_of(thing)
    for grasp in handle_grasps(thing, handle, MODEL.description.hand, MODEL.palm, MODEL.fingers_at):
        own = grasp.object_from_grasp.inverse().apply(body)
        for planes in MODEL.fingers_at(THICK):
            assert not (own @ planes[:, :3].T + planes[:, 3] < 0.0).all(axis=1).any()


def test_fingers_that_closed_on_a_handle_are_not_as_wide_as_its_mug() -> None:
    handle = Handle(0.0, 0.072, -0.023, 0.03)
    held = handle_grasps(mug(), handle, MODEL.description.hand, MODEL.palm, MODEL.fingers_at)[0]
    assert held.fits(0.010, 0.012)
    assert not held.fits(0.082, 0.012)
    assert not held.fits(THINNEST / 2, 0.012)


@pytest.mark.parametrize("bearing", [math.pi, math.pi / 2])
def test_a_mug_is_picked_by_its_handle(
    tabletop: type[Tabletop], scene_of: SceneOf, bearing: float
) -> None:
    robot = tabletop(None)
    x, y = AT[0] + 0.056 * math.cos(bearing), AT[1] + 0.056 * math.sin(bearing)
    along = (0.032, 0.010, 0.055) if abs(math.cos(bearing)) > 0.5 else (0.010, 0.032, 0.055)
    robot.others = [Round((*AT, TABLE), SIZE[2], SIZE[0] / 2), Block(along, (x, y, TABLE + 0.05))]
    arm = arm_of(robot, scene_of(robot))
    thing = mug()
    arm.scene.support_below(thing)
    plan = plan_pick(arm, thing, 0.12, "handle")
    assert plan.grasp.part == "handle"
    across = plan.grasp.object_from_grasp.rotation[:2, 1]
    assert abs(float(across @ (math.cos(bearing), math.sin(bearing)))) < 0.2


@pytest.mark.parametrize(
    ("by", "why"),
    [
        ("handle", "to be held by its handle: handle: no picture shows one"),
        ("rim", "to be held by its rim: rim: no picture shows room for a finger"),
    ],
)
def test_what_has_no_such_part_is_no_grasp(
    tabletop: type[Tabletop], scene_of: SceneOf, by: str, why: str
) -> None:
    robot = tabletop(None)
    robot.others = [Round((*AT, TABLE), SIZE[2], SIZE[0] / 2)]
    arm = arm_of(robot, scene_of(robot))
    with pytest.raises(Failure, match=why) as failed:
        plan_pick(arm, mug(category="can"), 0.12, by)  # type: ignore[arg-type]
    assert failed.value.value.code == "NO_GRASP"
    assert by in failed.value.value.data["sides"]
