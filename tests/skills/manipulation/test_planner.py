"""Paths and trajectories: valid all along, within limits, the same for the same seed."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.manipulation.model.collision import BodyPairs, CollisionWorld, Obstacle
from momantu_skills.manipulation.motion.planner import Planner
from momantu_skills.manipulation.motion.timing import at_rest, densified, rounded, timed
from momantu_worlds.robots import fetch

CONFIG = PlanningConfig()
GROUP = arm_model(fetch()).group


def planner(seed: int) -> Planner:
    return Planner(GROUP, np.random.default_rng(seed), CONFIG)


def world_of(
    model: ArmModel, body: BodyPairs, table: Obstacle, margin: float = 0.012
) -> CollisionWorld:
    """A table with a few solid boxes on it."""
    random = np.random.default_rng(11)
    things = [table]
    for i in range(4):
        x, y = random.uniform((0.65, -0.5), (1.1, 0.5))
        corners = [
            (x + a, y + b, c) for a in (-0.05, 0.05) for b in (-0.05, 0.05) for c in (0.72, 0.95)
        ]
        things.append(Obstacle(f"box {i}", np.array(corners)))
    return CollisionWorld(body, np.zeros(model.pin.nq), things, margin=margin)


def above_table(model: ArmModel, world: CollisionWorld, seed: int) -> np.ndarray:
    """A free posture with the hand a little above the table's top."""
    random = np.random.default_rng(seed)
    lower = np.where(GROUP.endless, -np.pi, GROUP.lower)
    upper = np.where(GROUP.endless, np.pi, GROUP.upper)
    for _ in range(50):
        turn = random.uniform(-0.8, 0.8)
        x, y = (np.cos(turn), np.sin(turn), 0.0), (-np.sin(turn), np.cos(turn), 0.0)
        target = np.eye(4)
        target[:3, :3] = np.stack([x, y, (0.0, 0.0, 1.0)], axis=1)
        target[:3, 3] = random.uniform((0.55, -0.4, 0.8), (0.85, 0.4, 1.0))
        found, good = GROUP.solve(target[None], random.uniform(lower, upper, (8, len(lower))))
        for q in found[0][good[0]]:
            if world.free(q):
                return np.asarray(q)
    raise AssertionError("no free posture above the table")


def test_sixty_problems_above_a_cluttered_table(
    model: ArmModel, body: BodyPairs, table: Obstacle
) -> None:
    """Between two checks a path may use up part of the margin, never all of it."""
    world, bare = world_of(model, body, table), world_of(model, body, table, 0.0)
    start = np.array([model.description.named_poses["ready"][n] for n in GROUP.names])
    postures = [above_table(model, world, seed) for seed in range(20)]
    solved = 0
    for seed in range(60):
        here = start if seed % 2 else postures[(seed + 7) % 20]
        path = planner(seed).path(here, [postures[seed % 20]], world.free)
        if path is None:
            continue
        solved += 1
        assert path[0] == pytest.approx(here)
        for a, b in pairwise(path):
            assert bare.path_free(densified(np.array([a, b]), 0.01))
    assert solved == 60


def test_the_same_seed_gives_the_same_path(
    model: ArmModel, body: BodyPairs, table: Obstacle
) -> None:
    world = world_of(model, body, table)
    start = above_table(model, world, 3)
    goal = np.array([model.description.named_poses["home"][n] for n in GROUP.names])
    paths = [planner(5).path(start, [goal], world.free) for _ in range(2)]
    assert paths[0] is not None
    assert paths[1] is not None
    assert np.array_equal(paths[0], paths[1])


def test_the_nearest_of_several_goals_is_preferred() -> None:
    start = np.zeros(len(GROUP.names))
    start[GROUP.names.index("torso_lift_joint")] = 0.2
    near, far = start + 0.05, start + 0.15
    path = planner(0).path(start, [far, near], lambda q: True)
    assert path is not None
    assert path[-1] == pytest.approx(near)


