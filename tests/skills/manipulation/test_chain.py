"""Forward and inverse kinematics against each other, other code, and finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.model import ArmModel, Group, arm_model
from momantu_worlds.robots import fetch

GROUP = arm_model(fetch()).group


def some_joints(seed: int, group: Group = GROUP) -> np.ndarray:
    lower = np.where(group.endless, -np.pi, group.lower)
    upper = np.where(group.endless, np.pi, group.upper)
    return np.random.default_rng(seed).uniform(lower, upper)


@given(st.integers(0, 10_000))
def test_the_tip_is_where_the_frames_say(seed: int) -> None:
    q = some_joints(seed)
    description = fetch()
    joints = dict(zip(GROUP.names, q, strict=True))
    expected = description.kinematics().base_from_frame(description.groups["arm"].tip, joints)
    found = GROUP.tip_pose(q)
    assert found.position == pytest.approx(expected.position, abs=1e-9)
    assert found.angle_to(expected) < 1e-6


@given(st.integers(0, 10_000))
def test_the_jacobian_is_the_derivative(seed: int) -> None:
    q, step = some_joints(seed), 1e-6
    for i in range(len(q)):
        moved = q.copy()
        moved[i] += step
        a, b = GROUP.tip_matrix(q), GROUP.tip_matrix(moved)
        spin = (b[:3, :3] - a[:3, :3]) @ a[:3, :3].T / step
        numeric = np.array([*(b[:3, 3] - a[:3, 3]) / step, spin[2, 1], spin[0, 2], spin[1, 0]])
        assert GROUP.jacobian(q)[:, i] == pytest.approx(numeric, abs=1e-4)


@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_every_reachable_pose_is_solved_within_the_limits(seed: int) -> None:
    target = GROUP.tip_matrix(some_joints(seed))
    seeds = np.array([some_joints(seed + 1 + i) for i in range(30)])
    found, good = GROUP.solve(target[None], seeds)
    assert good.any()
    for q in found[0][good[0]]:
        pose = GROUP.tip_matrix(q)
        assert np.linalg.norm(pose[:3, 3] - target[:3, 3]) < 1e-3
        assert np.abs(pose[:3, :3] - target[:3, :3]).max() < 5e-3
        assert (q >= GROUP.lower).all()
        assert (q <= GROUP.upper).all()


def test_a_pose_out_of_reach_is_not_solved() -> None:
    target = np.eye(4)
    target[:3, 3] = (3.0, 0.0, 1.0)
    found, good = GROUP.solve(target[None], np.array([some_joints(i) for i in range(10)]))
    assert not good.any()
    assert np.isfinite(found).all()


@given(st.integers(0, 1_000))
def test_a_traced_line_stays_on_its_poses(seed: int) -> None:
    start = some_joints(seed)
    pose = GROUP.tip_matrix(start)
    targets = np.repeat(pose[None], 5, axis=0)
    targets[:, 2, 3] += np.linspace(0.01, 0.05, 5)
    path, reached = GROUP.trace(targets, start)
    assert reached == len(path)
    for q, target in zip(path, targets, strict=False):
        assert np.linalg.norm(GROUP.tip_matrix(q)[:3, 3] - target[:3, 3]) < 1e-3


@given(st.integers(0, 1_000), st.integers(-3, 3))
def test_turns_of_endless_joints_do_not_matter(seed: int, turns: int) -> None:
    q, reference = some_joints(seed), some_joints(seed + 1)
    wound = q + GROUP.endless * turns * 2 * np.pi
    near = GROUP.nearest_turn(wound, reference)
    assert (np.abs(near - reference)[GROUP.endless] <= np.pi + 1e-9).all()
    assert GROUP.tip_matrix(near) == pytest.approx(GROUP.tip_matrix(q), abs=1e-9)


def test_pinocchio_places_every_link_where_the_frames_do(model: ArmModel) -> None:
    q = some_joints(7)
    joints = dict(zip(model.group.names, q, strict=True))
    full = np.zeros(model.pin.nq)
    full[model.group_index] = q
    tree = model.description.kinematics()
    for link, pose in model.link_poses(full).items():
        assert pose == pytest.approx(tree.base_from_frame(link, joints).matrix, abs=1e-9)
