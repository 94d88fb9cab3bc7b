"""relocalize: mends a doubtful estimate, finds itself from nowhere, or says that it cannot."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from momantu_skills.navigation.localize.confidence import is_localized
from momantu_skills.navigation.localize.service import LocalizationService
from momantu_skills.relocalize import Relocalize

from momantu_bt.claim import BaseAt
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot
from momantu_bt.testing.skill_run import SkillResult, run_skill
from tests.skills.scenery.flat import Box, Flat, FlatSceneOf
from tests.skills.scenery.table import SceneOf

Found = tuple[SkillResult, LocalizationService]
Relocate = Callable[..., Found]


TWINS: tuple[Box, ...] = (
    *((x, 0.0, x + 0.1, 3.0) for x in (0.0, 3.1, 6.2)),
    (0.0, -0.1, 6.3, 0.0),
    *((x, 2.9, x + 1.0, 3.0) for x in (0.1, 2.1, 3.2, 5.2)),
    (0.0, 4.8, 9.0, 4.9),
    (0.0, 2.9, 0.1, 4.9),
    (9.0, 2.9, 9.1, 4.9),
    (6.2, 2.9, 9.0, 3.0),
    *((x + 0.5, 0.0, x + 1.1, 0.6) for x in (0.1, 3.2)),
)
"""Two equal rooms of 3 m x 3 m, each with a box and a doorway to a corridor whose ends differ."""
CLOSED = (*TWINS, (1.0, 2.9, 2.2, 3.0), (4.1, 2.9, 5.3, 3.0))
"""The same with walls in the place of the doorways."""
AROUND: Box = (-0.5, -0.5, 9.5, 5.4)
OUTSIDE: Box = (30.0, 30.0, 31.0, 31.0)


@pytest.fixture
def relocalize(flat_scene: FlatSceneOf) -> Relocate:
    """`relocalize(world, **inputs)` with localization and a planning scene."""

    def run(world: Any, scene: Any = None, **inputs: Any) -> Found:
        return _run(world, scene or flat_scene(world), **inputs)

    return run


def _run(world: Any, scene: Any, on_tick: Any = None, **inputs: Any) -> Found:
    service = LocalizationService()
    services = {"localization": service, "planning_scene": scene}
    result = run_skill(
        Relocalize, world=world, services=services, inputs=inputs, max_time=60.0, on_tick=on_tick
    )
    return result, service


def test_a_small_error_is_mended_without_moving(flat: Flat, relocalize: Relocate) -> None:
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(-1.8, 0.2, 0.2))
    result, service = relocalize(world)
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
    flat: Flat, relocalize: Relocate, truth: Pose2D, believed: Pose2D
) -> None:
    world = flat(truth, believed=believed)
    result, service = relocalize(world)
    assert result.status == "SUCCESS", result.explain()
    assert service.map_from_base.distance_to(world.robot.truth) < 0.05
    assert is_localized(service)
    assert world.robot.nearest > 0.0


def test_everywhere_begins_with_the_whole_map(flat: Flat, relocalize: Relocate) -> None:
    result, service = relocalize(flat(Pose2D(3.0, 1.8, 2.0)), everywhere=True)
    assert result.status == "SUCCESS", result.explain()
    assert service.map_from_base.distance_to(result.robot.truth) < 0.05  # type: ignore[attr-defined]
    assert "turn" in result.phases


@pytest.mark.parametrize("room", [0.0, 3.1])
def test_two_equal_rooms_are_told_apart_by_driving(
    flat: Flat, relocalize: Relocate, room: float
) -> None:
    start = Pose2D(1.9 + room, 1.4, 0.6)
    world = flat(start, rooms=TWINS, span=AROUND, desk=OUTSIDE)
    result, service = relocalize(world, everywhere=True)
    assert result.status == "SUCCESS", result.explain()
    assert service.map_from_base.distance_to(world.robot.truth) < 0.1
    assert world.robot.truth.distance_to(start) > 0.5
    assert world.robot.nearest > 0.0
    assert result.duration < 32.0


def test_two_equal_rooms_without_a_way_out_are_not_guessed(
    flat: Flat, relocalize: Relocate
) -> None:
    world = flat(Pose2D(1.9, 1.4, 0.6), rooms=CLOSED, span=AROUND, desk=OUTSIDE)
    result, service = relocalize(world, everywhere=True)
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert result.failure is not None
    assert "places on the map look alike" in result.failure.message
    assert len(result.failure.data["places"]) >= 2
    assert not is_localized(service)
    assert world.robot.nearest > 0.0


def test_not_localized_where_the_map_is_of_another_place(flat: Flat, relocalize: Relocate) -> None:
    """The laser sees a narrow cell that is not on the map."""
    world = flat(Pose2D(20.0, 20.0, 0.0), believed=Pose2D(-2.0, 0.0, 0.0))
    world.robot.boxes += [
        (19.2, 19.2, 19.3, 20.8),
        (20.7, 19.2, 20.8, 20.8),
        (19.2, 19.2, 20.8, 19.3),
        (19.2, 20.7, 20.8, 20.8),
    ]
    result, _ = relocalize(world)
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert result.duration < 30.0
    assert abs(world.robot.angular) < 0.01


def test_it_does_not_turn_into_what_stands_beside_it(flat: Flat, relocalize: Relocate) -> None:
    """A rectangular base between two boards, where its corners would touch."""
    world = flat(
        Pose2D(-2.0, 0.0, 0.0),
        believed=Pose2D(3.0, 2.0, 0.0),
        hidden=[(-2.3, 0.24, -1.7, 0.26), (-2.3, -0.26, -1.7, -0.24)],
    )
    result, _ = relocalize(world)
    assert world.robot.nearest > 0.0, result.explain()


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_arm_that_sticks_out_is_not_turned_into_a_wall(
    flat: Flat, flat_scene: FlatSceneOf, relocalize: Relocate, side: float
) -> None:
    """The wall stands beside what sticks out, on one side; the other way round there is room."""
    wall = sorted((0.15 * side, 0.25 * side))
    start = Pose2D(-2.0, 0.0, 0.0)
    world = flat(start, believed=Pose2D(3.0, 2.0, 0.0), hidden=[(-1.6, wall[0], -1.3, wall[1])])
    scene = flat_scene(world)
    tip = scene.outline[:, 0].max() + 0.3
    scene.load = (0.5, np.array([[tip, -0.03], [tip, 0.03]]))
    ahead: list[float] = []

    def note(*_: Any) -> None:
        arm = np.array([[scene.outline[:, 0].max() + 0.05 * k, 0.0] for k in range(7)])
        c, s = math.cos(world.robot.truth.yaw), math.sin(world.robot.truth.yaw)
        places = arm @ np.array([[c, s], [-s, c]]) + (world.robot.truth.x, world.robot.truth.y)
        ahead.append(float(world.robot.distance(places).min()))

    result, _service = relocalize(world, scene, on_tick=note)
    assert min(ahead) > 0.0, result.explain()
    turned = [goal.angular for _, name, goal in world.robot.commands if name == "base" and goal]
    assert min(turned) < 0.0 < max(turned)


def test_the_base_is_claimed_to_be_where_it_is_believed_to_be(
    flat: Flat, relocalize: Relocate
) -> None:
    world = flat(Pose2D(-2.0, 0.0, 0.0), believed=Pose2D(-1.8, 0.2, 0.2))
    result, service = relocalize(world)
    claim = result.claim()
    assert isinstance(claim, BaseAt)
    assert claim.map_from_base == service.map_from_base
    assert claim.map_from_base.distance_to(world.robot.truth) < claim.tolerance


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: SceneOf
) -> None:
    scene = scene_of(stretched_out)
    services = {"localization": object(), "planning_scene": scene}
    result = run_skill(
        Relocalize, robot=stretched_out, inputs={}, services=services, frames=scene.frames
    )
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)
