"""The grid of a map: cells, and where they lie."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from momantu_skills.navigation.map.maps import GridMap, read_grid

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN, MapPicture, write_map


@given(arrays(np.bool_, (7, 5)), st.floats(-3, 3), st.floats(-3, 3))
def test_centers_and_index_are_inverse(mask: np.ndarray, x: float, y: float) -> None:
    grid = GridMap(np.zeros((7, 5), np.uint8), 0.1, (x, y))
    cells = [grid.index(*point) for point in grid.centers(mask)]
    assert cells == [tuple(cell) for cell in np.argwhere(mask)]


def test_contains_the_edges_only_once() -> None:
    grid = GridMap(np.zeros((2, 4), np.uint8), 0.5, (0.0, 0.0))
    assert grid.contains(0.0, 0.0)
    assert grid.contains(1.99, 0.99)
    assert not grid.contains(2.0, 0.5)
    assert not grid.contains(1.0, -0.01)


def test_a_map_is_a_grid_that_nobody_changes(tmp_path: Path) -> None:
    levels = np.array([[0, 254, 205], [254, 254, 0]], np.uint8)
    write_map(tmp_path / "plan.yaml", MapPicture(levels, 0.05, (-1.0, 2.0)))
    grid = read_grid(tmp_path / "plan.yaml")
    assert grid.cells.tolist() == [[FREE, FREE, OCCUPIED], [OCCUPIED, FREE, UNKNOWN]]
    assert not grid.cells.flags.writeable
    assert grid.origin == (-1.0, 2.0)
    assert grid.size == pytest.approx((0.15, 0.1))
