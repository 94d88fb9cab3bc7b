"""detect_plane: the surface, what stands on it, and room for what is held."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from momantu_skills.detect_plane import DetectPlane

from momantu_bt.claim import PlaneAt, RoomAt
from momantu_bt.geometry import Pose, Pose2D, Transform, quaternion_from_rpy
from momantu_bt.messages import DetectedObject, SupportPlane
from momantu_bt.service import HeldObject
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill
from momantu_bt.testing.painting import Block, Round, Solid

TOP = 0.5
TABLE = Block((0.6, 1.2, 0.03), (1.0, 0.0, TOP - 0.015))
NEAR = (0.95, 0.1)
MOUNTING = Transform((0.002, -0.001, 0.002), quaternion_from_rpy(0.004, 0.0, -0.003))


@pytest.fixture
def measure(
    onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[..., Any]
) -> Callable[..., SkillResult]:
    """`measure(things, size=…, held=…)` runs the skill at NEAR."""

    def run(
        things: Sequence[Solid],
        *,
        held: HeldObject | None = None,
        height: float = TOP,
        table: Sequence[Solid] = (TABLE,),
        base: Pose2D | None = None,
        **inputs: Any,
    ) -> SkillResult:
        robot = onlooker([*table, *things], mounting=MOUNTING, seed=9)
        robot.joints["lift"] = 0.3
        robot.base = base or robot.base
        near = Pose(Transform((*NEAR, height)), "odom", 0.0)
        return run_skill(
            DetectPlane,
            robot=robot,
            inputs={"near": near, **inputs},
            services={"planning_scene": seen_scene(held=held)},
        )

    return run


Measure = Callable[..., SkillResult]


def spots_of(result: SkillResult) -> np.ndarray:
    assert result.status == "SUCCESS", result.explain()
    return np.array([spot.position for spot in result.outputs["spots"]])


def test_height_outline_and_obstacles_are_measured(measure: Measure) -> None:
    result = measure([Round((0.9, -0.15, TOP), 0.13, 0.035)], size=(0.07, 0.07, 0.13))
    assert result.status == "SUCCESS", result.explain()
    plane: SupportPlane = result.outputs["plane"]
    assert plane.pose.position == pytest.approx((*NEAR, TOP), abs=0.006)
    outline = np.array(plane.outline) + NEAR
    assert outline[:, 0].min() == pytest.approx(0.7, abs=0.02)
    assert outline[:, 0].max() == pytest.approx(1.3, abs=0.03)
    ((x, y, radius, height),) = plane.obstacles
    assert (x + NEAR[0], y + NEAR[1]) == pytest.approx((0.9, -0.15), abs=0.015)
    assert 0.025 < radius < 0.05
    assert height == pytest.approx(0.13, abs=0.006)


def test_spots_keep_their_distances(measure: Measure) -> None:
    things = [Round((0.85, 0.3, TOP), 0.2, 0.03), Round((0.95, -0.15, TOP), 0.1, 0.04)]
    spots = spots_of(measure(things, size=(0.07, 0.07, 0.13)))
    assert 2 <= len(spots) <= 8
    assert np.abs(spots[:, 2] - TOP).max() < 0.006
    assert np.linalg.norm(spots[:, :2] - NEAR, axis=1).max() < 0.36
    for thing in things:
        apart = np.linalg.norm(spots[:, :2] - thing.foot[:2], axis=1)
        assert apart.min() > thing.radius + 0.035 + 0.05
    margin = np.minimum(0.3 - np.abs(spots[:, 0] - 1.0), 0.6 - np.abs(spots[:, 1]))
    assert margin.min() > 0.035 + 0.02
    gaps = [np.linalg.norm(a - b) for n, a in enumerate(spots) for b in spots[:n]]
    assert min(gaps) > 0.05


def test_the_tag_itself_is_left_free_where_there_is_other_room(measure: Measure) -> None:
    spots = spots_of(measure([], size=(0.07, 0.07, 0.13)))
    assert np.linalg.norm(spots[0, :2] - NEAR) > 0.1


def test_spots_face_away_from_the_robot(measure: Measure) -> None:
    result = measure([], size=(0.07, 0.07, 0.13), base=Pose2D(0.1, -0.2, 0.2))
    assert result.status == "SUCCESS", result.explain()
    for spot in result.outputs["spots"]:
        assert spot.transform.yaw == pytest.approx(0.2, abs=1e-6)
        assert spot.transform.rotation[2, 2] == pytest.approx(1.0)


def test_what_is_held_decides_how_much_room_is_needed(measure: Measure) -> None:
    crowd = [Round((0.85, 0.1 + 0.22 * n, TOP), 0.12, 0.03) for n in (-1, 1)]
    held = DetectedObject(
        "can", Pose(Transform(), "odom", 0.0), (0.07, 0.07, 0.13), "cylinder", 1.0, TOP
    )
    small = spots_of(measure(crowd, held=HeldObject(held, Transform())))
    assert len(small) > 0
    wide = DetectedObject("box", Pose(Transform(), "odom", 0.0), (0.4, 0.4, 0.1), "box", 1.0, TOP)
    result = measure(crowd, held=HeldObject(wide, Transform()))
    assert result.code == "NO_FREE_SPOT"
    assert "0.57 m across; 2 things" in result.explain()


def test_no_surface_at_that_height(measure: Measure) -> None:
    assert measure([], height=0.8).code == "PLANE_NOT_FOUND"
    assert measure([], table=()).code == "PLANE_NOT_FOUND"


def test_a_place_behind_the_robot_cannot_be_measured(measure: Measure) -> None:
    assert measure([], base=Pose2D(0.0, 0.0, math.pi)).code == "PLANE_NOT_FOUND"


def test_what_no_look_showed_is_not_free(measure: Measure) -> None:
    spots = spots_of(measure([Block((0.02, 0.3, 0.6), (0.78, 0.1, TOP + 0.3))], size=(0.07, 0.07)))
    hidden = (np.abs(spots[:, 1] - 0.1) < 0.15) & (spots[:, 0] > 0.8)
    assert not hidden.any()


def test_a_top_and_room_at_the_best_spot_are_claimed(measure: Measure) -> None:
    result = measure([], size=(0.06, 0.08, 0.13))
    claim = result.claim()
    assert isinstance(claim, tuple)
    plane, room = claim
    assert isinstance(plane, PlaneAt)
    assert isinstance(room, RoomAt)
    assert plane.odom_from_plane == result.outputs["plane"].pose.transform
    assert room.odom_point == tuple(result.outputs["spots"][0].position)
    assert (room.radius, room.within) == (pytest.approx(0.05), 0.0)


def test_room_or_a_top_after_all_would_be_a_false_alarm(measure: Measure) -> None:
    claim = measure([], size=(0.7, 0.7)).claim()
    assert isinstance(claim, RoomAt)
    assert claim.odom_point == pytest.approx((*NEAR, TOP))
    assert claim.radius > 0.7 / math.sqrt(2)
    assert claim.within == pytest.approx(0.35)
    claim = measure([], height=0.8).claim()
    assert isinstance(claim, PlaneAt)
    assert claim.odom_from_plane.position == pytest.approx((*NEAR, 0.8))
