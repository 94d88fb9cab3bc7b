"""teleop_base: it drives as commanded, within limits, and stops: on release, before obstacles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from momantu_skills.controls import rehearsed
from momantu_skills.navigation.localize.service import LocalizationService
from momantu_skills.teleop_base import TeleopBase

from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import BaseKind
from momantu_bt.teleoperation import DEAD_MAN, Command, OperatorService
from momantu_bt.testing import ScriptedWorld, run_skill, small_robot
from tests.skills.scenery.flat import START, Box, Flat, FlatSceneOf

Wanted = Callable[[float], Command]
Drive = Callable[..., Any]
WALL: Sequence[Box] = [(-1.0, -1.0, -0.9, 1.0)]
BEHIND: Sequence[Box] = [(-3.0, -1.0, -2.9, 1.0)]


@pytest.fixture
def drive(flat: Flat, flat_scene: FlatSceneOf) -> Drive:
    def run(wanted: Wanted, seconds: float = 3.0, *, speeds: Any = None, **more: Any) -> Any:
        world: ScriptedWorld = flat(drift=0.0, **more)
        belief, scene = LocalizationService(), flat_scene(world)
        services = {"localization": belief, "planning_scene": scene, **rehearsed(wanted, seconds)}

        def watch(session: Any, place: Any) -> None:
            if speeds is not None:
                speeds.append((place.now(), place.robot.linear))

        return run_skill(TeleopBase, world=world, services=services, on_tick=watch)

    return run


def ahead(speed: float, turn: float = 0.0) -> Wanted:
    return lambda now: Command(now, speed, turn)


def test_without_a_person_it_fails_with_no_operator(flat: Flat, flat_scene: FlatSceneOf) -> None:
    world = flat()
    services = {
        "localization": LocalizationService(),
        "planning_scene": flat_scene(world),
        "operator": OperatorService(),
    }
    result = run_skill(TeleopBase, world=world, services=services)
    assert result.code == "NO_OPERATOR"
    assert "momantu-bt teleop" in result.explain()
    assert result.robot.commands == []


def test_it_drives_as_commanded_and_stands_at_the_end(drive: Drive) -> None:
    result = drive(ahead(0.4, 0.2), 2.0)
    assert result.status == "SUCCESS", result.explain()
    robot = result.robot
    assert (START.inverse() @ robot.truth).x == pytest.approx(0.7, abs=0.15)
    assert robot.truth.yaw == pytest.approx(0.4, abs=0.1)
    assert abs(robot.linear) < 0.02
    assert result.phases == ("driving", "stopping")


@settings(
    max_examples=6, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.floats(-5.0, 5.0), st.floats(-9.0, 9.0))
def test_no_command_is_above_the_limits(drive: Drive, linear: float, angular: float) -> None:
    result = drive(ahead(linear, angular), 1.0)
    assert result.status == "SUCCESS", result.explain()
    limits = result.robot.description.base
    goals = [g for _, _, g in result.robot.commands if isinstance(g, BaseVelocity)]
    assert all(abs(g.linear) <= limits.linear for g in goals)
    assert all(abs(g.angular) <= limits.angular for g in goals)


def test_a_source_that_falls_silent_stops_the_base(drive: Drive) -> None:
    speeds: list[tuple[float, float]] = []
    drive(lambda now: Command(min(now, 1.0), 0.5), 4.0, speeds=speeds)
    braking = 0.5 / 1.0
    assert max(speed for _, speed in speeds) > 0.45
    late = [speed for now, speed in speeds if now > 1.0 + DEAD_MAN + 0.2 + braking]
    assert late
    assert max(late) < 0.01


@pytest.mark.parametrize(
    ("speed", "more", "why"),
    [
        (0.8, {"hidden": WALL}, "the laser sees it"),
        (-0.8, {"known": BEHIND}, "in the map or an earlier scan"),
    ],
)
def test_it_slows_down_and_stops_before_obstacles(
    drive: Drive, speed: float, more: dict[str, Any], why: str
) -> None:
    result = drive(ahead(speed), 6.0, **more)
    assert result.robot.nearest > 0.0
    assert result.robot.nearest < 0.3
    assert f"stopped: obstacle, {why}" in result.phases
    assert abs(result.robot.linear) < 0.01


def test_it_leaves_an_obstacle_again(drive: Drive) -> None:
    result = drive(lambda now: Command(now, 0.8 if now < 4.0 else -0.4), 6.0, hidden=WALL)
    assert "stopped: obstacle, the laser sees it" in result.phases
    assert result.phases[-2:] == ("driving", "stopping")


def test_a_stretched_arm_stops_it_where_the_map_has_something(
    drive: Drive, flat: Flat, flat_scene: FlatSceneOf
) -> None:
    import numpy as np

    world = flat(drift=0.0, known=WALL)
    scene = flat_scene(world)
    scene.load = (0.8, np.array([(0.7, -0.05), (0.7, 0.05)]))
    services = {
        "localization": LocalizationService(),
        "planning_scene": scene,
        **rehearsed(ahead(0.5), 5.0),
    }
    result = run_skill(TeleopBase, world=world, services=services)
    assert "stopped: obstacle, in the map or an earlier scan" in result.phases
    assert world.robot.truth.x + 0.7 < WALL[0][0] + 0.03


def test_an_omnidirectional_base_slides_and_stops_before_a_wall(drive: Drive) -> None:
    robot = small_robot()
    limits = robot.base.model_copy(update={"kind": BaseKind.OMNIDIRECTIONAL})
    sliding = robot.model_copy(update={"base": limits})
    result = drive(lambda now: Command(now, lateral=0.3), 2.0, description=sliding)
    assert result.status == "SUCCESS", result.explain()
    moved = START.inverse() @ result.robot.truth
    assert (moved.x, moved.y) == pytest.approx((0.0, 0.6), abs=0.06)
    wall = [(-3.0, 0.9, -1.0, 1.0)]
    result = drive(lambda now: Command(now, lateral=0.3), 6.0, description=sliding, hidden=wall)
    assert 0.0 < result.robot.nearest < 0.3
    assert any("stopped: obstacle" in phase for phase in result.phases)
    result = drive(lambda now: Command(now, lateral=0.3), 2.0)
    assert (START.inverse() @ result.robot.truth).y == pytest.approx(0.0, abs=0.01)
