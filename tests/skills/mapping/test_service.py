"""The mapping service: localization's contract on a map of its own, the same bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_skills.mapping.service import MappingService
from momantu_skills.navigate import Navigate
from momantu_skills.navigation.localize.confidence import is_localized
from momantu_skills.navigation.map.own import OwnMap

from momantu_bt.failure import Failure
from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.frames import FrameBuffer
from momantu_bt.geometry import Pose2D
from momantu_bt.service import Localization, ServiceContext, offers
from momantu_bt.testing import ScriptedWorld, scripted_site
from momantu_bt.testing.service_check import check_service
from momantu_bt.testing.skill_run import run_skill
from tests.skills.scenery.flat import DESK, ROOMS, START, FlatRobot, FlatScene

BEFORE_THE_DESK = Pose2D(3.0, 0.2, 0.0)


@pytest.fixture
def drive():
    """`drive(goal, …)`: navigate in the flat world on a map of its own."""

    def run(goal, *, seed=0, start=START, on_tick=None):
        robot = FlatRobot(start, seed)
        robot.boxes = [*ROOMS, DESK]
        world = ScriptedWorld(robot, scripted_site(start=start).of_a_run().uncharted())
        mapping = MappingService()
        scene = FlatScene(robot.description.footprint)
        services = {"localization": mapping, "planning_scene": scene}
        result = run_skill(
            Navigate,
            world=world,
            services=services,
            inputs={"goal": goal},
            max_time=100.0,
            on_tick=on_tick,
        )
        return result, world, mapping

    return run


def test_it_keeps_what_services_promise_and_offers_what_localization_does():
    assert not check_service(MappingService)
    assert offers(MappingService(), Localization)
    assert offers(MappingService(), OwnMap)


def test_navigate_gets_there_through_floor_that_nobody_drew(drive):
    result, world, mapping = drive(BEFORE_THE_DESK)
    assert result.status == "SUCCESS", result.explain()
    assert result.claim() is None
    assert world.robot.nearest > 0.02
    assert world.robot.truth.distance_to(BEFORE_THE_DESK) < 0.12
    assert is_localized(mapping)
    published = mapping.published()
    assert set(published) == set(MappingService.publishes)
    assert 30.0 < published["known"] < 57.0


def test_the_map_has_walls_free_floor_and_what_nobody_saw(drive):
    _, _, mapping = drive(BEFORE_THE_DESK)
    mapping.refresh()
    grid = mapping.costmap.grid
    assert grid.cells[grid.index(-2.0, 0.0)] == FREE
    assert grid.cells[grid.index(3.9, 0.2)] == UNKNOWN
    assert grid.cells[grid.index(-6.0, 0.0)] == UNKNOWN
    row, column = grid.index(-2.0, 3.0)
    assert (grid.cells[row - 2 : row + 3, column] == OCCUPIED).any()


def test_the_same_drive_makes_the_same_map_bit_for_bit(drive):
    first, second = (drive(BEFORE_THE_DESK, seed=4)[2] for _ in range(2))
    assert first.survey.mapper.poses == second.survey.mapper.poses
    assert np.array_equal(first.costmap.grid.cells, second.costmap.grid.cells)


def test_a_dead_laser_leaves_odometry(drive):
    def die(session, world):
        if world.now() > 3.0:
            world.robot.dead.add("laser")

    result, world, mapping = drive(BEFORE_THE_DESK, on_tick=die)
    assert result.code == "SENSOR_DEAD", result.explain()
    assert mapping.map_from_base.distance_to(world.robot.truth) < 0.1


def test_without_a_scan_there_is_no_map():
    service, robot = MappingService(), FlatRobot(START)
    frames = FrameBuffer(robot.description.kinematics())
    service.start(
        ServiceContext(
            scripted_site(), robot.description, frames, robot, np.random.default_rng(0), {}, {}.get
        )
    )
    robot.dead.add("laser")
    service.update(robot, 0.0)
    assert service.published()["known"] == 0.0
    with pytest.raises(Failure) as failure:
        _ = service.costmap
    assert failure.value.code == "SENSOR_DEAD"


def test_a_reset_elsewhere_is_corrected_by_the_next_scan(drive):
    _, world, mapping = drive(BEFORE_THE_DESK)
    right = mapping.map_from_base
    mapping.reset(right @ Pose2D(0.1, -0.08, 0.05), 0.2, 0.2)
    assert mapping.map_from_base.distance_to(right) > 0.1
    mapping.update(world.robot, world.now() + 1.0)
    assert mapping.map_from_base.distance_to(right) < 0.03
