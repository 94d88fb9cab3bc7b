"""A fingerprint counts every ingredient, and nothing that depends on where the files lie."""

from __future__ import annotations

from dataclasses import fields, replace
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.engine.encode import encode
from momantu_bt.engine.fingerprint import Fingerprint
from momantu_bt.engine.skills.actuators import Issued
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import (
    BaseVelocity,
    GripperCommand,
    JointPositions,
    JointTrajectory,
    RobotState,
    frozen,
)
from momantu_bt.testing import ScriptedRobot


def of(state=None, issued=(), statuses=(), written=()):
    fingerprint = Fingerprint()
    fingerprint.add(state, issued, statuses, written)
    return fingerprint.hexdigest()


STATE = ScriptedRobot().state()
CHANGED = {
    "stamp": 0.05,
    "positions": frozen(np.full(len(STATE.names), 1e-300)),
    "velocities": frozen(np.full(len(STATE.names), -0.0)),
    "efforts": frozen(np.full(len(STATE.names), 1.0)),
    "odom_from_base": Transform((1e-12, 0.0, 0.0)),
    "linear": -0.0,
    "angular": 1e-9,
    "gripper_width": np.nextafter(STATE.gripper_width, 1.0),
    "gripper_effort": 30.0,
    "lateral": 1e-9,
}


def test_every_measured_part_of_the_robots_state_is_tried_here():
    assert {field.name for field in fields(RobotState)} == {*CHANGED, "names"}


@pytest.mark.parametrize("name", CHANGED)
def test_the_smallest_change_of_the_robots_state_counts(name):
    assert of(replace(STATE, **{name: CHANGED[name]})) != of(STATE)


def test_turning_on_the_spot_counts():
    turned = Transform((0.0, 0.0, 0.0), (np.cos(1e-6), 0.0, 0.0, np.sin(1e-6)))
    assert of(replace(STATE, odom_from_base=turned)) != of(STATE)


def trajectory(end=1.0, time=1.0, speed=0.0, names=("lift",)):
    return JointTrajectory(
        names,
        np.array([0.0, time]),
        np.array([[0.0], [end]]),
        np.array([[0.0], [speed]]),
    )


COMMANDS = [
    (),
    (Issued("base", BaseVelocity(0.1, 0.0)),),
    (Issued("base", BaseVelocity(0.0, 0.1)),),
    (Issued("base", BaseVelocity(0.0, 0.0, 0.1)),),
    (Issued("base", None),),
    (Issued("arm", None),),
    (Issued("base", None), Issued("arm", None)),
    (Issued("arm", None), Issued("base", None)),
    (Issued("base", None), Issued("base", None)),
    (Issued("gripper", GripperCommand(0.1, 0.0)),),
    (Issued("gripper", GripperCommand(0.0, 0.1)),),
    (Issued("arm", JointPositions(("lift",), (0.1,))),),
    (Issued("arm", JointPositions(("elbow",), (0.1,))),),
    (Issued("arm", trajectory()),),
    (Issued("arm", trajectory(end=1.1)),),
    (Issued("arm", trajectory(time=1.1)),),
    (Issued("arm", trajectory(speed=0.1)),),
    (Issued("arm", trajectory(names=("elbow",))),),
]


def test_every_command_and_stop_counts_and_so_does_their_order():
    assert len({of(issued=issued) for issued in COMMANDS}) == len(COMMANDS)


def test_a_trajectory_counts_by_its_numbers_not_by_which_object_it_is():
    same, once = trajectory(), Fingerprint()
    again = Fingerprint()
    for goal in (same, same, trajectory(end=0.5), same):
        once.add(None, [Issued("arm", goal)], (), ())
    for end in (1.0, 1.0, 0.5, 1.0):
        again.add(None, [Issued("arm", trajectory(end=end))], (), ())
    assert once.hexdigest() == again.hexdigest()


