"""detect_object: the asked thing among others, its size and place, or that it is not there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from momantu_skills.detect_object import DetectObject

from momantu_bt.claim import ObjectAt, ObjectOn
from momantu_bt.detector import DETECTORS, DetectorError
from momantu_bt.geometry import Pose2D, Transform, quaternion_from_rpy
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.testing import ScriptedRobot, SkillResult, run_skill, scripted_site
from momantu_bt.testing.painting import Block, Round, Solid
from momantu_bt.world import Surface
from tests.skills.scenery.onlooker import SeenScene

TOP = 0.72
"""m; the table is 2 cm lower than the site says, and 6 cm beside."""
TABLE = Block((0.6, 1.2, 0.03), (1.06, -0.05, TOP - 0.015), 0.05)
CAN = ObjectClass("can", diameter=0.07, height=0.13)
SITE = scripted_site(
    surfaces={"table": Surface(Pose2D(1.0, 0.0, 0.0), (0.6, 1.2), 0.74, (math.pi,))}
)
MOUNTING = Transform((0.002, -0.001, 0.002), quaternion_from_rpy(0.003, 0.0, -0.003))


def can(x: float, y: float, radius: float = 0.035, height: float = 0.13) -> Round:
    return Round((x, y, TOP), height, radius)


def bottle(x: float, y: float) -> list[Solid]:
    return [Round((x, y, TOP), 0.15, 0.032), Round((x, y, TOP + 0.15), 0.07, 0.013)]


BOX = Block((0.08, 0.06, 0.12), (0.95, 0.3, TOP + 0.06), 0.5)
MUG = Round((0.95, -0.3, TOP), 0.09, 0.04, hollow=True)
BOWL = Round((1.1, -0.45, TOP), 0.06, 0.04, 0.075, hollow=True)


@pytest.fixture
def detect(
    onlooker: Callable[..., ScriptedRobot], seen_scene: Callable[..., Any]
) -> Callable[..., SkillResult]:
    """`detect(solids, asked, on=…, …)` runs the skill before a table with those things."""

    def run(
        things: Sequence[Solid],
        asked: ObjectClass = CAN,
        *,
        scene: Any = None,
        table: Sequence[Solid] = (TABLE,),
        **inputs: Any,
    ) -> SkillResult:
        robot = onlooker([*table, *things], mounting=MOUNTING, seed=3)
        robot.joints["lift"] = 0.2
        services = {"planning_scene": scene or seen_scene(), "localization": None}
        return run_skill(
            DetectObject,
            robot=robot,
            inputs={"object": asked, "on": "table", **inputs},
            services=services,
            site=SITE,
            map_from_odom=Transform(),
        )

    return run


def assert_found(result: SkillResult, x: float, y: float, height: float = 0.13) -> DetectedObject:
    assert result.status == "SUCCESS", result.explain()
    found: DetectedObject = result.outputs["found"]
    assert np.hypot(*(found.pose.position[:2] - (x, y))) < 0.008
    assert found.pose.position[2] == pytest.approx(TOP + height / 2, abs=0.006)
    assert found.size[2] == pytest.approx(height, abs=0.006)
    assert found.pose.frame == "odom"
    return found


Detect = Callable[..., SkillResult]


def test_the_asked_can_among_similar_cans(detect: Detect) -> None:
    others = [can(0.95, -0.25, 0.028), can(1.0, -0.1, 0.044), can(0.9, 0.35, 0.035, 0.165)]
    result = detect([can(0.95, 0.15), *others])
    found = assert_found(result, 0.95, 0.15)
    assert found.size[:2] == pytest.approx((0.07, 0.07), abs=0.004)
    assert (found.category, found.shape) == ("can", "cylinder")
    assert found.score > 0.8


def test_the_planning_scene_sees_every_look(detect: Detect, seen_scene: type[SeenScene]) -> None:
    for things in ([can(0.95, 0.15)], []):
        scene = seen_scene()
        detect(things, scene=scene)
        assert scene.observed >= 2


def test_what_is_not_there_is_not_found_and_what_is_there_is_told(detect: Detect) -> None:
    result = detect([can(0.95, 0.1, 0.028), *bottle(0.9, -0.1), BOX, MUG, BOWL])
    assert result.code == "OBJECT_NOT_FOUND"
    assert result.failure is not None
    seen = sorted(text.split()[0] for text in result.failure.data["seen"])
    assert seen == ["bottle", "bowl", "box", "can", "mug"]
    can_told = next(t for t in result.explain().split("; ") if "can " in t and "narrow" in t)
    assert "mm too narrow (asked 70 ± 7 mm)" in can_told


def test_an_empty_table_is_said_to_be_empty(detect: Detect) -> None:
    result = detect([])
    assert result.code == "OBJECT_NOT_FOUND"
    assert "nothing stands there" in result.explain()


def test_other_categories_are_found_by_their_sizes(detect: Detect) -> None:
    result = detect([can(0.95, 0.1), *bottle(0.9, -0.1), MUG], ObjectClass("bottle", height=0.22))
    assert_found(result, 0.9, -0.1, 0.22)


def test_a_box_has_a_yaw(detect: Detect) -> None:
    result = detect([BOX, can(0.9, 0.0)], ObjectClass("box", height=0.12, width=0.08, depth=0.06))
    found = assert_found(result, 0.95, 0.3, 0.12)
    assert found.shape == "box"
    long_side = found.pose.transform.yaw + (math.pi / 2 if found.size[1] > found.size[0] else 0.0)
    assert math.sin(long_side - 0.5) == pytest.approx(0.0, abs=0.06)


def test_two_cans_that_touch_are_told_apart(detect: Detect) -> None:
    result = detect([can(0.9, 0.0), can(0.9, 0.064, 0.028)])
    assert_found(result, 0.9, 0.0)


def test_a_can_half_hidden_by_another_is_still_measured(detect: Detect) -> None:
    result = detect([can(0.95, 0.0), can(0.85, 0.03, 0.028, 0.10)])
    assert_found(result, 0.95, 0.0)


def test_the_robot_itself_is_not_an_object(detect: Detect, seen_scene: type[SeenScene]) -> None:
    arm = seen_scene(robot=[((0.8, -0.1, TOP - 0.02), (0.99, 0.1, 1.2))])
    assert detect([can(0.9, 0.0)], scene=arm).code == "OBJECT_NOT_FOUND"


def test_no_table_is_a_surface_not_seen(detect: Detect) -> None:
    result = detect([], table=())
    assert result.code == "SURFACE_NOT_SEEN"
    assert "table" in result.explain()


def test_an_unknown_surface_is_told_with_those_there_are(detect: Detect) -> None:
    result = detect([], on="shelf")
    assert result.code == "SURFACE_NOT_SEEN"
    assert "surfaces: table" in result.explain()


def test_more_views_are_taken_when_asked_and_runs_repeat_to_the_bit(detect: Detect) -> None:
    once, again = detect([can(0.95, 0.2)], views=1), detect([can(0.95, 0.2)], views=1)
    assert once.outputs["found"] == again.outputs["found"]
    many = detect([can(0.95, 0.2)], views=4)
    assert_found(many, 0.95, 0.2)
    assert many.duration > once.duration


def test_what_is_found_is_claimed_to_stand_there_as_asked(detect: Detect) -> None:
    result = detect([can(0.95, 0.15), BOX])
    claim = result.claim()
    assert isinstance(claim, ObjectAt)
    assert claim.asked == CAN
    assert claim.odom_from_object == result.outputs["found"].pose.transform
    true = (0.95, 0.15, TOP + 0.065)
    assert np.linalg.norm(claim.odom_from_object.position - true) < claim.tolerance < 0.035


def test_what_is_not_found_would_be_a_false_alarm_if_it_stood_there(detect: Detect) -> None:
    assert detect([BOX]).claim() == ObjectOn(CAN, "table")
    assert detect([], table=()).claim() is None


@pytest.mark.parametrize(
    "code", ["WEIGHTS_BROKEN", "WEIGHTS_FOREIGN", "WEIGHTS_OUTDATED", "CATEGORY_UNKNOWN"]
)
def test_a_detector_that_cannot_look_ends_the_search_with_its_code(
    detect: Callable[..., SkillResult], monkeypatch: pytest.MonkeyPatch, code: str
) -> None:
    class Blind:
        budget, accepted = 0.1, 1.0

        def detect(self, *_: Any) -> None:
            raise DetectorError(code, "the file weights.safetensors is of no use")

    monkeypatch.setattr(DETECTORS, "load", lambda _: Blind)
    result = detect([can(0.95, 0.1)])
    assert result.code == code
    assert "weights.safetensors" in result.explain()
