"""Occupied cells as rectangles: exactly the cells, each once, and no more than needed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from momantu_worlds.floor_plan.rectangles import rectangles, without_specks
from numpy.typing import NDArray


@given(npst.arrays(np.bool_, st.tuples(st.integers(1, 12), st.integers(1, 12))))
def test_every_occupied_cell_is_covered_once_and_no_free_one(occupied: NDArray[np.bool_]) -> None:
    times = np.zeros(occupied.shape, dtype=int)
    for each in rectangles(occupied):
        times[each.row : each.row_end, each.column : each.column_end] += 1
    np.testing.assert_array_equal(times, occupied.astype(int))


def test_straight_walls_stay_whole() -> None:
    plan = np.zeros((20, 30), dtype=bool)
    plan[[0, -1], :] = plan[:, [0, -1]] = True
    assert len(rectangles(plan)) == 4


@pytest.mark.parametrize(("least", "cells", "gone"), [(1, 5, 0), (2, 4, 1), (4, 4, 1), (5, 0, 2)])
def test_specks_go_by_their_size(least: int, cells: int, gone: int) -> None:
    plan = np.zeros((9, 9), dtype=bool)
    plan[0, 0] = plan[7, 3:7] = True  # one cell alone, and four in a row
    kept, dropped = without_specks(plan, least)
    assert (int(kept.sum()), dropped) == (cells, gone)
