"""Paths lead to the goal and through no wall; each failure has its code and Nav2's number."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from momantu_skills.nav2.compute_path import ComputePathThroughPoses, ComputePathToPose

from momantu_bt.geometry import Pose2D, nearest_index
from tests.skills.nav2.conftest import Act
from tests.skills.scenery.flat import Flat

GOAL = Pose2D(3.0, 0.2, 0.0)
"""Before the desk, in the second room."""
DOOR = (0.8, 0.3, 1.2, 1.6)
"""A box that fills the doorway."""


def _path(result: Any) -> tuple[Pose2D, ...]:
    assert result.status == "SUCCESS", result.explain()
    path = result.outputs["path"]
    assert all(0.0 < a.distance_to(b) < 0.2 for a, b in pairwise(path))
    return path


@pytest.mark.parametrize("seed", range(4))
def test_from_anywhere_to_anywhere_through_no_wall(flat: Flat, act: Act, seed: int) -> None:
    random = np.random.default_rng(seed)
    start = Pose2D(random.uniform(-3.2, 0.2), random.uniform(-1.5, 2.2), random.uniform(-3, 3))
    goal = Pose2D(random.uniform(1.8, 2.9), random.uniform(-2.2, 2.2), random.uniform(-3, 3))
    world = flat(start, seed=seed)
    path = _path(act(ComputePathToPose, world, goal=goal))
    assert path[0].distance_to(start) < 0.2
    assert path[-1] == goal
    points = np.array([(p.x, p.y) for p in path])
    assert world.robot.distance(points).min() > 0.2  # half of the base's width
    for pose, after in pairwise(path[:-1]):
        along = math.atan2(after.y - pose.y, after.x - pose.x)
        assert abs(math.remainder(along - pose.yaw, 2 * math.pi)) < 1e-6


@pytest.mark.parametrize("goal", ["right", "2.2;-2;-1", "0;map;2.2;-2;0;0;0;-0.4794255;0.8775826"])
def test_a_goal_is_a_place_or_a_text_too(flat: Flat, act: Act, goal: str) -> None:
    end = _path(act(ComputePathToPose, flat(), goal=goal))[-1]
    assert (end.x, end.y) == (2.2, -2.0)
    assert end.yaw == pytest.approx(-1.0, abs=1e-6)


def test_before_a_surface_it_looks_at_it(flat: Flat, act: Act) -> None:
    end = _path(act(ComputePathToPose, flat(), goal="desk"))[-1]
    assert math.hypot(end.x - 3.9, end.y - 0.2) < 1.5


def test_it_commands_nothing_and_ends_with_code_0(flat: Flat, act: Act) -> None:
    world = flat()
    result = act(ComputePathToPose, world, goal=GOAL)
    assert result.outputs["error_code_id"] == 0
    assert result.outputs["error_msg"] == ""
    assert world.robot.nearest == math.inf or world.robot.linear == 0.0


def test_from_a_given_start_unless_it_is_not_to_be_used(flat: Flat, act: Act) -> None:
    start = Pose2D(2.0, -1.0, 0.0)
    path = _path(act(ComputePathToPose, flat(), goal=GOAL, start=start))
    assert path[0].distance_to(start) < 0.1
    path = _path(act(ComputePathToPose, flat(), goal=GOAL, start=start, use_start=False))
    assert path[0].distance_to(Pose2D(-2.0, 0.0)) < 0.2


def test_past_points_on_the_way(flat: Flat, act: Act) -> None:
    via = Pose2D(-2.0, 2.0, 0.0)
    path = _path(act(ComputePathToPose, flat(), goal=GOAL, viapoints=(via,)))
    assert min(pose.distance_to(via) for pose in path) < 0.1


def test_through_several_poses_in_their_order(flat: Flat, act: Act) -> None:
    goals = (Pose2D(-2.0, 2.0, 0.0), "right", GOAL)
    result = act(ComputePathThroughPoses, flat(), goals=goals)
    path = _path(result)
    poses = (Pose2D(-2.0, 2.0), Pose2D(2.2, -2.0), GOAL)
    at = [nearest_index(path, pose) for pose in poses]
    assert at == sorted(at)
    assert all(path[k].distance_to(pose) < 0.1 for k, pose in zip(at, poses, strict=True))
    assert result.outputs["last_reached_index"] == -1


@pytest.mark.parametrize(
    ("inputs", "code", "number"),
    [
        ({"goal": "kitchen"}, "BAD_GOAL", 204),
        ({"goal": "1;2;3;4"}, "BAD_GOAL", 204),
        ({"goal": "0;odom;1;2;0;0;0;0;1"}, "BAD_GOAL", 204),
        ({"goal": GOAL, "planner_id": "Smac"}, "INVALID_PLANNER", 201),
        ({"goal": GOAL, "start": Pose2D(40.0, 0.0)}, "START_OUTSIDE_MAP", 203),
        ({"goal": Pose2D(40.0, 0.0)}, "GOAL_OUTSIDE_MAP", 204),
        ({"goal": Pose2D(3.9, 0.2)}, "GOAL_OCCUPIED", 206),
        ({"goal": GOAL, "start": Pose2D(3.9, 0.2)}, "START_OCCUPIED", 205),
    ],
)
def test_each_failure_has_nav2s_number(
    flat: Flat, act: Act, inputs: dict[str, Any], code: str, number: int
) -> None:
    result = act(ComputePathToPose, flat(), **inputs)
    assert result.code == code, result.explain()
    assert result.skill.error_code_id == number  # type: ignore[union-attr]
    assert result.skill.error_msg == result.failure.message  # type: ignore[union-attr]


def test_no_valid_path_when_the_doorway_is_filled(flat: Flat, act: Act) -> None:
    world = flat(Pose2D(-1.0, 0.9, 0.0), hidden=[DOOR])
    result = act(ComputePathToPose, world, goal=GOAL)
    assert (result.code, result.skill.error_code_id) == ("NO_VALID_PATH", 208)  # type: ignore[union-attr]


def test_through_no_poses_at_all(flat: Flat, act: Act) -> None:
    result = act(ComputePathThroughPoses, flat(), goals=())
    assert result.code == "NO_VIAPOINTS_GIVEN"
    assert result.skill.error_code_id == 309  # type: ignore[union-attr]
