"""Wide things by their rim: one finger inside, and only where pictures showed room for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.grasps import THICKEST, THINNEST, Grasp, grasps_for
from momantu_skills.manipulation.hand.reaching import plan_pick
from momantu_skills.manipulation.hand.rims import seen_hollow, wall_pieces
from momantu_skills.manipulation.model.arm_model import arm_model
from momantu_worlds.robots import fetch

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose, Transform
from momantu_bt.messages import DetectedObject
from momantu_bt.testing.painting import Block, Round, Solid
from tests.skills.manipulation.test_motions import arm_of
from tests.skills.scenery.table import TABLE, SceneOf, Tabletop

MODEL = arm_model(fetch())
HAND = MODEL.description.hand
AT = (0.75, 0.0)
WIDE = st.tuples(st.floats(0.11, 0.18), st.floats(0.05, 0.09))


def wide(shape: str, size: tuple[float, float, float]) -> DetectedObject:
    pose = Pose(Transform((*AT, TABLE + size[2] / 2)), "odom", 0.0)
    return DetectedObject("bowl", pose, size, shape, 0.9, TABLE)


def grasps(thing: DetectedObject) -> list[Grasp]:
    return grasps_for(thing, HAND, MODEL.palm, MODEL.open_fingers)


@given(WIDE, st.sampled_from(["cylinder", "box"]))
def test_the_pads_straddle_the_rim(bowl: tuple[float, float], shape: str) -> None:
    size = (bowl[0], bowl[0], bowl[1])
    found = grasps(wide(shape, size))
    assert found
    for grasp in found:
        assert grasp.rim
        r, p = grasp.object_from_grasp.rotation, grasp.object_from_grasp.position
        assert r[2, 0] == pytest.approx(-1.0)
        outward = r[:2, 1] * np.sign(r[:2, 1] @ p[:2])
        # the outline is half a wall outside of the pads' middle
        beyond = bowl[0] / 2 - float(outward @ p[:2])
        assert beyond == pytest.approx(grasp.width / 2)
        tips = p[2] - HAND.pad_length / 2
        assert tips >= -bowl[1] / 2 + 0.025 - 1e-9
        assert bowl[1] / 2 - tips >= 0.02 - 1e-9


def test_what_fits_between_the_fingers_is_not_taken_by_its_rim() -> None:
    for shape, size in (("cylinder", (0.08, 0.08, 0.09)), ("box", (0.07, 0.16, 0.09))):
        assert not any(grasp.rim for grasp in grasps(wide(shape, size)))


def test_a_plate_has_no_rim_for_the_fingers() -> None:
    assert grasps(wide("cylinder", (0.2, 0.2, 0.03))) == []


@given(st.floats(0.0, 0.05))
def test_closed_fingers_hold_no_wall(width: float) -> None:
    rim = Grasp(Transform(), 0.010, 0.0, "rim")
    assert rim.fits(width, 0.012) is (THINNEST <= width <= THICKEST)
    assert Grasp(Transform(), 0.010, 0.0).fits(width, 0.012) is (width <= 0.022)


@settings(max_examples=20)
@given(WIDE, st.sampled_from(["cylinder", "box"]))
def test_walls_surround_an_empty_inside(bowl: tuple[float, float], shape: str) -> None:
    thing = wide(shape, (bowl[0], bowl[0], bowl[1]))
    for corners in wall_pieces(thing):
        assert np.linalg.norm(corners[:, :2], axis=1).min() > bowl[0] / 2 - 0.02
        assert np.abs(corners[:, :2]).max() <= bowl[0] / 2 + 1e-9
        assert np.ptp(corners[:, 2]) == pytest.approx(bowl[1])


def seen(tabletop: type[Tabletop], scene_of: SceneOf, solid: Solid) -> Arm:
    robot = tabletop(None)
    robot.others = [solid]
    return arm_of(robot, scene_of(robot))


@pytest.mark.parametrize(("across", "height"), [(0.12, 0.05), (0.15, 0.06), (0.18, 0.07)])
def test_a_bowl_is_picked_by_its_rim(
    tabletop: type[Tabletop], scene_of: SceneOf, across: float, height: float
) -> None:
    bowl = Round((*AT, TABLE), height, 0.3 * across, across / 2, hollow=True)
    arm = seen(tabletop, scene_of, bowl)
    thing = wide("cylinder", (across, across, height))
    arm.scene.support_below(thing)
    plan = plan_pick(arm, thing, 0.12)
    assert plan.grasp.rim
    way = [arm.group.tip_pose(q).position for q in plan.approach.positions]
    assert way[0][2] - way[-1][2] == pytest.approx(arm.hand.approach, abs=2e-3)


@pytest.mark.parametrize(
    ("shape", "solid"),
    [
        ("cylinder", Round((*AT, TABLE), 0.07, 0.075)),
        ("box", Block((0.15, 0.15, 0.07), (*AT, TABLE + 0.035))),
        ("cylinder", Round((*AT, TABLE), 0.07, 0.075, hollow=True)),
    ],
)
def test_what_is_closed_or_full_is_not(
    tabletop: type[Tabletop], scene_of: SceneOf, shape: str, solid: Solid
) -> None:
    arm = seen(tabletop, scene_of, solid)
    thing = wide(shape, (0.15, 0.15, 0.07))
    open_above = isinstance(solid, Round) and solid.hollow
    space = arm.scene.seen_space
    hollow = [seen_hollow(space, thing, g, MODEL.open_fingers) for g in grasps(thing)]
    assert any(hollow) is open_above
    if not open_above:
        with pytest.raises(Failure, match="no picture shows room for a finger"):
            plan_pick(arm, thing, 0.12)


def test_what_nobody_looked_into_is_not_hollow(tabletop: type[Tabletop], scene_of: SceneOf) -> None:
    solid = Round((0.75, 0.4, TABLE), 0.07, 0.075, hollow=True)
    arm = seen(tabletop, scene_of, solid)
    away = Transform((0.75, 2.4, TABLE + 0.035))
    thing = DetectedObject(
        "bowl", Pose(away, "odom", 0.0), (0.15, 0.15, 0.07), "cylinder", 1, TABLE
    )
    space = arm.scene.seen_space
    assert not any(seen_hollow(space, thing, g, MODEL.open_fingers) for g in grasps(thing))
