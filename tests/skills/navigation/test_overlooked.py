"""What pictures show and the laser does not stays where it is while the base moves."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.control.guard import safe_share
from momantu_skills.navigation.drive.overlooked import CELL, EXPLAINED, KEPT, Overlooked

from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits

POSES = st.builds(Pose2D, st.floats(-9, 9), st.floats(-9, 9), st.floats(-3.1, 3.1))
AHEAD = st.tuples(st.floats(0.4, 1.4), st.floats(-1.0, 1.0))
NOTHING = np.zeros((0, 2))


def _board(x: float, y: float, z: float = 0.12) -> Array:
    """Ten points of a small thing."""
    return np.tile((x, y, z), (10, 1))


def _shown(at: Pose2D, board: Array, floor: Array = NOTHING, hits: Array = NOTHING) -> Overlooked:
    overlooked = Overlooked()
    overlooked.see(at, board, floor, hits)
    return overlooked


@given(POSES, POSES, AHEAD)
def test_a_thing_stays_where_odometry_says(
    at: Pose2D, then: Pose2D, ahead: tuple[float, float]
) -> None:
    found = _shown(at, _board(*ahead)).near(then, 40.0)
    there = at @ Pose2D(*ahead)
    assert found.shape == (1, 2)
    back = then @ Pose2D(*found[0])
    assert np.hypot(back.x - there.x, back.y - there.y) < 1e-9


@given(POSES, AHEAD)
def test_floor_where_it_was_forgets_it(at: Pose2D, ahead: tuple[float, float]) -> None:
    overlooked = _shown(at, _board(*ahead))
    off = np.stack(np.meshgrid(*[np.arange(-0.1, 0.11, 0.01)] * 2), axis=-1).reshape(-1, 2)
    overlooked.see(at, np.zeros((0, 3)), ahead + off, NOTHING)
    assert len(overlooked.near(at, 9.0)) == 0


@given(POSES, AHEAD)
def test_it_is_kept_while_pictures_look_elsewhere(at: Pose2D, ahead: tuple[float, float]) -> None:
    overlooked = _shown(at, _board(*ahead))
    overlooked.see(at, _board(2.5, 0.0), np.tile((2.0, 1.2), (5, 1)), NOTHING)
    assert len(overlooked.near(at, 9.0)) == 2


def test_what_the_laser_sees_too_is_left_to_it() -> None:
    wall = _board(1.0, 0.0)
    beside = np.array([[1.0 + 0.5 * EXPLAINED, 0.0]])
    assert len(_shown(Pose2D(0, 0), wall, hits=beside).near(Pose2D(0, 0), 9.0)) == 0
    away = np.array([[1.0 + 2.0 * EXPLAINED, 0.0]])
    assert len(_shown(Pose2D(0, 0), wall, hits=away).near(Pose2D(0, 0), 9.0)) == 1


def test_single_points_and_far_things_are_left_out() -> None:
    overlooked = _shown(Pose2D(0, 0), _board(1.0, 0.0)[:2])
    assert len(overlooked.near(Pose2D(0, 0), 9.0)) == 0
    overlooked = _shown(Pose2D(0, 0), _board(1.0, 0.0))
    overlooked.see(Pose2D(-KEPT, 0.0), _board(0.5, 0.0), NOTHING, NOTHING)
    assert len(overlooked.near(Pose2D(0, 0), 9.0)) == 1


def test_the_same_thing_seen_twice_is_one() -> None:
    overlooked = _shown(Pose2D(0, 0), _board(1.01, 0.01))
    overlooked.see(Pose2D(0.01, 0.0), _board(1.01 - 0.4 * CELL, 0.01), NOTHING, NOTHING)
    assert len(overlooked.near(Pose2D(0, 0), 9.0)) == 1


def test_the_guard_stops_before_a_board_that_the_laser_looks_over() -> None:
    limits = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)
    disc = np.array([[0.0, 0.0, 0.28]])
    board = _shown(Pose2D(3.0, 1.0, 2.0), _board(0.4, 0.0)).near(Pose2D(3.0, 1.0, 2.0), 1.6)
    assert safe_share((0.5, 0.0, 0.0), (0.5, 0.0, 0.0), limits, disc, board) == 0.0
    assert safe_share((-0.5, 0.0, 0.0), (0.0, 0.0, 0.0), limits, disc, board) == 1.0
