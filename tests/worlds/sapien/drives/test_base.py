"""The base's driver ramps within its limits, goes sideways if it can, and stops by itself."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.sapien.config import STEP, SUB_STEPS
from momantu_worlds.sapien.drives.base import BaseDrive

from momantu_bt.messages import BaseVelocity, GripperCommand
from momantu_bt.robot import BaseKind, BaseLimits
from momantu_bt.world import TICK

LIMITS = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)


class FakeJoint:
    """Remembers its speed target."""

    speed = 0.0

    def set_drive_velocity_target(self, value: float) -> None:
        self.speed = value


def bench(limits: BaseLimits = LIMITS) -> tuple[BaseDrive, list[FakeJoint]]:
    joints = [FakeJoint(), FakeJoint(), FakeJoint()]
    return BaseDrive(*joints, limits), joints


@given(yaw=st.floats(-10.0, 10.0), lateral=st.floats(-0.4, 0.4))
def test_an_omnidirectional_base_goes_sideways(yaw: float, lateral: float) -> None:
    drive, (x, y, turn) = bench(
        LIMITS.model_copy(update={"kind": BaseKind.OMNIDIRECTIONAL, "lateral": 0.4})
    )
    drive.command(BaseVelocity(0.0, 0.0, lateral), 0.0)
    drive.begin_tick(0.0)
    for _ in range(round(0.5 / STEP)):
        drive.apply(yaw)
    along = x.speed * math.cos(yaw) + y.speed * math.sin(yaw)
    across = -x.speed * math.sin(yaw) + y.speed * math.cos(yaw)
    assert (along, across, turn.speed) == pytest.approx((0.0, lateral, 0.0), abs=1e-9)
    with pytest.raises(ValueError, match=r"sideways at 0.5 m/s; the limit is 0.4 m/s"):
        drive.command(BaseVelocity(0.0, 0.0, 0.5), 0.0)


@settings(deadline=None)
@given(
    goals=st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.5, 1.5)), max_size=20),
    yaw=st.floats(-10.0, 10.0),
)
def test_limits_are_kept_and_motion_is_along_the_heading(
    goals: list[tuple[float, float]], yaw: float
) -> None:
    drive, (x, y, turn) = bench()
    before = (0.0, 0.0)
    for i, goal in enumerate(goals):
        drive.command(BaseVelocity(*goal), i * TICK)
        drive.begin_tick(i * TICK)
        for _ in range(SUB_STEPS):
            drive.apply(yaw)
            along = x.speed * math.cos(yaw) + y.speed * math.sin(yaw)
            across = -x.speed * math.sin(yaw) + y.speed * math.cos(yaw)
            assert abs(across) < 1e-12
            assert abs(along - before[0]) <= 1.0 * STEP + 1e-12
            assert abs(turn.speed - before[1]) <= 3.0 * STEP + 1e-12
            before = (along, turn.speed)


def test_it_stops_when_nobody_commands() -> None:
    drive, (x, _, _) = bench()
    now = 0.0
    for _ in range(20):
        drive.command(BaseVelocity(0.5, 0.0), now)
        now = _tick(drive, now)
    assert x.speed == pytest.approx(0.5)
    for _ in range(4):
        now = _tick(drive, now)
    assert x.speed == pytest.approx(0.5)
    for _ in range(14):
        now = _tick(drive, now)
    assert x.speed == 0.0


@pytest.mark.parametrize(
    "goal",
    [
        GripperCommand(0.0, 10.0),
        BaseVelocity(1.2, 0.0),
        BaseVelocity(0.0, -1.6),
        BaseVelocity(math.nan, 0.0),
        BaseVelocity(0.0, 0.0, 0.1),
        BaseVelocity(0.0, 0.0, math.nan),
    ],
)
def test_what_it_cannot_take_is_refused(goal: object) -> None:
    drive, _ = bench()
    with pytest.raises(ValueError, match=r"takes|limit"):
        drive.command(goal, 0.0)


def _tick(drive: BaseDrive, now: float) -> float:
    drive.begin_tick(now)
    for _ in range(SUB_STEPS):
        drive.apply(0.0)
    return now + TICK