def test_a_goal_that_changes_counts_in_each_tick():
    def digest(*ends):
        fingerprint = Fingerprint()
        for end in ends:
            fingerprint.add(None, [Issued("arm", trajectory(end=end))], (), ())
        return fingerprint.hexdigest()

    assert len({digest(1.0, 1.0), digest(1.0, 0.5), digest(0.5, 1.0)}) == 3


NAMES = st.sampled_from(["", "a", "b", "ab", "0/Sub/a"])
VALUES = st.none() | st.booleans() | st.integers(-2, 2) | st.text("ab", max_size=2)
TICKS = st.lists(
    st.tuples(
        st.lists(st.tuples(st.integers(0, 12), st.sampled_from(["RUNNING", "IDLE"])), max_size=2),
        st.lists(st.tuples(NAMES, VALUES), max_size=2),
    ),
    max_size=3,
)


def typed(ticks):
    return [(s, [(name, type(value), value) for name, value in w]) for s, w in ticks]


@given(left=TICKS, right=TICKS)
def test_runs_with_different_statuses_or_writes_differ(left, right):
    def digest(ticks):
        fingerprint = Fingerprint()
        for statuses, written in ticks:
            fingerprint.add(None, (), statuses, written)
        return fingerprint.hexdigest()

    assert (digest(left) == digest(right)) == (typed(left) == typed(right))


def test_an_empty_tick_is_a_tick():
    once, twice = Fingerprint(), Fingerprint()
    once.add(None, (), (), ())
    for _ in range(2):
        twice.add(None, (), (), ())
    assert once.hexdigest() != twice.hexdigest()


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"place": "table_a"}, {"place": "table_b"}),
        (({"place": 1},), ({"place": 2},)),
        (np.array([1.0, 2.0]), np.array([1.0, 2.0], dtype=np.float32)),
        (np.zeros((2, 3)), np.zeros((3, 2))),
        (np.array(["a", None], dtype=object), np.array(["b", None], dtype=object)),
        (1, True),
        (1, 1.0),
        ("1", 1),
        ((), None),
        ((1, (2,)), ((1, 2),)),
        (Pose2D(0.0, 1.0, 0.0), Pose2D(1.0, 0.0, 0.0)),
        (FailureValue("A", ""), FailureValue("B", "")),
        (FailureValue("A", "", {"place": "here"}), FailureValue("A", "", {"place": "there"})),
        (FailureValue("A", "", tries=1), FailureValue("A", "", tries=2)),
        (
            FailureValue("A", "", cause=FailureValue("B", "")),
            FailureValue("A", "", cause=FailureValue("C", "")),
        ),
    ],
    ids=str,
)
def test_values_that_differ_have_different_bytes(one, other):
    assert encode(one) != encode(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ([1, 2], (1, 2)),
        ({"a": 1}, MappingProxyType({"a": 1})),
        (np.float64(0.5), 0.5),
        (np.int32(3), 3),
        (np.array(["a"], dtype=object), np.array(["a"], dtype=object)),
        (
            FailureValue("A", "", cause=FailureValue("B", "", {"traceback": "x"}, place="/a:1")),
            FailureValue("A", "", cause=FailureValue("B", "", {"traceback": "y"}, place="/b:1")),
        ),
        (
            FailureValue("A", "", beside=(FailureValue("B", "", place="/a:1"),)),
            FailureValue("A", "", beside=(FailureValue("B", "", place="/b:1"),)),
        ),
    ],
    ids=str,
)
def test_values_that_mean_the_same_have_the_same_bytes(one, other):
    assert encode(one) == encode(other)


def test_text_that_is_no_unicode_can_be_counted():
    """Arguments of a command line that are not UTF-8 hold such characters."""
    assert encode("\udcff") != encode("\udcfe")


class Opaque:
    """A value that nothing is known of; its address must not count."""


def test_a_value_of_an_unknown_kind_counts_by_its_type():
    assert encode(Opaque()) == encode(Opaque())
    assert b"0x" not in encode([Opaque(), {"a": Opaque()}])
