"""A URDF as a tree: what hangs on what, and what is no tree."""

from __future__ import annotations

import pytest
from momantu_skills.robot_setup.urdf.skeleton import SetupError, Skeleton, read_skeleton

from momantu_bt.formats.urdf import Urdf, parse_urdf


def link(name: str, shape: str = "") -> str:
    return f'<link name="{name}">{shape}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", **more: str) -> str:
    limit = more.get("limit", 'lower="-1" upper="1" velocity="1" effort="1"')
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{more.get("xyz", "0 0 0")}"/><limit {limit}/>{more.get("extra", "")}</joint>'
    )


SHAPE = '<collision><geometry><box size="1 1 1"/></geometry></collision>'


def skeleton(*elements: str) -> Skeleton:
    return read_skeleton(
        Urdf(parse_urdf(f"<robot name='r'>{''.join(elements)}</robot>".encode(), "r.urdf"))
    )


CHAIN = (
    link("a", SHAPE),
    link("b"),
    link("c"),
    link("d"),
    joint("ab", "a", "b"),
    joint("bc", "b", "c", kind="fixed"),
    joint("cd", "c", "d", kind="continuous"),
)


def test_chains_and_rigid_pieces() -> None:
    found = skeleton(*CHAIN)
    assert found.root == "a"
    assert [j.name for j in found.chain("d")] == ["ab", "bc", "cd"]
    assert found.rigid("c") == found.rigid("b") == ("b", "c")
    assert found.rigid_root("c") == "b"
    assert set(found.subtree("b")) == {"b", "c", "d"}
    assert [j.name for j in found.branches("b")] == ["cd"]
    assert [j.name for j in found.moving_below("b")] == ["cd"]
    assert found.links["a"].collisions == 1


def test_every_link_below_the_root_hangs_on_the_joint_that_carries_it() -> None:
    found = skeleton(*CHAIN)
    for name in found.subtree(found.root):
        above = found.above(name)
        assert (above is None) == (name == found.root)
        assert above is None or above in found.below(above.parent)


def test_joints_that_follow_are_read() -> None:
    follow = '<mimic joint="ab" multiplier="-2" offset="0.1"/>'
    found = skeleton(*CHAIN, link("e"), joint("ae", "a", "e", extra=follow))
    mimic = found.joints["ae"].mimic
    assert mimic is not None
    assert (mimic.leader, mimic.multiplier, mimic.offset) == ("ab", -2.0, 0.1)
    assert found.joints["ab"].mimic is None


def test_a_joint_without_a_range_turns_half_a_turn_each_way() -> None:
    found = skeleton(*CHAIN, link("e"), joint("ae", "a", "e", limit='velocity="1" effort="1"'))
    low, high = found.joints["ae"].range
    assert high == -low == pytest.approx(3.14159, abs=1e-4)


@pytest.mark.parametrize(
    ("elements", "words"),
    [
        ((link("a"), link("b")), "one root"),
        ((link("a"), joint("ab", "a", "b")), "missing link 'b'"),
        ((link("a"), link("b"), joint("x", "a", "b"), joint("y", "b", "a")), "one root"),
        ((link("a"), link("b"), link("c"), joint("x", "b", "c"), joint("y", "c", "b")), "circle"),
        ((link("a"), link("b"), joint("x", "a", "b"), joint("y", "a", "b")), "two parents: b"),
        ((link("a"), link("b"), joint("x", "a", "b", xyz="0 zero 0")), "cannot be read"),
        ((link("a"), link("b"), joint("x", "a", "b", xyz="0 0")), "cannot be read"),
    ],
)
def test_what_is_no_tree_is_refused(elements: tuple[str, ...], words: str) -> None:
    with pytest.raises(SetupError, match=words):
        skeleton(*elements)


def test_two_joints_of_one_name_are_told() -> None:
    with pytest.raises(SetupError, match=r"two joints are called 'ab', one to 'b' and one to 'c'"):
        skeleton(link("a"), link("b"), link("c"), joint("ab", "a", "b"), joint("ab", "a", "c"))


def test_a_joint_that_follows_another_one_has_room_for_what_that_asks() -> None:
    other_way = '<mimic joint="ab" multiplier="-1"/>'
    ranges = {"limit": 'lower="0" upper="0.8" velocity="1" effort="1"'}
    found = skeleton(
        link("a"),
        link("b"),
        link("c"),
        joint("ab", "a", "b", **ranges),
        joint("bc", "b", "c", **ranges, extra=other_way),
    )
    assert found.joints["ab"].range == (0.0, 0.8)
    assert found.joints["bc"].range == (-0.8, 0.8)
