"""A finger joint takes every position of its opening, whatever range its URDF gives it."""

from __future__ import annotations

from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st
from momantu_worlds.sapien.build.robot_model import give_room

OPENING = {"tip": ((0.0, -0.8), (0.04, -0.4), (0.08, 0.0))}


@given(st.floats(-1.0, 0.5), st.floats(0.5, 1.0))
def test_a_finger_has_room_for_its_opening_and_keeps_what_it_had(low: float, high: float) -> None:
    joint = SimpleNamespace(name="tip", joint_type="revolute_unwrapped", limits=[[low, high]])
    give_room(joint, OPENING)
    assert joint.limits == [[min(low, -0.8), max(high, 0.0)]]


def test_other_joints_and_endless_ones_keep_their_range() -> None:
    for name, kind in (("elbow", "revolute_unwrapped"), ("tip", "fixed")):
        joint = SimpleNamespace(name=name, joint_type=kind, limits=[[0.0, 0.5]])
        give_room(joint, OPENING)
        assert joint.limits == [[0.0, 0.5]]
