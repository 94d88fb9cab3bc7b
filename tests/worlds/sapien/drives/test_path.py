"""A trajectory is followed as it was planned, and braking never leaves it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.sapien.drives.path import BLEND, Path

from momantu_bt.messages import JointTrajectory

STEP = 1 / 240
SPEED, ACCELERATION = 1.0, 2.0


def smooth(seed: int, joints: int = 3) -> JointTrajectory:
    """A sum of slow waves from rest to rest, well within SPEED and ACCELERATION."""
    random = np.random.default_rng(seed)
    duration = 2.0 + 2.0 * random.random()
    times = np.linspace(0.0, duration, 40)
    u = times / duration
    # 10 u^3 - 15 u^4 + 6 u^5 starts and ends at rest
    shape = u**3 * (10 - 15 * u + 6 * u * u)
    slope = 30 * u**2 * (1 - u) ** 2 / duration
    reach = random.uniform(-0.6, 0.6, joints)
    return JointTrajectory(
        tuple(f"j{i}" for i in range(joints)), times, np.outer(shape, reach), np.outer(slope, reach)
    )


def path_of(trajectory: JointTrajectory, start: np.ndarray | None = None) -> Path:
    joints = len(trajectory.names)
    begin = trajectory.positions[0] if start is None else start
    still = np.zeros(joints)
    return Path(
        trajectory, list(range(joints)), (begin, still), still, np.full(joints, ACCELERATION)
    )


@given(seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_every_point_of_the_trajectory_is_passed(seed: int) -> None:
    trajectory = smooth(seed)
    positions, velocities, _ = path_of(trajectory).sample(trajectory.times)
    assert np.allclose(positions, trajectory.positions, atol=1e-12)
    assert np.allclose(velocities, trajectory.velocities, atol=1e-12)


@given(seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_velocity_is_the_derivative_of_position(seed: int) -> None:
    path = path_of(smooth(seed), start=np.array([0.03, -0.02, 0.01]))
    times = np.linspace(0.01, 1.9, 50)
    h = 1e-6
    ahead, behind = path.sample(times + h)[0], path.sample(times - h)[0]
    assert np.allclose((ahead - behind) / (2 * h), path.sample(times)[1], atol=1e-5)


@given(seed=st.integers(0, 1000), stop_after=st.integers(1, 30))
@settings(max_examples=40, deadline=None)
def test_braking_stays_on_the_path_within_the_limits(seed: int, stop_after: int) -> None:
    trajectory = smooth(seed)
    path = path_of(trajectory)
    rows = [path.advance(STEP, 12) for _ in range(stop_after)]
    path.pace_goal = 0.0
    while not path.resting:
        rows.append(path.advance(STEP, 12))
    positions = np.concatenate([p for p, _ in rows])
    velocities = np.concatenate([v for _, v in rows])
    dense, _, _ = path.sample(np.linspace(0.0, trajectory.duration, 4000))
    gaps = np.abs(positions[:, None] - dense[None]).max(axis=2).min(axis=1)
    assert gaps.max() < 2e-3
    assert np.abs(velocities[-1]).max() < 1e-9
    assert np.abs(np.diff(velocities, axis=0) / STEP).max() < 1.3 * ACCELERATION


def test_a_stopped_path_goes_on_to_its_end_when_asked_again() -> None:
    trajectory = smooth(3)
    path = path_of(trajectory)
    for goal in (1.0, 0.0, 1.0):
        path.pace_goal = goal
        for _ in range(20):
            positions, _ = path.advance(STEP, 12)
    while not path.finished:
        positions, velocities = path.advance(STEP, 12)
    assert np.allclose(positions[-1], trajectory.positions[-1])
    assert np.all(velocities[-1] == 0.0)


@pytest.mark.parametrize("offset", [0.04, -0.04])
def test_a_start_beside_the_joints_fades_without_a_jump(offset: float) -> None:
    trajectory = smooth(5)
    path = path_of(trajectory, start=trajectory.positions[0] + offset)
    first, _ = path.advance(STEP, 12)
    assert np.abs(first[0] - trajectory.positions[0] - offset).max() < 1e-3
    after = np.array([BLEND, BLEND + 0.1])
    assert np.allclose(path.sample(after)[0], path_of(trajectory).sample(after)[0])


def test_a_single_point_is_held() -> None:
    point = JointTrajectory(("a",), np.array([0.0]), np.array([[0.3]]), np.array([[0.0]]))
    path = path_of(point)
    positions, velocities = path.advance(STEP, 12)
    assert path.finished
    assert np.allclose(positions, 0.3)
    assert np.all(velocities == 0.0)
