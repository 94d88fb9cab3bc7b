"""The driver of arm and head keeps every limit, whatever it is asked."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.sapien.config import STEP, SUB_STEPS
from momantu_worlds.sapien.drives.joints import JointDrive

from momantu_bt.messages import BaseVelocity, JointPositions, JointTrajectory
from momantu_bt.robot import WATCHDOG, JointLimit
from momantu_bt.world import TICK

NAMES = ("pan", "tilt")
LIMITS = (
    JointLimit(lower=-1.5, upper=1.5, velocity=1.2, acceleration=3.0),
    JointLimit(velocity=0.5, acceleration=1.5),
)
OFFSET = np.array([0.002, -0.001])
EFFORTS = np.array([30.0, 0.5])
STIFFNESS = np.array([1e4, 1e4])


class FakeJoint:
    """Remembers the targets it was given."""

    def __init__(self) -> None:
        self.target = 0.0
        self.speed = 0.0

    def set_drive_target(self, value: float) -> None:
        self.target = value

    def set_drive_velocity_target(self, value: float) -> None:
        self.speed = value


class Bench:
    """A drive with two joints at rest at 0, and a clock."""

    def __init__(self, stiffness: np.ndarray = STIFFNESS) -> None:
        self.joints = [FakeJoint(), FakeJoint()]
        self.drive = JointDrive(NAMES, self.joints, LIMITS, OFFSET, EFFORTS, stiffness)
        self.drive.place(np.zeros(2))
        self.now = 0.0
        self.blocked: np.ndarray | None = None
        self.positions = [np.zeros(2)]
        self.speeds = [np.zeros(2)]

    def tick(self, count: int = 1, goal: object = None) -> None:
        for _ in range(count):
            if goal is not None:
                self.drive.command(goal, self.now)
            true = self.positions[-1] if self.blocked is None else self.blocked
            self.drive.begin_tick(self.now, true)
            for index in range(SUB_STEPS):
                self.drive.apply(index)
                self.positions.append(np.array([j.target for j in self.joints]))
                self.speeds.append(np.array([j.speed for j in self.joints]))
            self.now += TICK


def ramp(end: float, duration: float) -> JointTrajectory:
    """Both joints from rest at (measured) 0 to `end`, at rest."""
    times = np.array([0.0, duration])
    positions = np.array([[0.0, 0.0], [end, end]])
    return JointTrajectory(NAMES, times, positions, np.zeros((2, 2)))


goals = st.tuples(st.floats(-1.4, 1.4), st.floats(-3.0, 3.0))


@given(sequence=st.lists(st.tuples(goals, st.integers(1, 25)), min_size=1, max_size=5))
@settings(max_examples=40, deadline=None)
def test_speed_and_acceleration_limits_are_kept(
    sequence: list[tuple[tuple[float, float], int]],
) -> None:
    bench = Bench()
    for goal, ticks in sequence:
        bench.tick(ticks, JointPositions(NAMES, goal))
    speeds = np.array(bench.speeds)
    assert np.all(np.abs(speeds) <= [1.2 + 1e-9, 0.5 + 1e-9])
    jumps = np.abs(np.diff(speeds, axis=0)) / STEP
    assert np.all(jumps <= 2.0 * np.array([3.0, 1.5]) + 1e-6)
    moved = np.diff(np.array(bench.positions), axis=0)
    assert np.all(np.abs(moved) <= np.array([1.2, 0.5]) * STEP + 0.01 * STEP)


@given(goal=goals)
@settings(max_examples=25, deadline=None)
def test_positions_are_reached_in_measured_angles(goal: tuple[float, float]) -> None:
    bench = Bench()
    bench.tick(200, JointPositions(NAMES, goal))
    assert np.allclose(bench.positions[-1], np.array(goal) - OFFSET, atol=1e-12)
    assert np.all(bench.speeds[-1] == 0.0)


def test_a_goal_for_one_joint_leaves_the_other_to_its_own() -> None:
    bench = Bench()
    bench.tick(1, JointPositions(NAMES, (0.5, 0.4)))
    bench.tick(100, JointPositions(("pan",), (-0.5,)))
    assert np.allclose(bench.positions[-1], np.array([-0.5, 0.4]) - OFFSET)


def test_the_watchdog_brakes_a_quarter_second_after_the_last_command() -> None:
    bench = Bench()
    bench.tick(10, JointPositions(NAMES, (1.4, 3.0)))
    bench.tick(round(WATCHDOG / TICK))
    assert np.all(np.abs(bench.speeds[-1]) > 0.3)
    bench.tick(10)
    assert np.all(bench.speeds[-1] == 0.0)
    assert bench.positions[-1][0] < 1.3


def test_stop_brakes_a_trajectory_and_the_same_command_resumes_it() -> None:
    bench = Bench()
    trajectory = ramp(0.8, 4.0)
    bench.tick(30, trajectory)
    bench.drive.stop()
    bench.tick(15)
    here = bench.positions[-1]
    assert np.all(bench.speeds[-1] == 0.0)
    assert np.all((here > 0.1) & (here < 0.7))
    bench.tick(90, trajectory)
    assert np.allclose(bench.positions[-1], 0.8 - OFFSET)


def test_a_blocked_joint_gives_way_and_takes_a_new_goal() -> None:
    bench = Bench()
    trajectory = ramp(0.8, 4.0)
    bench.tick(30, trajectory)
    bench.blocked = bench.positions[-1] - np.array([0.02, 0.0])
    bench.tick(5, trajectory)
    assert np.all(bench.positions[-1] == bench.blocked)
    assert np.all(bench.speeds[-1] == 0.0)
    bench.blocked = None
    bench.tick(100, JointPositions(NAMES, (0.1, 0.2)))
    assert np.allclose(bench.positions[-1], np.array([0.1, 0.2]) - OFFSET)


def test_a_weak_joint_never_gives_way() -> None:
    bench = Bench()
    bench.tick(20, JointPositions(NAMES, (0.0, 0.8)))
    bench.blocked = bench.positions[-1] - np.array([0.0, 0.1])
    bench.tick(80, JointPositions(NAMES, (0.0, 0.8)))
    assert bench.positions[-1][1] == pytest.approx(0.8 - OFFSET[1])


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        (BaseVelocity(0.1, 0.0), "not BaseVelocity"),
        (JointPositions(("nose",), (0.1,)), "the joints are pan, tilt"),
        (JointPositions(("pan", "tilt"), (0.1,)), "1 numbers"),
        (JointPositions(("pan",), (1.7,)), "outside -1.500 to 1.500"),
        (JointPositions(("pan",), (float("nan"),)), "not a finite number"),
        (ramp(1.0, 1.2), "limit is 0.500"),
        (ramp(1.7, 9.0), "outside"),
        (
            JointTrajectory(NAMES[:1], np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1))),
            "expected pan, tilt",
        ),
        (
            JointTrajectory(NAMES, np.zeros(1), np.full((1, 2), 0.2), np.zeros((1, 2))),
            "plan from the present state",
        ),
        (
            JointTrajectory(NAMES, np.array([0.0, 0.0]), np.zeros((2, 2)), np.zeros((2, 2))),
            "must start at 0 and rise",
        ),
        (
            JointTrajectory(NAMES, np.zeros(1), np.zeros((1, 2)), np.zeros((2, 2))),
            "one row per time",
        ),
    ],
)
def test_what_it_cannot_take_is_refused_with_the_reason(goal: object, words: str) -> None:
    bench = Bench()
    with pytest.raises(ValueError, match=words):
        bench.drive.command(goal, 0.0)
    bench.tick(5)
    assert np.all(bench.positions[-1] == 0.0)


@pytest.mark.parametrize(("stiffness", "lag"), [(1e4, 0.01), (1e3, 0.03), (300.0, 0.1)])
def test_a_soft_drive_gives_way_only_where_it_pushes_with_all_it_has(
    stiffness: float, lag: float
) -> None:
    for share, held in ((0.8, True), (1.2, False)):
        bench = Bench(np.array([stiffness, stiffness]))
        bench.tick(40, JointPositions(("pan",), (0.3,)))
        there = bench.positions[-1].copy()
        bench.blocked = there - np.array([share * lag, 0.0])
        bench.tick()
        assert bench.positions[-1][0] == pytest.approx((there if held else bench.blocked)[0])
