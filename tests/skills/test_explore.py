"""explore: the whole flat is known in the end, nothing is touched, and each code is provoked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from momantu_skills import explore
from momantu_skills.explore import Explore
from momantu_skills.mapping.service import MappingService

from momantu_bt.failure import Failure
from momantu_bt.formats.maps import FREE
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, scripted_site
from momantu_bt.testing.skill_run import run_skill
from tests.skills.scenery.flat import DESK, ROOMS, START, Box, FlatRobot, FlatScene
from tests.skills.scenery.table import SceneOf

FLOOR = 10.0 * 5.9 - 0.1 * 4.8 - 0.6 - 0.6 * 1.2
"""Square metres of the flat without its walls, the cupboard and the desk."""
DOORWAY: Box = (1.0, 0.4, 1.1, 1.5)

Tour = Callable[..., Any]


@pytest.fixture
def tour() -> Tour:
    """`tour(boxes=…, share=…)`: what came of it, the robot and the service."""

    def run(boxes: tuple[Box, ...] = (), max_time: float = 120.0, **inputs: Any) -> Any:
        robot = FlatRobot(START, 1)
        robot.boxes = [*ROOMS, DESK, *boxes]
        world = ScriptedWorld(robot, scripted_site(start=START).of_a_run().uncharted())
        services = {
            "mapping": MappingService(),
            "planning_scene": FlatScene(robot.description.footprint),
        }
        result = run_skill(
            Explore, world=world, services=services, inputs=inputs, max_time=max_time
        )
        return result, robot, services["mapping"]

    return run


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """`failing(code)`: every drive fails with it."""

    def fail(code: str) -> None:
        def travel(*_: Any, **__: Any) -> Any:
            yield "drive"
            raise Failure(code, "the drive failed")

        monkeypatch.setattr(explore.trip, "travel", travel)

    return fail


def test_both_rooms_are_known_in_the_end_and_nothing_is_touched(tour: Tour) -> None:
    result, robot, mapping = tour()
    assert result.status == "SUCCESS", result.explain()
    assert result.outputs["known"] > 0.97 * FLOOR
    assert result.outputs["known_share"] >= 97
    assert robot.nearest > 0.02
    assert mapping.map_from_base.distance_to(robot.truth) < 0.15
    assert any("square metres known" in line for line in result.logs)


def test_a_share_is_enough_when_it_is_asked_for(tour: Tour) -> None:
    result, _, mapping = tour(share=40)
    assert result.status == "SUCCESS", result.explain()
    assert 40 <= result.outputs["known_share"] < 95
    assert mapping.known < 0.8 * FLOOR


def test_a_gap_that_is_too_narrow_leads_nowhere(tour: Tour) -> None:
    """The doorway is closed but for 25 cm: what is seen through it is all that can be known."""
    result, robot, mapping = tour([(1.0, 0.4, 1.1, 1.25)])
    assert result.status == "SUCCESS", result.explain()
    assert robot.truth.x < 1.0
    grid = mapping.costmap.grid
    here = np.count_nonzero(grid.cells[:, : grid.index(1.0, 0.0)[1]] == FREE) * 0.05**2
    assert here > 0.95 * (5.0 * 5.9 - 0.6)


@pytest.mark.parametrize("code", ["GOAL_BLOCKED", "NO_PATH", "PATH_BLOCKED", "NO_PROGRESS"])
def test_what_keeps_it_from_what_is_left_is_its_code(
    tour: Tour, failing: Callable[[str], None], code: str
) -> None:
    failing(code)
    result, _, _ = tour()
    assert result.code == code, result.explain()
    assert "of the floor is left to explore" in result.failure.message
    assert 0.0 < result.failure.data["share"] < 1.0


def test_it_does_not_go_on_when_the_map_does_not_fit(
    tour: Tour, failing: Callable[[str], None]
) -> None:
    failing("NOT_LOCALIZED")
    result, _, _ = tour()
    assert result.code == "NOT_LOCALIZED", result.explain()


def test_a_base_that_does_not_move_is_told_soon(tour: Tour, monkeypatch: Any) -> None:
    monkeypatch.setattr(FlatRobot, "command", lambda *_: None)
    result, _, _ = tour()
    assert result.code == "NO_PROGRESS", result.explain()


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: SceneOf
) -> None:
    scene = scene_of(stretched_out)
    services = {"mapping": object(), "planning_scene": scene}
    result = run_skill(Explore, robot=stretched_out, services=services, frames=scene.frames)
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)
