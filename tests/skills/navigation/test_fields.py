"""Distance fields agree with brute force, and lookups with arithmetic."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from momantu_skills.navigation.map.fields import clearance, sample, surface_distance

GRIDS = arrays(np.bool_, (9, 12), elements=st.sampled_from([False, False, False, True]))


def _brute(blocked: np.ndarray) -> np.ndarray:
    cells = np.argwhere(np.ones_like(blocked))
    walls = np.argwhere(blocked)
    apart = np.hypot(*(cells[:, None] - walls[None]).transpose(2, 0, 1)).min(axis=1)
    return np.maximum(apart - 0.5, 0.0).reshape(blocked.shape)


@given(GRIDS)
def test_clearance_is_the_distance_to_the_nearest_blocked_cell(blocked: np.ndarray) -> None:
    assume(blocked.any())
    assert clearance(blocked, 0.05) == pytest.approx(0.05 * _brute(blocked), abs=1e-5)


def test_clearance_of_an_empty_grid_is_beyond_its_diagonal() -> None:
    assert (clearance(np.zeros((3, 4), bool), 0.1) >= 0.5 - 1e-6).all()


@given(GRIDS)
def test_surface_distance_is_small_on_both_sides_of_a_face(occupied: np.ndarray) -> None:
    assume(occupied.any() and not occupied.all())
    field = surface_distance(occupied, 0.1, 0.5)
    assert (field <= 0.5).all()
    flips = occupied[:, 1:] != occupied[:, :-1]
    assert field[:, 1:][flips] == pytest.approx(0.05, abs=1e-6)
    assert field[:, :-1][flips] == pytest.approx(0.05, abs=1e-6)


@settings(max_examples=50)
@given(st.floats(0.0, 4.9), st.floats(0.0, 2.9))
def test_lookup_is_exact_for_planes(column: float, row: float) -> None:
    rows, columns = np.mgrid[0:5, 0:7]
    plane = (2.0 * columns - 3.0 * rows + 1.0).astype(np.float32)
    assert sample(plane, column, row, -9.0) == pytest.approx(2 * column - 3 * row + 1, abs=1e-4)


@pytest.mark.parametrize(("column", "row"), [(-0.1, 1.0), (1.0, -0.1), (6.0, 1.0), (1.0, 4.0)])
def test_lookup_outside_gives_the_outside_value(column: float, row: float) -> None:
    assert sample(np.zeros((5, 7), np.float32), column, row, -9.0) == -9.0
