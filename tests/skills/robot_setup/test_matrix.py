"""Laws of the self-collision matrix."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest
from momantu_skills.robot_setup.find.base import find_base
from momantu_skills.robot_setup.find.matrix import SAMPLES, CollisionMatrix, Why, sample_matrix
from momantu_skills.robot_setup.urdf.body import Body, Contacts
from momantu_skills.robot_setup.urdf.prepare import Placed, prepare

from tests.skills.robot_setup.conftest import body_of, box, joint, link


@pytest.fixture(scope="module")
def body(rolling_urdf: Path, tmp_path_factory: pytest.TempPathFactory) -> Body:
    prepared = prepare(rolling_urdf, tmp_path_factory.mktemp("cleaned"))
    base = find_base(prepared.skeleton)
    return Body(prepared.skeleton, Placed(prepared.urdf, base.frame))


@pytest.fixture(scope="module")
def matrix(body: Body) -> CollisionMatrix:
    return sample_matrix(body, SAMPLES, seed=1)


def test_every_pair_has_one_entry_and_its_order_does_not_matter(
    body: Body, matrix: CollisionMatrix
) -> None:
    pairs = [frozenset(pair) for pair in matrix.why]
    assert len(pairs) == len(set(pairs))
    assert set(pairs) == {frozenset(pair) for pair in combinations(body.hulls, 2)}


def test_links_that_share_a_joint_are_adjacent(body: Body, matrix: CollisionMatrix) -> None:
    for (one, other), why in matrix.why.items():
        shared = body.skeleton.rigid_root(one) == body.skeleton.rigid_root(other)
        for a, b in ((one, other), (other, one)):
            above = body.skeleton.above(body.skeleton.rigid_root(a))
            shared |= above is not None and body.skeleton.rigid_root(
                above.parent
            ) == body.skeleton.rigid_root(b)
        assert (why is Why.ADJACENT) == shared, (one, other)


def test_a_never_pair_does_not_meet_in_a_thousand_fresh_postures(
    body: Body, matrix: CollisionMatrix
) -> None:
    never = Contacts(body, matrix.pairs(Why.NEVER))
    assert len(never.pairs) > 5
    for q in body.random_configurations(1000, seed=77):
        assert never.names(q) == []


def test_the_fingers_meet_at_rest_and_are_ignored(matrix: CollisionMatrix) -> None:
    assert matrix.why["left_finger", "right_finger"] is Why.DEFAULT
    assert ("left_finger", "right_finger") in matrix.ignored
    assert not set(matrix.ignored) & set(matrix.checked)


def test_an_arm_can_meet_its_base(matrix: CollisionMatrix) -> None:
    assert matrix.why["base_link", "palm"] is Why.SOMETIMES
    assert 0 < matrix.share["base_link", "palm"] < 1


def test_the_same_seed_gives_the_same_matrix(body: Body) -> None:
    assert sample_matrix(body, 200, seed=4) == sample_matrix(body, 200, seed=4)


def test_joints_that_follow_do_so_in_samples(
    bolted_xacro: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    prepared = prepare(bolted_xacro, tmp_path_factory.mktemp("cleaned"))
    bolted = Body(prepared.skeleton, Placed(prepared.urdf, "base_link"))
    left, right = bolted.index["left_hinge"], bolted.index["right_hinge"]
    for q in bolted.random_configurations(20, seed=3):
        assert q[left] == q[right]


def tube(folder: Path, half: float, length: float, bent: float) -> str:
    """A mesh of a bar below the origin, one side `bent` m farther out, as rounding leaves it."""
    corners = [
        f"v {x} {y} {z}" for x in (-half, half) for y in (-half, half + bent) for z in (-length, 0)
    ]
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    path = folder / f"{half}.obj"
    path.write_text("\n".join((*corners, *(f"f {face}" for face in faces))))
    return f'<mesh filename="{path}"/>'


@pytest.mark.parametrize("rpy", ["0 0 0", "1.5708 0 0", "-0.2 -0.3 -1.8", "2.2 0.4 -2.7"])
def test_tubes_that_slide_in_each_other_meet_at_rest(tmp_path: Path, rpy: str) -> None:
    slide = 'lower="0" upper="0.1" velocity="1" effort="30"'
    tubes = body_of(
        link("base_link", box(0.4, 0.3, 0.2)),
        link("outer", tube(tmp_path, 0.037725, 0.2225, 4e-9)),
        link("middle", tube(tmp_path, 0.0357, 0.2265, 0.0)),
        link("inner", tube(tmp_path, 0.033675, 0.2265, 0.0)),
        joint("mast", "base_link", "outer", "0 0 1", kind="prismatic", limit=slide, rpy=rpy),
        joint("first", "outer", "middle", kind="prismatic", limit=slide),
        joint("second", "middle", "inner", "0 0 0.086", kind="prismatic", limit=slide),
    )
    assert Contacts(tubes, [("outer", "inner")]).meeting(tubes.configuration({}))[0]
    assert ("outer", "inner") in sample_matrix(tubes, samples=20).ignored
