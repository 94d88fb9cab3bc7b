"""How wide a gripper is open, and where its fingers stand for it, are inverse to each other."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from momantu_bt.robot import Actuator, ActuatorKind, EndEffector, RobotDescription
from momantu_bt.testing.description import small_robot

WIDEST = 0.1


def hand(**opening: tuple[tuple[float, float], ...]) -> EndEffector:
    return (
        small_robot()
        .end_effector.model_copy(update={"opening": {}})
        .model_validate({**small_robot().end_effector.model_dump(), "opening": opening})
    )


@st.composite
def tables(draw: st.DrawFn) -> tuple[tuple[float, float], ...]:
    steps = draw(st.lists(st.tuples(st.floats(0.1, 1), st.floats(0.01, 1)), min_size=1, max_size=5))
    sign, start = draw(st.sampled_from((-1.0, 1.0))), draw(st.floats(-1, 1))
    total = sum(step for step, _ in steps)
    rows, width, position = [(0.0, start)], 0.0, start
    for step, change in steps:
        width += step
        position += sign * change
        rows.append((WIDEST * width / total, position))
    return (*rows[:-1], (WIDEST, rows[-1][1]))


@given(tables(), tables(), st.floats(-0.02, 0.12))
def test_width_undoes_positions_beyond_the_table_too(
    one: tuple[tuple[float, float], ...], other: tuple[tuple[float, float], ...], width: float
) -> None:
    effector = hand(a=one, b=other)
    assert effector.width(effector.positions(width)) == pytest.approx(width, abs=1e-9)


@given(tables())
def test_rows_of_the_table_are_met(rows: tuple[tuple[float, float], ...]) -> None:
    for width, position in rows:
        assert hand(a=rows).positions(width)["a"] == pytest.approx(position, abs=1e-9)


def test_fingers_without_a_table_share_the_opening() -> None:
    robot = small_robot()
    fingers = Actuator(kind=ActuatorKind.GRIPPER, joints=("left", "right"))
    data = robot.model_dump() | {"actuators": robot.actuators | {"gripper": fingers}}
    effector = RobotDescription.model_validate(data).end_effector
    assert effector.positions(0.06) == {"left": 0.03, "right": 0.03}
    assert effector.width({"left": 0.01, "right": 0.03}) == pytest.approx(0.04)


def test_a_gripper_without_joints_has_no_width_by_joints() -> None:
    assert small_robot().end_effector.positions(0.05) == {}
    with pytest.raises(ValueError, match="needs joints, and this gripper has none"):
        small_robot().end_effector.width({})


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (((0.0, 1.0),), "at least two rows"),
        (((0.01, 1.0), (0.1, 0.0)), "from width 0"),
        (((0.0, 1.0), (0.09, 0.0)), "to max_width"),
        (((0.0, 1.0), (0.05, 0.0), (0.05, -1.0), (0.1, -2.0)), "widths of a's opening must rise"),
        (((0.0, 1.0), (0.05, 0.0), (0.1, 0.5)), "must all rise, or all fall"),
    ],
)
def test_a_table_that_is_not_monotone_is_refused(
    rows: tuple[tuple[float, float], ...], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        hand(a=rows)
