"""What maps show of a surface, drawn where it is found; and the surfaces that a run believes."""

import math

import numpy as np
import pytest

from momantu_bt.geometry import Pose2D
from momantu_bt.redrawing import Raster, surface_at
from momantu_bt.world import Overhang, Surface, Surfaces

TABLE = Surface(Pose2D(1.0, 1.0, 0.0), (0.6, 1.0), 0.7, (0.0,))
RASTER = Raster((80, 80), 0.05, (0.0, 0.0))


def legs(surface):
    """Four cells at a surface's corners."""
    cells = np.zeros(RASTER.shape, dtype=bool)
    for x in (-0.25, 0.25):
        for y in (-0.45, 0.45):
            at = surface.map_from_surface @ Pose2D(x, y, 0.0)
            cells[int(at.y / 0.05), int(at.x / 0.05)] = True
    return cells


@pytest.mark.parametrize("turn", [0.0, math.pi / 2, 0.4])
def test_what_is_drawn_of_a_surface_moves_along(turn):
    there = surface_at(TABLE, Pose2D(2.3, 2.1, turn))
    wall = np.zeros(RASTER.shape, dtype=bool)
    wall[:, 70] = True
    erased, drawn = RASTER.moved(legs(TABLE) | wall, TABLE, there)
    assert (erased == legs(TABLE)).all(), "the wall is not the table's"
    rows, columns = np.nonzero(drawn)
    near = np.argwhere(legs(there))
    away = [np.abs(near - cell).max(axis=1).min() for cell in zip(rows, columns, strict=True)]
    assert len(away) >= 4
    assert max(away) <= 1, "each within a cell of a leg"


def test_a_surface_that_stays_is_drawn_as_it_was():
    erased, drawn = RASTER.moved(legs(TABLE), TABLE, TABLE)
    assert (erased == drawn).all()
    assert (drawn == legs(TABLE)).all()


def test_beyond_the_map_nothing_is_drawn():
    erased, drawn = RASTER.moved(legs(TABLE), TABLE, surface_at(TABLE, Pose2D(9.0, 9.0, 0.0)))
    assert erased.any()
    assert not drawn.any()


def test_what_hangs_over_a_surface_moves_along():
    board = Overhang(Pose2D(1.0, 1.2, 0.1), (0.3, 0.3), 1.0, 1.1)
    shelf = Surface(TABLE.map_from_surface, TABLE.size, 0.7, (0.0,), (board,))
    moved = surface_at(shelf, Pose2D(3.0, 2.0, math.pi / 2))
    (over,) = moved.over
    assert (over.map_from_overhang.x, over.map_from_overhang.y) == pytest.approx((2.8, 2.0))
    assert over.map_from_overhang.yaw == pytest.approx(0.1 + math.pi / 2)


def test_surfaces_are_believed_as_told_until_corrected():
    told = {"a": TABLE, "b": surface_at(TABLE, Pose2D(3.0, 3.0, 0.0))}
    surfaces = Surfaces(told)
    assert surfaces == told
    assert surfaces.corrected == ()
    found = surface_at(TABLE, Pose2D(1.5, 1.0, 0.0))
    surfaces.correct("a", found)
    assert surfaces["a"] == found
    assert surfaces.told["a"] == TABLE
    assert (surfaces.corrected, surfaces.corrections) == (("a",), 1)
    assert list(surfaces) == ["a", "b"]
    again = Surfaces(surfaces)
    assert again == told, "another run knows what it is told"
    with pytest.raises(KeyError):
        surfaces.correct("c", found)
