"""relocalize: mends a doubtful estimate, finds itself from nowhere, or says that it cannot."""

from typing import Any

import pytest
from momantu_skills.navigation.confidence import is_localized
from momantu_skills.navigation.service import LocalizationService
from momantu_skills.relocalize import Relocalize

from momantu_bt.claim import BaseAt
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot
from momantu_bt.testing.skill_run import SkillResult, run_skill


def _run(world: Any, **inputs: Any) -> tuple[SkillResult, LocalizationService]:
    service = LocalizationService()
    services = {"localization": service, "planning_scene": object()}
    result = run_skill(Relocalize, world=world, services=services, inputs=inputs, max_time=60.0)
    return result, service


def test_a_small_error_is_mended_without_moving(flat: Any) -> None:
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(-1.8, 0.2, 0.2))
    result, service = _run(world)
    assert result.status == "SUCCESS", result.explain()
    assert result.phases == ("look",)
    assert service.map_from_base.distance_to(world.robot.truth) < 0.05


@pytest.mark.parametrize(
    ("truth", "believed"),
    [
        (Pose2D(-2.0, -1.0, -2.0), Pose2D(3.0, 2.0, 0.0)),
        (Pose2D(2.5, -2.0, 1.0), Pose2D(-3.0, 2.0, 0.0)),
    ],
)
def test_in_the_wrong_room_it_searches_the_whole_map(
    flat: Any, truth: Pose2D, believed: Pose2D
) -> None:
    world = flat(truth, believed=believed)
    result, service = _run(world)
    assert result.status == "SUCCESS", result.explain()
    assert service.map_from_base.distance_to(world.robot.truth) < 0.05
    assert is_localized(service)
    assert world.robot.nearest > 0.0


def test_everywhere_begins_with_the_whole_map(flat: Any) -> None:
    result, service = _run(flat(Pose2D(3.0, 1.8, 2.0)), everywhere=True)
    assert result.status == "SUCCESS", result.explain()
    assert service.map_from_base.distance_to(result.robot.truth) < 0.05  # type: ignore[attr-defined]
    assert "turn" in result.phases


def test_not_localized_where_the_map_is_of_another_place(flat: Any) -> None:
    """The laser sees a narrow cell that is not on the map."""
    world = flat(Pose2D(20.0, 20.0, 0.0), believed=Pose2D(-2.0, 0.0, 0.0))
    world.robot.boxes += [
        (19.2, 19.2, 19.3, 20.8),
        (20.7, 19.2, 20.8, 20.8),
        (19.2, 19.2, 20.8, 19.3),
        (19.2, 20.7, 20.8, 20.8),
    ]
    result, _ = _run(world)
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert result.duration < 30.0
    assert abs(world.robot.angular) < 0.01


def test_it_does_not_turn_into_what_stands_beside_it(flat: Any) -> None:
    """A rectangular base between two boards, where its corners would touch."""
    world = flat(
        Pose2D(-2.0, 0.0, 0.0),
        believed=Pose2D(3.0, 2.0, 0.0),
        hidden=[(-2.3, 0.24, -1.7, 0.26), (-2.3, -0.26, -1.7, -0.24)],
    )
    result, _ = _run(world)
    assert world.robot.nearest > 0.0, result.explain()


def test_the_base_is_claimed_to_be_where_it_is_believed_to_be(flat: Any) -> None:
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(-1.8, 0.2, 0.2))
    result, service = _run(world)
    claim = result.claim()
    assert isinstance(claim, BaseAt)
    assert claim.map_from_base == service.map_from_base
    assert claim.map_from_base.distance_to(world.robot.truth) < claim.tolerance


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: Any
) -> None:
    scene = scene_of(stretched_out)
    services = {"localization": object(), "planning_scene": scene}
    result = run_skill(
        Relocalize, robot=stretched_out, inputs={}, services=services, frames=scene.frames
    )
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)
