"""The costmap marks what sensors see, forgets what they see through, and tells the room left."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import FAR, SURE, Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.sensing import Rays

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D

DISC = np.array([[0.0, 0.0, 0.2]])


def _grid() -> GridMap:
    """8 m x 6 m from (-4, -3), walled in."""
    cells = np.zeros((120, 160), np.uint8)
    cells[[0, -1], :] = OCCUPIED
    cells[:, [0, -1]] = OCCUPIED
    return GridMap(cells, 0.05, (-4.0, -3.0))


def _costmap(overhang: GridMap | None = None) -> Costmap:
    return Costmap(_grid(), overhang, NavigationConfig())


def _rays(bearing: float, distance: float, *, hit: bool = True) -> Rays:
    """A narrow bundle of beams towards a bearing."""
    angles = bearing + np.linspace(-0.02, 0.02, 9)
    ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return Rays(np.zeros(2), ways, np.full(9, distance), np.full(9, hit))


POSES = st.builds(Pose2D, st.floats(-1, 1), st.floats(-1, 1), st.floats(-math.pi, math.pi))


@given(POSES, st.floats(0.4, 1.5), st.floats(-math.pi, math.pi))
def test_a_hit_leaves_no_room_where_it_was(pose: Pose2D, far: float, bearing: float) -> None:
    costmap = _costmap()
    costmap.see_laser(pose, _rays(bearing, far))
    costmap.refresh(pose)
    there = pose @ Pose2D(far * math.cos(bearing), far * math.sin(bearing), 0.0)
    assert costmap.room(there, DISC) < -0.1
    assert costmap.room(pose, DISC) == pytest.approx(min(far, FAR) - 0.2, abs=0.08)


def test_beams_through_a_mark_clear_it_after_a_few_scans() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    costmap.see_laser(pose, _rays(0.0, 1.0))
    for _ in range(SURE):
        costmap.see_laser(pose, _rays(0.0, 2.5))
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) > 0.3


def test_beams_that_hit_nothing_clear_too() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    costmap.see_laser(pose, _rays(0.0, 1.0))
    for _ in range(SURE):
        costmap.see_laser(pose, _rays(0.0, 25.0, hit=False))
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) > 0.3


def test_hits_beside_the_maps_walls_do_not_thicken_them() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    before = costmap.field.copy()
    costmap.see_laser(pose, _rays(math.pi / 2, 2.85))
    costmap.refresh()
    assert np.array_equal(costmap.field, before)


def test_the_window_agrees_with_the_whole() -> None:
    costmap, pose = _costmap(), Pose2D(0.5, 0.3, 0.4)
    costmap.see_laser(pose, _rays(0.7, 1.1))
    costmap.refresh(pose, radius=1.5)
    window = costmap.field.copy()
    costmap.refresh()
    row, column = costmap.grid.index(pose.x, pose.y)
    near = (slice(row - 30, row + 31), slice(column - 30, column + 31))
    assert window[near] == pytest.approx(costmap.field[near], abs=1e-5)


def test_overhang_of_another_grid_is_laid_over() -> None:
    cells = np.full((4, 4), OCCUPIED, np.uint8)
    costmap = _costmap(GridMap(cells, 0.05, (1.0, 0.5)))
    assert costmap.room(Pose2D(1.1, 0.6, 0.0), DISC) < -0.1
    assert costmap.room(Pose2D(-1.0, 0.6, 0.0), DISC) > 0.5


def test_depth_needs_several_pixels_and_floor_clears() -> None:
    costmap, spot = _costmap(), np.array([[1.02, 0.02, 0.2]])
    nothing = np.zeros((0, 2))
    costmap.see_depth(spot.repeat(2, axis=0), nothing)
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) > 0.5
    costmap.see_depth(spot.repeat(5, axis=0), nothing)
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) < 0.0
    costmap.see_depth(np.zeros((0, 3)), spot[:, :2].repeat(5, axis=0))
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) > 0.5


def test_low_things_are_those_that_the_laser_looks_over_until_their_place_is_bare() -> None:
    low, tall = np.array([[1.02, 0.02, 0.07]]), np.array([[-1.02, 0.02, 0.5]])
    costmap, nothing = _costmap(), np.zeros((0, 2))
    box = np.vstack([tall, tall * (1, 1, 0.1)]).repeat(4, axis=0)
    costmap.see_depth(np.vstack([low.repeat(5, axis=0), box]), nothing, 0.2)
    assert costmap.low_things() == pytest.approx(np.array([[1.025, 0.025]]), abs=1e-6)
    costmap.see_depth(np.zeros((0, 3)), low[:, :2].repeat(5, axis=0), 0.2)
    assert len(costmap.low_things()) == 0


def test_low_things_are_laid_into_another_costmap() -> None:
    costmap = _costmap()
    costmap.lay(np.array([[1.02, 0.02], [50.0, 0.0]]))
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) < 0.0
    assert len(costmap.low_things()) == 1


@pytest.mark.parametrize(
    ("met", "still", "remains"),
    [(True, False, False), (True, True, True), (False, False, True)],
    ids=["somebody has gone", "a leg beside it is still met", "a board that no beam meets"],
)
def test_what_laser_and_pictures_showed_goes_when_the_laser_meets_nothing(
    met: bool, still: bool, remains: bool
) -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    leg, board = 0.15, np.array([[1.02, 0.02, 0.7]])
    if met:
        costmap.see_laser(pose, _rays(leg, 1.0))
    costmap.see_depth(board.repeat(5, axis=0), np.zeros((0, 2)), 0.3)
    for _ in range(SURE):
        costmap.see_laser(pose, _rays(0.02, 2.5))
        costmap.see_laser(pose, _rays(leg, 1.0 if still else 2.5, hit=met))
    costmap.refresh()
    assert (costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) < 0.0) is remains


def test_a_map_that_grows_does_not_lose_what_stands_where_the_laser_does_not_look_now() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    costmap.see_laser(pose, _rays(0.15, 1.0))
    costmap.see_depth(np.array([[1.02, 0.02, 0.7]]).repeat(5, axis=0), np.zeros((0, 2)), 0.3)
    for _ in range(SURE):
        costmap.see_laser(pose, _rays(0.02, 2.5))
        costmap.see_laser(pose, _rays(0.15, 1.0))
    costmap.use(_grid(), Pose2D(0.001, 0.0, 0.0))
    costmap.see_laser(pose, _rays(0.02, 2.5))
    costmap.refresh()
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) < 0.0


def test_low_things_beside_somebody_stay_when_that_one_goes() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    costmap.see_laser(pose, _rays(0.02, 1.1))
    costmap.see_depth(np.array([[1.02, 0.02, 0.1]]).repeat(5, axis=0), np.zeros((0, 2)), 0.3)
    for _ in range(2 * SURE):
        costmap.see_laser(pose, _rays(0.02, 2.5))
    assert len(costmap.low_things()) == 1


def test_points_off_the_map_are_left_out() -> None:
    costmap = _costmap()
    before = costmap.field.copy()
    costmap.see_depth(np.full((9, 3), 50.0), np.full((9, 2), -50.0))
    costmap.see_laser(Pose2D(3.9, 2.9, 0.0), _rays(0.5, 5.0))
    costmap.refresh(Pose2D(60.0, 0.0, 0.0))
    assert np.array_equal(costmap.field, before)
    assert costmap.room(Pose2D(60.0, 0.0, 0.0), DISC) < 0.0


def test_what_pictures_showed_is_kept_where_they_show_nothing_now() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    for x in (0.6, 2.0):
        costmap.see_depth(np.array([[x, 0.02, 0.7]]).repeat(5, axis=0), np.zeros((0, 2)))
    costmap.clear_ahead(pose, 1.0)
    assert costmap.room(Pose2D(0.6, 0.0, 0.0), DISC) < 0.0
    assert costmap.room(Pose2D(2.0, 0.0, 0.0), DISC) > 0.3


def test_what_lies_behind_is_remembered() -> None:
    costmap, pose = _costmap(), Pose2D(0.0, 0.0, 0.0)
    costmap.see_laser(pose, _rays(0.0, 1.0))
    costmap.see_laser(pose, _rays(math.pi, 1.0))
    costmap.clear_ahead(pose)
    assert costmap.room(Pose2D(1.0, 0.0, 0.0), DISC) > 0.3
    assert costmap.room(Pose2D(-1.0, 0.0, 0.0), DISC) < 0.0
