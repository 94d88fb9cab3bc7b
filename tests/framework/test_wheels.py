"""Wheels other than believed: the motions they make, and a base that is told of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from momantu_bt.faults.effects.robot import layer
from momantu_bt.faults.spec import parse_fault
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import BaseVelocity
from momantu_bt.robot import WheelCorrection
from momantu_bt.robots.plugins import load_robot
from momantu_bt.testing import ScriptedRobot, small_robot
from momantu_bt.wheels import CorrectedBase, Wheels, between_wheels, corrected_base
from momantu_bt.world import TICK

share = st.floats(-0.1, 0.1)
wheels = st.builds(Wheels, share, share, share, st.floats(0.2, 1.0))
FASTER = BaseVelocity(0.4, 0.3)


@given(wheels, st.floats(-1, 1), st.floats(-2, 2))
def test_told_is_the_inverse_of_true(these: Wheels, way: float, turn: float) -> None:
    assert these.told(*these.true(way, turn)) == pytest.approx((way, turn), abs=1e-9)


@given(wheels, st.floats(-0.2, 0.2), st.floats(-0.01, 0.01), st.floats(-0.5, 0.5))
def test_steps_are_undone(these: Wheels, x: float, y: float, yaw: float) -> None:
    back = these.told_step(these.true_step(Pose2D(x, y, yaw)))
    assert (back.x, back.y, back.yaw) == pytest.approx((x, y, yaw), abs=1e-9)


@given(wheels, st.floats(-0.5, 0.5), st.floats(-1, 1))
def test_one_step_goes_where_many_small_ones_go(these: Wheels, way: float, turn: float) -> None:
    whole, small, piece = these.true(way, turn), Pose2D(0, 0, 0), 400
    for _ in range(piece):
        half = whole[1] / piece / 2
        length = whole[0] / piece
        small @= Pose2D(length * math.cos(half), length * math.sin(half), 2 * half)
    half = turn / 2
    chord = way * float(np.sinc(half / math.pi))
    told = Pose2D(chord * math.cos(half), chord * math.sin(half), turn)
    once = these.true_step(told)
    assert (once.x, once.y, once.yaw) == pytest.approx((small.x, small.y, small.yaw), abs=1e-5)


def test_a_larger_left_wheel_turns_the_base_to_the_right() -> None:
    way, turn = Wheels(0.02, 0.0, 0.0, 0.4).true(1.0, 0.0)
    assert way == pytest.approx(1.01)
    assert turn == pytest.approx(-0.02 / 0.4)
    assert Wheels(0.0, 0.0, 0.05, 0.4).true(0.0, 1.0) == pytest.approx((0.0, 1 / 1.05))


@given(wheels, wheels)
def test_corrections_are_written_and_read_again_and_add_up(one: Wheels, two: Wheels) -> None:
    again = Wheels.of(one.then(two).correction())
    assert 1 + again.left == pytest.approx((1 + one.left) * (1 + two.left))
    assert 1 + again.right == pytest.approx((1 + one.right) * (1 + two.right))
    assert 1 + again.track == pytest.approx((1 + one.track) * (1 + two.track))
    assert again.between == one.between


def test_the_distance_of_the_wheels_is_read_from_the_urdf() -> None:
    assert between_wheels(load_robot("fetch")) == pytest.approx(0.3748, abs=1e-3)
    assert between_wheels(small_robot()) > 0.05


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_correction_makes_up_for_a_wheel(side: str) -> None:
    inner = ScriptedRobot()
    bent = layer(inner, parse_fault(f"base.wheel:factor=1.05,side={side}"), seed=1)
    bent.begin()
    half = 0.05 if side == "right" else -0.05
    correction = WheelCorrection(
        radius=0.025, left_to_right=half, between=between_wheels(inner.description)
    )
    robot = CorrectedBase(bent, correction)
    for _ in range(60):
        robot.command("base", FASTER)
        inner.advance(TICK)
        robot.state()
        bent.state()
    true, told = (Pose2D.from_transform(r.state().odom_from_base) for r in (inner, robot))
    wrong = Pose2D.from_transform(bent.state().odom_from_base)
    assert (told.x, told.y, told.yaw) == pytest.approx((true.x, true.y, true.yaw), abs=1e-6)
    assert math.hypot(wrong.x - true.x, wrong.y - true.y) > 0.01
    sent = inner.commands[-1][2]
    assert (sent.linear, sent.angular) == pytest.approx((FASTER.linear, FASTER.angular))
    assert robot.state().linear == pytest.approx(inner.state().linear)
    assert robot.state().angular == pytest.approx(inner.state().angular)


def test_speeds_stay_within_the_base_s_limits() -> None:
    inner = ScriptedRobot()
    fastest = inner.description.base.linear
    robot = CorrectedBase(inner, WheelCorrection(radius=-0.1, between=0.4))
    robot.command("base", BaseVelocity(fastest, 0.0))
    assert inner.commands[-1][2].linear == fastest


def test_a_robot_without_a_correction_is_left_alone() -> None:
    inner = ScriptedRobot()
    assert corrected_base(inner) is inner
    told = small_robot().model_copy(update={"wheels": WheelCorrection(between=0.4)})
    assert isinstance(corrected_base(ScriptedRobot(told)), CorrectedBase)
