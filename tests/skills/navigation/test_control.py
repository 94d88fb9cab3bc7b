"""The local controller, the approach and the guard: driven in closed loop on a perfect unicycle."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.config import ControllerConfig, NavigationConfig
from momantu_skills.navigation.control import graceful
from momantu_skills.navigation.control.guard import safe_share
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.manoeuvre import TURN_AT_END
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.planner import plan

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.robot import BaseLimits

LIMITS = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)
CONFIG = NavigationConfig()
DISC = np.array([[0.0, 0.0, 0.3]])
REST = (0.0, 0.0, 0.0)


def _costmap(*boxes: tuple[int, int, int, int]) -> Costmap:
    """8 m x 6 m with boxes (row, column, height, width) in cells of 0.05 m."""
    cells = np.zeros((120, 160), np.uint8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    for row, column, height, width in boxes:
        cells[row : row + height, column : column + width] = OCCUPIED
    return Costmap(GridMap(cells, 0.05, (0.0, 0.0)), None, CONFIG)


class _Unicycle:
    """Obeys at once, within its accelerations."""

    def __init__(self, pose: Pose2D) -> None:
        self.pose, self.v, self.w = pose, 0.0, 0.0

    def drive(self, command: tuple[float, ...], seconds: float = 0.1) -> None:
        for _ in range(10):
            dt = seconds / 10
            self.v += float(np.clip(command[0] - self.v, -1.0 * dt, 1.0 * dt))
            self.w += float(np.clip(command[1] - self.w, -3.0 * dt, 3.0 * dt))
            self.pose = self.pose @ Pose2D(self.v * dt, 0.0, self.w * dt)


def _seen(base: _Unicycle, point: Sequence[float]) -> tuple[float, float]:
    seen = base.pose.inverse() @ Pose2D(float(point[0]), float(point[1]), 0.0)
    return seen.x, seen.y


def _drive(
    costmap: Costmap, start: Pose2D, goal: Pose2D, seconds: float
) -> tuple[_Unicycle, float]:
    """Least room on the way, with the controller alone."""
    way = plan(costmap, start, goal, 0.32, CONFIG.comfort, CONFIG.planner)
    assert way is not None
    base, mppi, least = _Unicycle(start), Mppi(LIMITS, CONFIG, np.random.default_rng(0)), 9.0
    for _ in range(int(seconds / 0.1)):
        base.drive(mppi.command(base.pose, (base.v, base.w, 0.0), costmap, DISC, way))
        least = min(least, costmap.room(base.pose, DISC))
        if base.pose.distance_to(goal) < 0.4:
            break
    return base, least


@pytest.mark.parametrize(
    ("boxes", "goal"),
    [
        ((), Pose2D(6.5, 3.0)),
        (((40, 60, 40, 10),), Pose2D(6.5, 3.0)),
        (((0, 70, 50, 4), (72, 70, 48, 4)), Pose2D(6.5, 1.0)),
    ],
    ids=["open", "round a box", "through a door of 1.1 m"],
)
def test_the_controller_gets_there_without_touching(
    boxes: tuple[tuple[int, int, int, int], ...], goal: Pose2D
) -> None:
    start = Pose2D(1.0, 3.0, 0.0)
    base, least = _drive(_costmap(*boxes), start, goal, 15.0)
    assert base.pose.distance_to(goal) < 0.4
    assert least > 0.0


def test_the_controller_is_quick_in_the_open_and_slow_where_it_is_tight() -> None:
    speeds = []
    for boxes in ((), ((0, 40, 52, 80), (68, 40, 52, 80))):
        base, _ = _drive(_costmap(*boxes), Pose2D(1.0, 3.0, 0.0), Pose2D(7.0, 3.0), 3.5)
        speeds.append(base.v)
    assert speeds[0] > 0.8
    assert speeds[1] < 0.6


def test_the_controller_repeats_itself() -> None:
    ends = [_drive(_costmap(), Pose2D(1, 3, 0.5), Pose2D(6, 2), 2.0)[0].pose for _ in range(2)]
    assert ends[0] == ends[1]


STARTS = st.builds(Pose2D, st.floats(-1.8, -0.9), st.floats(-0.3, 0.3), st.floats(-0.4, 0.4))


FROM_AFAR = st.builds(Pose2D, st.floats(-1.8, -1.1), st.floats(-0.3, 0.3), st.floats(-0.4, 0.4))
"""Nearer, 0.3 m to the side, no smooth curve ends straight: what is simulated says so (below)."""


@settings(max_examples=60)
@given(FROM_AFAR, st.floats(-math.pi, math.pi))
def test_the_approach_ends_on_the_goal(offset: Pose2D, yaw: float) -> None:
    goal = Pose2D(4.0, 3.0, yaw)
    base = _Unicycle(goal @ offset)
    for _ in range(120):
        command = graceful.command(base.pose, goal, LIMITS)
        base.drive(command or (0.0, 0.0))
        if command is None and abs(base.v) + abs(base.w) < 1e-6:
            break
    end = goal.inverse() @ base.pose
    assert math.hypot(end.x, end.y) < 0.02
    assert abs(end.yaw) < TURN_AT_END  # the rest is a turn on the spot


@settings(max_examples=60)
@given(STARTS)
def test_the_simulated_approach_foretells_the_real_one(offset: Pose2D) -> None:
    goal = Pose2D(4.0, 3.0, 0.7)
    costmap = _costmap()
    foretold = graceful.simulate(goal @ offset, REST, goal, LIMITS, costmap, DISC)
    base = _Unicycle(goal @ offset)
    for _ in range(120):
        base.drive(graceful.command(base.pose, goal, LIMITS) or (0.0, 0.0))
    end = goal.inverse() @ base.pose
    assert (foretold.ahead, foretold.left) == pytest.approx((end.x, end.y), abs=0.03)
    assert abs(wrap_angle(foretold.yaw - end.yaw)) < 0.25
    assert foretold.within(0.04, 0.35, 0.0)


def test_an_approach_past_a_wall_has_no_room() -> None:
    goal = Pose2D(4.0, 3.0, 0.0)
    costmap = _costmap((55, 60, 8, 4))
    end = graceful.simulate(Pose2D(2.4, 3.0, 0.0), REST, goal, LIMITS, costmap, DISC)
    assert end.room < 0.0
    assert not end.within(0.05, 0.2, 0.0)


def test_behind_the_goals_line_there_is_nothing_to_approach() -> None:
    assert graceful.command(Pose2D(1.1, 0.0, 0.0), Pose2D(1.0, 0.0, 0.0), LIMITS) is None


HITS = st.tuples(st.floats(0.33, 1.5), st.floats(-math.pi, math.pi))


@given(HITS, st.floats(-0.3, 1.0), st.floats(-1.5, 1.5))
def test_what_the_guard_lets_through_can_still_stop(
    hit: tuple[float, float], v: float, w: float
) -> None:
    point = np.array([[hit[0] * math.cos(hit[1]), hit[0] * math.sin(hit[1])]])
    share = safe_share((v, w, 0.0), REST, LIMITS, DISC, point)
    base = _Unicycle(Pose2D(0.0, 0.0, 0.0))
    base.drive((v * share, w * share))
    for _ in range(15):
        base.drive((0.0, 0.0))
    assert math.hypot(*_seen(base, point[0])) > 0.3 - 0.005 or share == 0.0


@pytest.mark.parametrize(
    ("hit", "speed", "expected"), [(0.9, 0.0, 1.0), (0.33, 0.0, 0.0), (0.55, 1.0, 0.0)]
)
def test_the_guard_minds_braking_distance(hit: float, speed: float, expected: float) -> None:
    share = safe_share((0.6, 0.0, 0.0), (speed, 0.0, 0.0), LIMITS, DISC, np.array([[hit, 0.0]]))
    assert share == expected


@given(st.floats(-1.5, 1.5))
def test_a_round_base_may_always_turn(w: float) -> None:
    assume(abs(w) > 0.01)
    hits = np.array([[0.31, 0.0], [0.0, 0.31], [-0.2, -0.24]])
    assert safe_share((0.0, w, 0.0), REST, LIMITS, DISC, hits) == 1.0


@pytest.mark.parametrize(
    ("low", "high", "expected"), [(0.0, 0.72, 1.0), (0.0, 0.85, 0.0), (1.2, 2.0, 1.0)]
)
def test_only_what_stands_at_a_parts_height_is_in_its_way(
    low: float, high: float, expected: float
) -> None:
    hand = np.array([[0.6, 0.0, 0.1, 0.8, 1.0]])
    column = np.array([[0.75, 0.0, low, high, 0.025]])
    assert safe_share((0.3, 0.0, 0.0), REST, LIMITS, hand, column) == expected


def test_backing_away_from_a_touch_is_allowed() -> None:
    touching = np.array([[0.29, 0.0]])
    assert safe_share((-0.2, 0.0, 0.0), REST, LIMITS, DISC, touching) == 1.0
    assert safe_share((0.2, 0.0, 0.0), REST, LIMITS, DISC, touching) == 0.0


CLOSE = st.tuples(st.floats(0.28, 0.318), st.floats(-math.pi, math.pi))


@given(CLOSE, st.floats(-0.3, 0.3), st.floats(-1.0, 1.0))
def test_what_is_inside_the_margin_never_comes_nearer(
    hit: tuple[float, float], v: float, w: float
) -> None:
    base = _Unicycle(Pose2D(0.0, 0.0, 0.0))
    point = np.array([[hit[0] * math.cos(hit[1]), hit[0] * math.sin(hit[1])]])
    for _ in range(20):
        seen = np.array([_seen(base, point[0])])
        share = safe_share((v, w, 0.0), (base.v, base.w, 0.0), LIMITS, DISC, seen)
        base.drive((v * share, w * share))
    assert math.hypot(*_seen(base, point[0])) > hit[0] - 1e-3


@pytest.mark.parametrize("creep", [0.001, 0.004, 0.01])
def test_not_even_creeping_is_allowed_inside_the_margin(creep: float) -> None:
    assert safe_share((creep, 0.0, 0.0), REST, LIMITS, DISC, np.array([[0.315, 0.0]])) == 0.0


def test_a_base_that_rolls_towards_a_hit_may_turn_round() -> None:
    rolling = (0.1, 0.0, 0.0)
    assert safe_share((-0.2, 0.0, 0.0), rolling, LIMITS, DISC, np.array([[0.315, 0.0]])) == 1.0


def test_the_approach_keeps_a_slow_base_slow() -> None:
    slow = LIMITS.model_copy(update={"linear": 0.3})
    goal = Pose2D(4.0, 0.0, 0.0)
    for start in (Pose2D(0.0, 0.0, 0.0), Pose2D(2.0, 0.5, 0.3)):
        quick, wanted = (graceful.command(start, goal, limits) for limits in (LIMITS, slow))
        assert quick is not None
        assert wanted is not None
        assert quick[0] > 0.3 >= wanted[0] > 0.0


@pytest.mark.parametrize("period", [0.05, 0.1, 0.3])
def test_the_plan_of_controls_moves_on_by_the_period(period: float) -> None:
    """What was meant for the next call is what the next call begins with."""
    config = NavigationConfig(
        period=period,
        controller=ControllerConfig(step=0.05, speed_noise=1e-9, turn_noise=1e-9),
    )
    costmap, start = _costmap(), Pose2D(1.0, 3.0)
    way = plan(costmap, start, Pose2D(7.0, 3.0), 0.32, config.comfort, config.planner)
    assert way is not None
    mppi = Mppi(LIMITS, config, np.random.default_rng(0))
    steps = config.controller.steps
    ramp = np.linspace(0.1, 0.9, steps)
    mppi._controls = np.column_stack([ramp, np.zeros(steps)])
    # Of all rollouts only the plan itself, at full speed and at rest differ: weigh them out.
    moved = np.concatenate([ramp[round(period / 0.05) :], ramp[-1:].repeat(round(period / 0.05))])
    mppi.command(start, (0.1, 0.0, 0.0), costmap, DISC, way)
    assert mppi._controls[0, 0] == pytest.approx(moved[0], abs=0.05)
