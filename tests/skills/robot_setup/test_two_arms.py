"""A robot with two arms: the one that skills do not use is folded on its own side."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from momantu_skills.robot_setup.find.arms import Limbs, find_limbs
from momantu_skills.robot_setup.find.base import find_stand
from momantu_skills.robot_setup.find.fingers import find_hands
from momantu_skills.robot_setup.find.named import fold_others
from momantu_skills.robot_setup.find.poses import PoseFinder
from momantu_skills.robot_setup.urdf.body import Body, Contacts

from tests.skills.robot_setup.conftest import body_of, box, joint, link, rod


def arm(side: str, y: float) -> list[str]:
    """Four joints that point ahead at rest, and two fingers that slide."""
    slide = 'lower="0" upper="0.04" velocity="0.05" effort="20"'
    return [
        link(f"{side}_1", box(0.06, 0.06, 0.06)),
        link(f"{side}_2", rod(0.25), "0.16 0 0", rpy="0 1.5708 0"),
        link(f"{side}_3", rod(0.25), "0.16 0 0", rpy="0 1.5708 0"),
        link(f"{side}_palm", box(0.04, 0.1, 0.04), "0.03 0 0"),
        joint(f"{side}_pan", "base_link", f"{side}_1", f"0.15 {y} 0.7"),
        joint(f"{side}_lift", f"{side}_1", f"{side}_2", axis="0 1 0"),
        joint(f"{side}_elbow", f"{side}_2", f"{side}_3", "0.32 0 0"),
        joint(f"{side}_roll", f"{side}_3", f"{side}_palm", "0.32 0 0", "1 0 0"),
        link(f"{side}_lf", box(0.05, 0.01, 0.02), "0.08 0.005 0", 0.05),
        link(f"{side}_rf", box(0.05, 0.01, 0.02), "0.08 -0.005 0", 0.05),
        joint(f"{side}_ls", f"{side}_palm", f"{side}_lf", "0 0 0", "0 1 0", "prismatic", slide),
        joint(f"{side}_rs", f"{side}_palm", f"{side}_rf", "0 0 0", "0 -1 0", "prismatic", slide),
    ]


@pytest.fixture(scope="module")
def twins() -> tuple[Body, Limbs]:
    base = link("base_link", box(0.5, 0.5, 0.6), "0 0 0.3", 30)
    body = body_of(base, *arm("right", -0.2), *arm("left", 0.2))
    return body, find_limbs(body, find_hands(body), None, ())


def test_the_other_arm_stands_on_its_own_side_and_clear(twins: tuple[Body, Limbs]) -> None:
    body, limbs = twins
    (other,) = limbs.others
    assert limbs.arm is not None
    pairs = [p for p in combinations(body.hulls, 2) if not body.shapes.adjacent(*p)]
    hands = [set(limb.hand.links) for limb in (limbs.arm, other) if limb.hand]
    pairs = [pair for pair in pairs if not any(set(pair) <= hand for hand in hands)]
    folded = fold_others(body, limbs, find_stand(body), pairs, 0)
    assert set(folded) == set(other.joints)
    side = np.sign(body.link_poses({}, [other.tip])[other.tip][1, 3])
    moved = body.corners(body.skeleton.subtree(other.tip), folded)
    assert (side * moved[:, 1]).min() > -0.1
    assert Contacts(body, pairs).free(body.configuration(folded))
    reach = body.corners(body.skeleton.subtree(other.tip), {})[:, 0].max()
    assert moved[:, 0].max() < reach - 0.2


def test_parts_of_one_hand_that_are_near_each_other_keep_no_pose_from_being_found(
    twins: tuple[Body, Limbs],
) -> None:
    body, limbs = twins
    pairs = [p for p in combinations(body.hulls, 2) if not body.shapes.adjacent(*p)]
    finder = PoseFinder(body, limbs, find_stand(body), pairs, None)
    posture, margin = finder.folded(lambda q: finder.outside(finder.corners(q)), dict(finder.still))
    assert margin is not None
    assert finder.clear(posture, margin)
