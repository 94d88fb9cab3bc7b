"""Collision checks: the robot against itself, solids, cells and what it carries."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.collision import (
    Attached,
    BodyPairs,
    Cells,
    CollisionWorld,
    Obstacle,
    body_pairs,
)
from momantu_skills.manipulation.model.hulls import convex, prism

from momantu_bt.geometry import Transform


def named(model: ArmModel, pose: str) -> np.ndarray:
    values = model.description.named_poses[pose]
    return np.array([values[name] for name in model.group.names])


def rest(model: ArmModel) -> np.ndarray:
    return np.zeros(model.pin.nq)


def around_hand(model: ArmModel, q: np.ndarray, half: float, above: float = 0.0) -> np.ndarray:
    centre = model.group.tip_pose(q).position + np.array((0.0, 0.0, above))
    corners = np.array(list(product((-1, 1), repeat=3)))
    return np.asarray(centre) + half * corners


@pytest.mark.parametrize("pose", ["home", "ready", "carry", "look_around"])
def test_named_poses_touch_nothing(model: ArmModel, body: BodyPairs, pose: str) -> None:
    world = CollisionWorld(body, rest(model))
    assert world.free(named(model, pose)), world.touching(named(model, pose))


def test_a_hand_in_its_own_chest_is_seen(model: ArmModel, body: BodyPairs) -> None:
    q = named(model, "ready")
    q[model.group.names.index("elbow_flex_joint")] = 2.25
    q[model.group.names.index("wrist_flex_joint")] = 2.1
    world = CollisionWorld(body, rest(model))
    assert not world.free(q)
    assert world.touching(q)


def test_a_solid_around_the_hand_is_touched(model: ArmModel, body: BodyPairs) -> None:
    q = named(model, "carry")
    world = CollisionWorld(body, rest(model), [Obstacle("thing", around_hand(model, q, 0.02))])
    assert not world.free(q)
    assert all(other == "thing" for _, other in world.touching(q))


def test_cells_are_placed_by_their_frame(model: ArmModel, body: BodyPairs) -> None:
    q = named(model, "carry")
    hand = model.group.tip_pose(q).position
    base_from_odom = Transform((1.0, -2.0, 0.0), (np.cos(0.4), 0, 0, np.sin(0.4)))
    cells = base_from_odom.inverse().apply(hand[None])
    there = CollisionWorld(body, rest(model), cells=[Cells("cells", cells, 0.02, base_from_odom)])
    elsewhere = CollisionWorld(body, rest(model), cells=[Cells("cells", cells, 0.02, Transform())])
    assert not there.free(q)
    assert elsewhere.free(q)


@pytest.mark.parametrize("gap", [0.005, 0.02])
def test_the_margin_is_kept(model: ArmModel, body: BodyPairs, gap: float) -> None:
    q = named(model, "carry")
    full = rest(model)
    full[model.group_index] = q
    poses = model.link_poses(full)
    ends = [hull @ poses[k][:3, :3].T + poses[k][:3, 3] for k, hull in model.hulls.items()]
    front = float(np.vstack(ends)[:, 0].max())
    wall = np.array(
        [(x, y, z) for x in (front + gap, front + 1) for y in (-1, 1) for z in (0.0, 2.0)]
    )
    for margin in (0.0, 0.012):
        world = CollisionWorld(body, full, [Obstacle("wall", wall)], margin=margin)
        assert world.free(q) is (gap > margin)


def test_what_is_held_takes_up_room(model: ArmModel, body: BodyPairs) -> None:
    q = named(model, "carry")
    beside = around_hand(model, q, 0.01, above=0.1)
    thing = Obstacle("thing", beside)
    held = Attached(prism(0.035, 0.26))
    upright = model.group.tip_pose(q).inverse()
    corners = Transform((0, 0, 0), upright.quaternion).apply(held.corners)
    assert CollisionWorld(body, rest(model), [thing]).free(q)
    world = CollisionWorld(body, rest(model), [thing], attached=Attached(corners))
    assert world.touching(q) == [("held", "thing")]


def test_only_a_support_may_be_touched_by_what_is_held(model: ArmModel, body: BodyPairs) -> None:
    q = named(model, "carry")
    below = around_hand(model, q, 0.01, above=-0.1)
    held = Attached(prism(0.1, 0.26))
    for support in (True, False):
        world = CollisionWorld(
            body,
            rest(model),
            [Obstacle("top", below, support=support)],
            attached=held,
            held_on_support=True,
        )
        touching = [pair for pair in world.touching(q) if pair == ("held", "top")]
        assert bool(touching) is not support


def test_the_floor_is_not_passed(model: ArmModel, body: BodyPairs) -> None:
    random = np.random.default_rng(0)
    lower = np.where(model.group.endless, -np.pi, model.group.lower)
    upper = np.where(model.group.endless, np.pi, model.group.upper)
    world, full, below = CollisionWorld(body, rest(model)), rest(model), 0
    for _ in range(400):
        q = random.uniform(lower, upper)
        full[model.group_index] = q
        pose = model.link_poses(full)["gripper_link"]
        if (model.hulls["gripper_link"] @ pose[:3, :3].T + pose[:3, 3])[:, 2].min() < -0.01:
            below += 1
            assert not world.free(q)
    assert below


def test_the_broadphase_agrees_with_all_pairs(model: ArmModel, table: Obstacle) -> None:
    random = np.random.default_rng(1)
    world = CollisionWorld(body_pairs(model), rest(model), [table])
    lower = np.where(model.group.endless, -np.pi, model.group.lower)
    upper = np.where(model.group.endless, np.pi, model.group.upper)
    answers = []
    for _ in range(60):
        q = random.uniform(lower, upper)
        answers.append(world.free(q))
        assert answers[-1] is not bool(world.touching(q))
    assert len(set(answers)) == 2


def test_the_same_corners_give_the_same_shape() -> None:
    assert convex(prism(0.03, 0.1)) is convex(prism(0.03, 0.1))