def test_goals_that_are_not_valid_are_left_out() -> None:
    start = np.zeros(len(GROUP.names)) + 0.1
    assert planner(0).path(start, [start + 0.05], lambda q: bool(np.allclose(q, start))) is None


def test_a_search_that_cannot_succeed_ends_by_counting() -> None:
    start, goal = np.zeros(len(GROUP.names)) + 0.1, np.zeros(len(GROUP.names)) + 0.3
    asked = 0

    def valid(q: np.ndarray) -> bool:
        nonlocal asked
        asked += 1
        return bool(np.allclose(q, start) or np.allclose(q, goal))

    few = PlanningConfig(searches=200, attempts=1)
    planner = Planner(GROUP, np.random.default_rng(0), few)
    assert planner.path(start, [goal], valid) is None
    assert 0 < asked < 100_000


def polyline(seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    lower = np.where(GROUP.endless, -np.pi, GROUP.lower)
    upper = np.where(GROUP.endless, np.pi, GROUP.upper)
    return random.uniform(lower, upper, (int(random.integers(2, 6)), len(lower)))


@given(st.integers(0, 200), st.sampled_from([None, 0.1, 0.5]))
def test_trajectories_keep_the_limits(seed: int, rounding: float | None) -> None:
    path = polyline(seed)
    trajectory = timed(GROUP, path, CONFIG, rounding=rounding)
    assert trajectory.times[0] == 0.0
    assert (np.diff(trajectory.times) > 0).all()
    assert trajectory.positions[0] == pytest.approx(path[0])
    assert trajectory.positions[-1] == pytest.approx(path[-1], abs=1e-6)
    assert not trajectory.velocities[[0, -1]].any()
    assert (np.abs(trajectory.velocities) <= GROUP.velocity * 1.001).all()
    step = np.diff(trajectory.times)[:, None]
    between = np.abs(np.diff(trajectory.positions, axis=0)) / step
    assert (between <= GROUP.velocity * 1.02).all()
    change = np.abs(np.diff(trajectory.velocities, axis=0)) / step
    assert (change <= GROUP.acceleration * 1.1).all()


def test_a_straight_motion_is_nearly_as_fast_as_its_slowest_joint() -> None:
    path = polyline(3)[:2]
    least = planner(0).duration(path[0], path[1])
    assert least < timed(GROUP, path, CONFIG).duration < least / CONFIG.speed + 1.6


@given(st.integers(0, 50))
def test_the_tip_keeps_its_speed(seed: int) -> None:
    trajectory = timed(GROUP, polyline(seed), CONFIG, tip_speed=0.1)
    for q, v in zip(trajectory.positions, trajectory.velocities, strict=True):
        assert np.linalg.norm((GROUP.jacobian(q) @ v)[:3]) <= 0.1 * 1.001


@given(st.integers(0, 50))
def test_densified_paths_pass_every_waypoint_in_small_steps(seed: int) -> None:
    path = polyline(seed)
    dense = densified(path, 0.1)
    assert np.abs(np.diff(dense, axis=0)).max() <= 0.1 + 1e-9
    for waypoint in path:
        assert np.abs(dense - waypoint).max(axis=1).min() < 1e-9


@given(st.integers(0, 50))
def test_rounded_paths_leave_corners_out_and_keep_the_ends(seed: int) -> None:
    path = polyline(seed)
    points = rounded(path, 0.1, 0.3)
    assert points[0] == pytest.approx(path[0])
    assert points[-1] == pytest.approx(path[-1])
    for corner in path[1:-1]:
        assert np.abs(points - corner).max(axis=1).min() > 0.05


def test_staying_is_a_trajectory_too() -> None:
    q = polyline(0)[0]
    assert timed(GROUP, np.array([q, q]), CONFIG).duration == at_rest(GROUP, q).duration
