"""teleop_arm: the hand goes where it is commanded, and stops at limits and before it touches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from momantu_skills.controls import rehearsed
from momantu_skills.teleop_arm import TeleopArm

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.teleoperation import DEAD_MAN, Command, OperatorService
from momantu_bt.testing import run_skill
from momantu_bt.world import TICK
from tests.skills.scenery.table import SceneOf, Tabletop

OUT = {
    "torso_lift_joint": 0.2,
    "shoulder_pan_joint": 0.0,
    "shoulder_lift_joint": -0.6,
    "upperarm_roll_joint": 0.0,
    "elbow_flex_joint": 1.2,
    "forearm_roll_joint": 0.0,
    "wrist_flex_joint": -0.6,
    "wrist_roll_joint": 0.0,
}
"""The arm ahead of the robot, with room to all sides."""
Jog = Callable[..., Any]
TABLE_TOP = 0.7
"""Height of the tables of the scripted site, m."""


@pytest.fixture
def jog(scene_of: SceneOf) -> Jog:
    """`jog(wanted, robot)`: the result, and joints and hand at each tick."""

    def run(wanted: Any, robot: Tabletop | None = None, seconds: float = 2.0) -> Any:
        robot = robot or stretched()
        scene = scene_of(robot)
        seen: list[tuple[np.ndarray, Transform]] = []
        names = robot.description.actuators["arm"].joints

        def watch(session: Any, world: Any) -> None:
            seen.append((np.array([robot.joints[n] for n in names]), robot.odom_from_hand))

        result = run_skill(
            TeleopArm,
            robot=robot,
            services={"planning_scene": scene, **rehearsed(wanted, seconds)},
            frames=scene.frames,
            map_from_odom=Transform(),
            on_tick=watch,
        )
        return result, seen, scene

    return run


def stretched() -> Tabletop:
    robot = Tabletop(can=None)
    robot.joints |= OUT
    return robot


def moving(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> Any:
    return lambda now: Command(now, hand=(x, y, z, 0.0, 0.0, yaw))


def test_without_a_person_it_fails_with_no_operator(scene_of: SceneOf) -> None:
    robot = stretched()
    services = {"planning_scene": scene_of(robot), "operator": OperatorService()}
    result = run_skill(TeleopArm, robot=robot, services=services)
    assert result.code == "NO_OPERATOR"
    assert robot.commands == []


@pytest.mark.parametrize("way", [(0.1, 0.0, 0.0), (0.0, -0.1, 0.0), (0.0, 0.0, 0.1)])
def test_the_hand_moves_along_an_axis_of_the_base_and_keeps_its_direction(
    jog: Jog, way: tuple[float, float, float]
) -> None:
    result, seen, _ = jog(moving(*way), seconds=1.0)
    assert result.status == "SUCCESS", result.explain()
    start, end = seen[0][1], seen[-1][1]
    gone = end.position - start.position
    assert gone == pytest.approx(np.array(way), abs=0.015)
    assert start.angle_to(end) < 0.02
    assert result.phases == ("standing", "moving the hand", "stopping")


def test_a_turn_leaves_the_hand_where_it_is(jog: Jog) -> None:
    _, seen, _ = jog(moving(yaw=0.5), seconds=1.0)
    start, end = seen[0][1], seen[-1][1]
    assert start.angle_to(end) == pytest.approx(0.5, abs=0.06)
    assert np.linalg.norm(end.position - start.position) < 0.01


def test_no_joint_is_faster_than_its_limit_however_fast_the_hand_is_sent(jog: Jog) -> None:
    result, seen, _ = jog(moving(y=5.0), seconds=1.0)
    limits = result.robot.description.joint_limits
    names = result.robot.description.actuators["arm"].joints
    fastest = np.array([limits[name].velocity for name in names])
    joints = np.array([q for q, _ in seen])
    assert (np.abs(np.diff(joints, axis=0)) <= fastest * TICK * 1.001).all()


def test_a_joint_stops_at_its_limit_and_is_named(jog: Jog) -> None:
    result, seen, _ = jog(lambda now: Command(now, joints={"torso_lift_joint": 0.1}), seconds=4.0)
    limit = result.robot.description.joint_limits["torso_lift_joint"].upper
    assert seen[-1][0][0] == pytest.approx(limit, abs=1e-3)
    assert "stopped: torso_lift_joint is at its limit" in result.phases


def test_the_hand_stops_at_the_end_of_its_reach(jog: Jog) -> None:
    result, _, _ = jog(moving(x=0.2), seconds=6.0)
    assert any(phase.startswith("stopped: the hand cannot go on") for phase in result.phases)


def test_a_folded_arm_stops_before_it_touches_the_robot(jog: Jog) -> None:
    robot = Tabletop(can=None, pose="home")
    result, seen, scene = jog(moving(x=-0.1), robot, seconds=3.0)
    assert any("would touch" in phase for phase in result.phases), result.phases
    world = scene.scene.world(robot.state(), None, 0.0)
    assert all(world.free(q) for q, _ in seen)


def test_the_hand_stops_above_a_table_of_the_site(jog: Jog) -> None:
    robot = stretched()
    robot.base = Pose2D(1.2, 0.0, 0.0)
    result, seen, _ = jog(moving(z=-0.15), robot, seconds=5.0)
    assert any(phase.endswith("would touch a surface") for phase in result.phases), result.phases
    assert min(hand.position[2] for _, hand in seen) > TABLE_TOP


def test_a_silent_source_stops_the_arm(jog: Jog) -> None:
    _, seen, _ = jog(
        lambda now: Command(min(now, 0.5), hand=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0)), seconds=2.5
    )
    after = round((0.5 + DEAD_MAN + 0.2) / TICK)
    assert np.abs(seen[after][0] - seen[-1][0]).max() < 1e-6
    assert seen[-1][1].position[2] > seen[0][1].position[2] + 0.05


def test_it_says_when_the_arm_does_not_follow(jog: Jog) -> None:
    robot = stretched()
    robot.frozen.add("arm")
    result, _, _ = jog(lambda now: Command(now, joints={"shoulder_pan_joint": 0.5}), robot)
    assert "stopped: shoulder_pan_joint does not follow" in result.phases


def test_stop_brakes_the_arm_and_it_goes_on_from_there(jog: Jog) -> None:
    def wanted(now: float) -> Command:
        if 0.475 <= now < 0.525:
            return Command(now, stop=True)
        return Command(now, hand=(0.0, 0.0, 0.1 if now < 0.5 or now > 1.0 else 0.0, 0.0, 0.0, 0.0))

    result, seen, _ = jog(wanted, seconds=1.5)
    assert any(goal is None for at, _, goal in result.robot.commands if at < 0.7)
    steps = np.abs(np.diff(np.array([q for q, _ in seen]), axis=0))
    assert steps.max() < 0.05, "the arm never jumps"
