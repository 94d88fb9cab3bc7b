"""check: each question is answered from the robot's beliefs, both ways."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from momantu_skills.check import Check

from momantu_bt.claim import BaseAt, GripperOpen, Holding
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot, run_skill
from momantu_bt.tree.load import TreeError, load


def check(what: str, *, robot: Any = None, place: str | None = None, **beliefs: Any) -> Any:
    localization = SimpleNamespace(
        map_from_base=beliefs.get("at", Pose2D(0.0, 0.0)),
        covariance=np.diag([1.0, 1.0, 1.0]) * beliefs.get("sigma", 0.01) ** 2,
        quality=beliefs.get("quality", 0.9),
    )
    held = SimpleNamespace(object=SimpleNamespace(category="can"))
    scene = SimpleNamespace(held=held if beliefs.get("holding") else None)
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
