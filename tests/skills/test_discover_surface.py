"""discover_surface: tables that nobody told of are found and measured; each code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from momantu_skills import discover_surface
from momantu_skills.discover_surface import DiscoverSurface
from momantu_skills.mapping import coverage, sightings
from momantu_skills.mapping.service import MappingService
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.perception.surface.tops import Top, without_uprights

from momantu_bt.failure import Failure
from momantu_bt.formats.maps import FREE, OCCUPIED
from momantu_bt.geometry import Pose2D
from momantu_bt.testing import ScriptedRobot, ScriptedWorld, scripted_site, small_robot
from momantu_bt.testing.painting import Block, Painter
from momantu_bt.testing.skill_run import run_skill
from momantu_bt.world import Surface
from tests.skills.scenery.flat import ROOMS, START, Box, FlatRobot, FlatScene
from tests.skills.scenery.table import SceneOf

SIZE, HEIGHT = (0.6, 1.2), 0.7
NARROW = (0.25, 1.2)
BENCH = (-1.0, 1.9)
"""Where a bench stands in the room of the start."""

Look = Callable[..., Any]


class Scene(FlatScene):
    """Pictures are not needed here."""

    def observe(self, snapshot: Any) -> None:
        """Forget it."""


def outline(x: float, y: float, size: tuple[float, float] = SIZE) -> Box:
    return x - size[0] / 2, y - size[1] / 2, x + size[0] / 2, y + size[1] / 2


def board(x: float, y: float, size: tuple[float, float] = SIZE, height: float = HEIGHT) -> Block:
    """A board at a place of the map, as the painter has it: in odom."""
    at = START.inverse() @ Pose2D(x, y)
    return Block((*size, 0.04), (at.x, at.y, height - 0.02), at.yaw)


@pytest.fixture
def look() -> Look:
    """`look(boxes, boards, named=…)`: what came of it, the robot and the service."""

    def run(
        boxes: Sequence[Box],
        boards: Sequence[Block],
        named: dict[str, Surface] | None = None,
        **inputs: Any,
    ) -> Any:
        description = small_robot()
        camera = description.sensors["camera"].model_copy(update={"width": 240, "height": 180})
        sensors = {**description.sensors, "camera": camera}
        robot = FlatRobot(START, 1, 0.0, description.model_copy(update={"sensors": sensors}))
        robot.boxes = [*ROOMS, *boxes]
        robot.readings["camera"] = Painter(boards)
        site = scripted_site(start=START).of_a_run().uncharted()
        for name, surface in (named or {}).items():
            site.surfaces.teach(name, surface)  # type: ignore[attr-defined]
        services = {
            "mapping": MappingService(),
            "planning_scene": Scene(robot.description.footprint),
        }
        result = run_skill(
            DiscoverSurface,
            world=ScriptedWorld(robot, site),
            services=services,
            inputs=inputs,
            max_time=120.0,
        )
        return result, robot, services["mapping"]

    return run


def test_a_bench_is_found_and_measured_and_the_robot_stands_before_it(look: Look) -> None:
    result, robot, _ = look([outline(*BENCH)], [board(*BENCH)])
    assert result.status == "SUCCESS", result.explain()
    plane = result.outputs["plane"]
    assert plane.pose.frame == "map"
    assert plane.pose.position == pytest.approx((*BENCH, HEIGHT), abs=0.09)
    assert np.ptp(np.array(plane.outline), axis=0) == pytest.approx(SIZE, abs=0.15) or np.ptp(
        np.array(plane.outline), axis=0
    ) == pytest.approx(SIZE[::-1], abs=0.15)
    assert robot.truth.distance_to(Pose2D(*BENCH)) < 2.2
    assert robot.nearest > 0.0


def test_what_is_too_low_too_high_or_too_narrow_is_none(look: Look) -> None:
    boards = [board(-1.0, 2.2, height=0.2), board(-3.4, 1.0, height=1.2), board(0.0, -2.2, NARROW)]
    result, _, _ = look([], boards)
    assert result.code == "NO_NEW_SURFACE", result.explain()
    assert result.failure.data["refused"] == []


@pytest.mark.parametrize(("highest", "said"), [(1.1, True), (0.8, False)])
def test_tops_that_are_about_as_high_as_the_camera_are_told_of(
    look: Look, highest: float, said: bool
) -> None:
    result, _, _ = look([], [], highest=highest)
    assert result.code == "NO_NEW_SURFACE", result.explain()
    assert ("raise it with reset_pose" in result.failure.message) is said


def test_one_that_has_a_name_is_not_found_again(look: Look) -> None:
    bench = Surface(Pose2D(*BENCH), SIZE, HEIGHT, (0.0,))
    result, _, mapping = look([outline(*BENCH)], [board(*BENCH)], {"bench": bench})
    assert result.code == "NO_NEW_SURFACE", result.explain()
    assert result.failure.data["looked_share"] > 80
    assert len(mapping.sightings.looks) >= 4
    assert "1 have names" in result.failure.message


def test_what_nobody_gets_to_is_left_out(look: Look, monkeypatch: pytest.MonkeyPatch) -> None:
    def travel(*_: Any, **__: Any) -> Any:
        yield "drive"
        raise Failure("PATH_BLOCKED", "the drive failed")

    monkeypatch.setattr(discover_surface.trip, "travel", travel)
    result, _, _ = look([outline(*BENCH)], [board(*BENCH)])
    assert result.code == "NO_NEW_SURFACE", result.explain()
    assert "did not get to" in result.failure.message


def test_not_localized(look: Look, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MappingService, "quality", 0.2)
    result, robot, _ = look([outline(*BENCH)], [board(*BENCH)])
    assert result.code == "NOT_LOCALIZED", result.explain()
    assert robot.truth == START


def test_it_does_not_drive_with_an_arm_stretched_out_that_does_not_fold(
    stretched_out: ScriptedRobot, scene_of: SceneOf
) -> None:
    scene = scene_of(stretched_out)
    services = {"mapping": object(), "planning_scene": scene}
    result = run_skill(DiscoverSurface, robot=stretched_out, services=services, frames=scene.frames)
    assert result.code == "ARM_STUCK", result.explain()
    assert all(actuator != "base" for _, actuator, goal in stretched_out.commands if goal)


def room(boxes: Sequence[tuple[int, int, int, int]]) -> GridMap:
    """Four metres square, walled in; boxes: rows and columns from and to."""
    cells = np.full((80, 80), FREE, dtype=np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    for r0, r1, c0, c1 in boxes:
        cells[r0:r1, c0:c1] = OCCUPIED
    return GridMap(cells, 0.05, (0.0, 0.0))


def test_a_look_shows_the_outline_that_it_faces_and_not_what_that_hides() -> None:
    grid = room([(30, 50, 50, 54)])
    ahead = coverage.left(grid, [Pose2D(1.0, 2.0, 0.0)], 1.0)
    assert not ahead[35:45, 50].any()
    assert ahead[35:45, 53].all()
    assert ahead[30:50, 79].all()
    assert ahead[30:50, 0].all()


def test_the_next_place_is_where_most_is_left_and_it_faces_it() -> None:
    grid = room([])
    looks = [Pose2D(2.0, 2.0, yaw) for yaw in (0.0, 1.57, -1.57)]
    remaining = coverage.left(grid, looks, 1.6)
    cost = np.ones(grid.cells.shape, dtype=np.float32)
    view = coverage.best_view(grid, remaining, cost, grid.cells == FREE, [])
    assert view is not None
    assert abs(view.pose.yaw) > 2.8
    assert view.gain > 2.0
    full = [*looks, Pose2D(2.0, 2.0, 3.14)]
    assert coverage.best_view(grid, coverage.left(grid, full, 1.7), cost, cost > 0, []) is None


def test_directions_show_all_that_is_left() -> None:
    grid = room([])
    around = coverage.in_sight(grid, coverage.left(grid, [], 0.0), 2.0, 2.0)
    ways = coverage.directions(around, 1.0)
    assert 6 <= len(ways) <= 9


def test_two_sights_of_one_top_are_the_same() -> None:
    whole = Top(Pose2D(1.0, 1.0, 0.3), (0.8, 1.5), 0.70, 1.2)
    part = Top(Pose2D(1.1, 1.3, 0.2), (0.5, 0.6), 0.72, 0.3)
    above = Top(Pose2D(1.0, 1.0, 0.3), (0.8, 1.5), 0.90, 1.2)
    assert sightings.same(whole, part)
    assert not sightings.same(whole, above)
    notes = sightings.Sightings()
    notes.note([whole, part, above], [])
    assert notes.seen == [whole, above]
    notes.note([replace(whole, area=1.3)], [])
    assert [top.area for top in notes.seen] == [1.2, 1.3]
    named = [sightings.as_surface(whole)]
    assert notes.nearest(Pose2D(0.0, 0.0), named, lambda top: top.height > 1.0) is None
    assert notes.nearest(Pose2D(0.0, 0.0), named, lambda top: True) is above
    notes.forget()
    assert notes.nearest(Pose2D(0.0, 0.0), [], lambda top: True) is None


def test_uprights_are_left_out() -> None:
    x, z = np.meshgrid(np.linspace(0, 1, 40), np.linspace(0.3, 1.0, 40))
    wall = np.column_stack([x.ravel(), np.full(x.size, 2.0), z.ravel()])
    top = np.column_stack([x.ravel(), z.ravel(), np.full(x.size, 0.7)])
    left = without_uprights(np.vstack([wall, top]))
    assert len(left) == len(top)
    assert len(without_uprights(np.zeros((0, 3)))) == 0
