"""Forward and inverse kinematics against each other, other code, and finite differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.model.arm_model import ArmModel, arm_model
from momantu_skills.manipulation.model.group import Group
from momantu_worlds.robots import fetch

from momantu_bt.testing import eye_in_hand_robot

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


@given(st.integers(0, 1_000))
def test_many_poses_are_those_of_one_after_the_other(seed: int) -> None:
    postures = np.array([some_joints(seed + i) for i in range(3)])
    for q, pose in zip(postures, GROUP.poses(postures), strict=True):
        assert pose == pytest.approx(GROUP.tip_matrix(q), abs=1e-12)


@given(st.integers(0, 1_000), st.floats(-0.3, 0.3))
def test_a_ray_that_is_turned_goes_through_the_point(seed: int, aside: float) -> None:
    eye = arm_model(eye_in_hand_robot()).eye
    ray = np.array([math.sin(aside), 0.0, math.cos(aside)])
    start = some_joints(seed, eye)
    pose = eye.tip_matrix(start)
    tilted = pose[:3, :3] @ np.array([0.3, -0.2, 1.0])
    target = pose[:3, 3] + 0.8 * tilted / np.linalg.norm(tilted)
    found, left = eye.point(start[None], ray, target)
    assert ((found[0] >= eye.lower) & (found[0] <= eye.upper)).all()
    turned = eye.tip_matrix(found[0])
    way = target - turned[:3, 3]
    angle = math.acos(min(1.0, float(turned[:3, :3] @ ray @ way) / float(np.linalg.norm(way))))
    assert angle == pytest.approx(left[0], abs=1e-4)
    inside = bool(((start > eye.lower + 0.6) & (start < eye.upper - 0.6)).all())
    assert left[0] < 0.01 or not inside


def test_a_slow_arm_has_a_slower_pace_and_none_of_its_joints_is_slow() -> None:
    slow = arm_model(eye_in_hand_robot()).group
    assert slow.pace == pytest.approx(0.735)
    assert (slow.scale < 2.0).all()
    assert GROUP.pace == 1.5
    assert (GROUP.scale > 2.0).tolist() == [name == "torso_lift_joint" for name in GROUP.names]


def test_the_palm_is_what_does_not_move_against_the_hand() -> None:
    fetch_model, small = arm_model(fetch()), arm_model(eye_in_hand_robot())
    assert fetch_model.palm == pytest.approx(fetch_model.hulls["gripper_link"])
    assert small.palm[:, 0].max() == pytest.approx(-0.05, abs=1e-9)
    assert small.palm[:, 0].min() == pytest.approx(-0.16, abs=1e-9)


def planar() -> Group:
    """A lift, three hinges that turn the hand in a vertical plane, and a roll: five joints."""
    origins = np.tile(np.eye(4), (5, 1, 1))
    origins[1, :3, 3] = (0.1, 0.08, 0.4)
    origins[2, 0, 3] = origins[3, 0, 3] = 0.3
    tip = np.eye(4)
    tip[0, 3] = 0.2
    return Group(
        names=("lift", "shoulder", "elbow", "wrist", "roll"),
        lower=np.array([0.0, -2.0, -2.5, -2.0, -3.0]),
        upper=np.array([0.6, 2.0, 2.5, 2.0, 3.0]),
        velocity=np.ones(5),
        acceleration=np.ones(5),
        origins=origins,
        axes=np.array([[0.0, 0, 1], [0, 1, 0], [0, 1, 0], [0, 1, 0], [1, 0, 0]]),
        slides=np.array([True, False, False, False, False]),
        tip=tip,
    )


def test_the_freedoms_of_an_arm_are_counted() -> None:
    assert planar().freedoms == 4
    assert planar().few
    assert GROUP.freedoms == 6
    assert not GROUP.few


def test_an_arm_with_few_joints_reaches_a_pose_but_for_a_turn() -> None:
    group, missed = planar(), 0
    for seed in range(40):
        reached = group.tip_matrix(some_joints(seed, group))
        turn = float(np.random.default_rng(seed).uniform(-3.0, 3.0))
        about = reached[:3, 3] + reached[:3, :3] @ (0.03, 0.0, 0.0)
        turned = about_vertical(about, turn) @ reached
        local = np.linalg.inv(turned) @ np.append(about, 1.0)
        seeds = np.array([some_joints(seed + 1 + i, group) for i in range(30)])
        found, good = group.solve_upright(turned[None], about, seeds, math.inf)
        missed += not good.any()
        for q in found[0][good[0]]:
            pose = group.tip_matrix(q)
            assert pose[:3] @ local == pytest.approx(about, abs=1e-3)
            assert pose[2, :3] == pytest.approx(turned[2, :3], abs=5e-3)
    assert missed <= 2


def test_a_turn_has_a_limit_where_the_hand_must_lie_flat() -> None:
    group, start = planar(), np.array([0.3, 0.4, -0.9, 0.5, 0.0])
    reached = group.tip_matrix(start)
    about = reached[:3, 3]
    turned = about_vertical(about, 0.3) @ reached
    for limit, reaches in ((0.1, False), (0.5, True)):
        _, good = group.solve_upright(turned[None], about, start[None], limit)
        assert bool(good.any()) is reaches


def about_vertical(point: np.ndarray, turn: float) -> np.ndarray:
    """A turn (4, 4) about the vertical through a point (3,)."""
    c, s = math.cos(turn), math.sin(turn)
    made = np.eye(4)
    made[:2, :2] = [[c, -s], [s, c]]
    made[:3, 3] = point - made[:3, :3] @ point
    return made
