"""check: each question is answered from the robot's beliefs, both ways."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from momantu_skills.check import Check
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.hand import between_pads
from momantu_skills.manipulation.hand.between_pads import View
from momantu_skills.manipulation.hand.weighing import FEELING
from momantu_skills.manipulation.scene.holding import Fingers
from momantu_skills.manipulation.scene.payload import Weight

from momantu_bt.claim import BaseAt, GripperOpen, Holding
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot, run_skill, small_robot
from momantu_bt.tree.load import TreeError, load


def check(what: str, *, robot: Any = None, place: str | None = None, **beliefs: Any) -> Any:
    localization = SimpleNamespace(
        map_from_base=beliefs.get("at", Pose2D(0.0, 0.0)),
        covariance=np.diag([1.0, 1.0, 1.0]) * beliefs.get("sigma", 0.01) ** 2,
        quality=beliefs.get("quality", 0.9),
    )
    held = SimpleNamespace(object=SimpleNamespace(category="can"))
    holds = bool(beliefs.get("holding"))
    weights = beliefs.get("weights", lambda: beliefs.get("weight", CAN if holds else None))
    fingers = beliefs.get("fingers", Fingers(0.07, 45.0) if holds else Fingers(0.1, 0.0))
    scene = SimpleNamespace(
        held=held if holds else None,
        holding=SimpleNamespace(fingers=fingers),
        payload=SimpleNamespace(weigh=lambda robot: weights(), raised=bool(beliefs.get("raised"))),
        scene=SimpleNamespace(config=SceneConfig()),
    )
    services = {"localization": localization, "planning_scene": scene}
    inputs = {"what": what, "place": place}
    return run_skill(Check, robot=robot or ScriptedRobot(), inputs=inputs, services=services)


@pytest.mark.parametrize(
    ("what", "beliefs"),
    [
        ("holding", {"holding": True}),
        ("not_holding", {}),
        ("localized", {}),
        ("near", {"place": "start"}),
        ("near", {"place": "table_a", "at": Pose2D(1.0, 0.3)}),
        ("near", {"place": "table_a", "at": Pose2D(2.1, 0.3)}),
        ("gripper_open", {}),
    ],
)
def test_what_holds(what: str, beliefs: Any) -> None:
    result = check(what, **beliefs)
    assert result.status == "SUCCESS", result.explain()
    assert result.ticks == 1


@pytest.mark.parametrize(
    ("what", "beliefs", "code"),
    [
        ("holding", {}, "NOT_HOLDING"),
        ("not_holding", {"holding": True}, "HOLDING"),
        ("localized", {"sigma": 0.5}, "NOT_LOCALIZED"),
        ("localized", {"quality": 0.1}, "NOT_LOCALIZED"),
        ("near", {"place": "start", "at": Pose2D(3.0, 0.0)}, "NOT_NEAR"),
        ("near", {"place": "table_a", "at": Pose2D(-0.5, 0.0)}, "NOT_NEAR"),
        ("near", {"place": "shelf"}, "BAD_QUESTION"),
        ("hoding", {}, "WRONG_TYPE"),
    ],
)
def test_what_does_not_hold(what: str, beliefs: Any, code: str) -> None:
    assert check(what, **beliefs).code == code


LIGHT, VAGUE, CAN = Weight(0.0, 0.25, 0.06), Weight(0.0, 0.25, 0.6), Weight(3.9, 0.25, 0.06)
"""What the wrist measures of nothing, of nothing with a sensor that is not zeroed, of a can."""
PRESSING = Fingers(0.07, 45.0)


def look(monkeypatch: pytest.MonkeyPatch, view: View) -> None:
    monkeypatch.setattr(between_pads, "between_pads", lambda scene, snapshot: view)
    monkeypatch.setattr(
        "momantu_skills.manipulation.hand.weighing.take", lambda robot, frames: None
    )


@pytest.mark.parametrize(
    ("beliefs", "code"),
    [
        ({"fingers": Fingers(0.04, 44.0), "weight": CAN}, None),
        ({"fingers": Fingers(0.083, 44.0), "weight": CAN}, None),
        ({"fingers": Fingers(0.04, 0.2), "weight": LIGHT, "holding": True}, "NOT_HOLDING"),
        ({"fingers": Fingers(0.0, 44.0), "weight": LIGHT, "holding": True}, "NOT_HOLDING"),
    ],
)
def test_the_hand_is_asked_and_not_an_earlier_belief(beliefs: Any, code: str | None) -> None:
    result = check("holding", **beliefs)
    assert result.code == code, result.explain()
    assert result.ticks == 1


@pytest.mark.parametrize(
    ("weight", "view", "holding", "not_holding"),
    [
        (VAGUE, View(60, 0.0), "HOLDING_UNKNOWN", "HOLDING_UNKNOWN"),
        (VAGUE, View(0, 1.0), "NOT_HOLDING", None),
        (LIGHT, View(0, 0.0), "HOLDING_UNKNOWN", "HOLDING_UNKNOWN"),
        (LIGHT, View(60, 0.0), "HOLDING_UNKNOWN", "HOLDING_UNKNOWN"),
        (LIGHT, View(0, 1.0), "NOT_HOLDING", None),
        (None, View(60, 0.0), "HOLDING_UNKNOWN", "HOLDING_UNKNOWN"),
    ],
)
def test_what_the_fingers_do_not_decide_is_weighed_and_looked_at(
    monkeypatch: pytest.MonkeyPatch,
    weight: Weight | None,
    view: View,
    holding: str | None,
    not_holding: str | None,
) -> None:
    """Fingers that press while nothing weighs: jammed ones, or something very light."""
    look(monkeypatch, view)
    for what, code in (("holding", holding), ("not_holding", not_holding)):
        result = check(what, fingers=PRESSING, weight=weight)
        assert result.code == code, result.explain()
        assert result.phases == ("feeling",)
        assert result.ticks == FEELING + 1


def test_what_hangs_on_fingers_that_do_not_press_is_no_loss(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    look(monkeypatch, View(0, 0.0))
    result = check("holding", fingers=Fingers(0.06, 0.1), weight=CAN, holding=True)
    assert result.code == "HOLDING_UNKNOWN"
    assert result.claim() is None, "it says neither"
    assert "carries 3.9 N" in result.failure.message
    assert "to find out" in result.failure.message
    assert result.failure.data["fingers"] < 0.0 < result.failure.data["weight"]


def test_fingers_that_press_on_nothing_that_weighs_hold_nothing_once_they_were_raised() -> None:
    beliefs: dict[str, Any] = {"fingers": PRESSING, "weight": LIGHT, "raised": True}
    assert check("holding", **beliefs).code == "NOT_HOLDING"
    assert check("not_holding", **beliefs).status == "SUCCESS"


def test_one_noisy_weight_does_not_make_jammed_fingers_hold_something(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    look(monkeypatch, View(0, 0.0))
    readings = iter([0.7, *[0.0, 0.1] * FEELING])

    result = check("holding", fingers=PRESSING, weights=lambda: Weight(next(readings), 0.25, 0.06))
    assert result.code == "HOLDING_UNKNOWN"


def test_without_a_camera_that_works_it_cannot_tell() -> None:
    robot = ScriptedRobot()
    robot.dead.add(robot.description.camera()[0])
    result = check("holding", robot=robot, fingers=PRESSING, weight=LIGHT)
    assert result.code == "HOLDING_UNKNOWN"
    assert "does not answer" in result.failure.message


def test_a_robot_without_a_hand_holds_nothing() -> None:
    handless = small_robot().model_copy(update={"end_effector": None})
    assert check("holding", robot=ScriptedRobot(handless)).code == "NOT_HOLDING"
    assert check("not_holding", robot=ScriptedRobot(handless)).status == "SUCCESS"


def test_a_closed_gripper_is_not_open() -> None:
    assert check("gripper_open", robot=ScriptedRobot(gripper_width=0.01)).code == "NOT_OPEN"


def test_a_misspelt_question_is_found_before_the_run(tmp_path: Path) -> None:
    tree = tmp_path / "ask.yaml"
    tree.write_text("momantu_bt: 1\nworld: four_rooms\ntrees:\n  Main:\n    check: hoding\n")
    with pytest.raises(TreeError) as caught:
        load(str(tree))
    (problem,) = caught.value.problems
    assert problem.place.line == 5
    assert "holding" in f"{problem.message} {problem.hint}"


@pytest.mark.parametrize("beliefs", [{}, {"holding": True}])
def test_what_is_held_is_claimed_as_asked_whatever_is_believed(beliefs: Any) -> None:
    """After "no" it is the sentence that would show the answer to be wrong."""
    assert check("holding", **beliefs).claim() == Holding(True)
    assert check("not_holding", **beliefs).claim() == Holding(False)


def test_where_it_is_is_claimed_of_the_estimate_whether_it_is_trusted_or_not() -> None:
    here = Pose2D(1.0, 2.0, 0.3)
    for sigma in (0.01, 0.5):
        claim = check("localized", at=here, sigma=sigma).claim()
        assert isinstance(claim, BaseAt)
        assert claim.map_from_base == here
        assert 0.05 < claim.tolerance < 0.2


@pytest.mark.parametrize(
    ("place", "at", "nearest"),
    [
        ("start", Pose2D(0.5, 0.5), (0.0, 0.0)),
        ("table_a", Pose2D(0.6, 0.3), (1.6, 0.3)),
        ("table_a", Pose2D(2.1, 5.0), (2.1, 0.6)),
        ("table_a", Pose2D(2.1, 0.3), (2.1, 0.3)),
    ],
)
def test_near_is_claimed_of_the_nearest_point(
    place: str, at: Pose2D, nearest: tuple[float, float]
) -> None:
    result = check("near", place=place, at=at)
    claim = result.claim()
    assert isinstance(claim, BaseAt)
    assert (claim.map_from_base.x, claim.map_from_base.y) == pytest.approx(nearest)
    said = at.distance_to(Pose2D(*nearest)) <= 1.5
    assert (result.status == "SUCCESS") is said
    assert (claim.tolerance > 1.5) is said


@pytest.mark.parametrize("share", [0.85, 0.95])
def test_an_open_gripper_is_claimed_with_room_for_its_gauge(share: float) -> None:
    widest = ScriptedRobot().description.end_effector.max_width
    result = check("gripper_open", robot=ScriptedRobot(gripper_width=share * widest))
    claim = result.claim()
    assert isinstance(claim, GripperOpen)
    assert claim.width == pytest.approx(0.9 * widest, abs=0.004)
    assert (claim.width < 0.9 * widest) is (result.status == "SUCCESS")


@pytest.mark.parametrize("what", ["near", "hoding"])
def test_what_is_no_answer_claims_nothing(what: str) -> None:
    assert check(what, place="shelf").claim() is None
