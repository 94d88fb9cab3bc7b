"""A motor that pushes against something is noticed; weight, jerks and noise are not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.motion.following import follow
from momantu_skills.manipulation.motion.strain import LASTING, LEAST, SHARE, Push, Strain, slow
from momantu_skills.manipulation.motion.timing import timed

from momantu_bt.failure import Failure
from tests.skills.manipulation.test_motion import run

LIMITS = np.array([100.0, 60.0, np.inf, 0.0])


def felt(rows: np.ndarray, limits: np.ndarray = LIMITS) -> list[Push]:
    """All that is felt while efforts (k, n) come in."""
    strain = Strain(limits)
    return [push for row in rows if (push := strain.felt(row)) is not None]


@given(st.floats(-90.0, 90.0), st.floats(-1.0, 1.0), st.integers(0, 1000))
def test_weight_that_changes_slowly_is_no_push(start: float, step: float, seed: int) -> None:
    noise = np.random.default_rng(seed).normal(0.0, 1.0, (60, 4))
    assert not felt(start + step * np.arange(60)[:, None] + noise)


@given(st.floats(-50.0, 50.0), st.sampled_from([-1.0, 1.0]), st.integers(0, 1))
def test_a_rise_that_lasts_is_a_push_of_its_joint(before: float, sign: float, joint: int) -> None:
    rows = np.full((30, 4), before)
    rows[20:, joint] += sign * (SHARE * LIMITS[joint] + 1.0)
    found = felt(rows)
    assert found[0].joint == joint
    assert found[0].rise == pytest.approx(SHARE * LIMITS[joint] + 1.0)


def test_it_is_felt_as_soon_as_it_has_lasted() -> None:
    strain, still, pushed = Strain(LIMITS), np.zeros(4), np.array([90.0, 0.0, 0.0, 0.0])
    for _ in range(20):
        assert strain.felt(still) is None
    for _ in range(LASTING - 1):
        assert strain.felt(pushed) is None
    assert strain.felt(pushed) is not None


def test_a_jerk_of_one_tick_is_no_push() -> None:
    rows = np.zeros((30, 4))
    rows[15] = 99.0
    assert not felt(rows)


def test_joints_of_which_nothing_is_known_tell_nothing() -> None:
    rows = np.zeros((30, 4))
    rows[15:, 2:] = 500.0
    assert not felt(rows)
    assert not felt(np.full((30, 4), np.nan))


def test_a_weak_joint_tells_only_what_is_more_than_friction() -> None:
    rows = np.zeros((30, 4))
    rows[15:, 0] = LEAST - 1.0
    assert not felt(rows, np.array([8.0, 60.0, 60.0, 60.0]))


def test_only_slow_motions_tell(swing: Any, model: ArmModel) -> None:
    _, trajectory = swing
    assert not slow(trajectory)
    path = trajectory.positions[[0, -1]]
    assert slow(timed(model.group, path, PlanningConfig(), joint_speed=0.1))


def test_an_arm_that_pushes_stops_before_it_lags(swing: Any, model: ArmModel) -> None:
    robot, trajectory = swing
    plain = robot.state

    def state() -> Any:
        found = plain()
        efforts = np.zeros(len(found.names))
        if robot.now() > 0.5:
            efforts[found.names.index("shoulder_pan_joint")] = 30.0
        return replace(found, efforts=efforts)

    robot.state = state
    with pytest.raises(Failure, match="pushes against something") as caught:
        run(follow(robot, robot, "arm", trajectory, strain=Strain(model.efforts)), robot)
    assert caught.value.code == "ARM_STUCK"
    assert caught.value.value.data["joint"] == "shoulder_pan_joint"
    assert caught.value.value.data["rise"] == pytest.approx(30.0)
    assert robot.now() < 0.5 + 0.05 * (LASTING + 1)
