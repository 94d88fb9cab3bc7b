"""Arm and load as the moving base sees them: discs and columns with heights."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.manipulation.scene import outreach
from momantu_skills.manipulation.scene.surroundings import Support

from momantu_bt.geometry import Transform

BASE = np.array([(-0.3, -0.25), (0.3, -0.25), (0.3, 0.25), (-0.3, 0.25)])
COLUMNS = st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(0, 1), st.floats(0.001, 2))


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> np.ndarray:
    return np.array([(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1])
                     for z in (low[2], high[2])])  # fmt: skip


def test_what_stays_over_the_base_does_not_reach_beyond_it() -> None:
    assert not len(outreach.overhang([box((-0.2, -0.2, 0.5), (0.2, 0.2, 1.0))], BASE))


@given(st.floats(0.01, 0.6), st.floats(-0.2, 0.2), st.floats(0.005, 0.2))
def test_what_reaches_beyond_is_covered_with_its_heights(
    length: float, y: float, width: float
) -> None:
    arm = box((0.1, y, 0.6), (0.3 + length, y + width, 0.8))
    rows = outreach.overhang([arm], BASE)
    assert rows[:, 3] == pytest.approx(0.6)
    assert rows[:, 4] == pytest.approx(0.8)
    ends = np.array([(0.3 + length, y), (0.3 + length, y + width)])
    gaps = np.linalg.norm(ends[:, None] - rows[None, :, :2], axis=2) - rows[None, :, 2]
    assert gaps.min(axis=1).max() < 1e-9
    assert (rows[:, 0] + rows[:, 2]).max() < 0.3 + length + 0.01


@given(st.lists(COLUMNS, min_size=1, max_size=9))
def test_columns_are_cut_without_a_gap(rows: list[tuple[float, float, float, float]]) -> None:
    columns = np.array([(x, y, low, low + high, 0.02) for x, y, low, high in rows])
    pieces = outreach.cut(columns)
    heights = pieces[:, 3] - pieces[:, 2]
    assert (heights <= outreach.GRID + 1e-9).all()
    assert heights.sum() == pytest.approx((columns[:, 3] - columns[:, 2]).sum())
    for x, y, low, high, _ in columns:
        own = pieces[(pieces[:, 0] == x) & (pieces[:, 1] == y)]
        assert own[:, 2].min() <= low + 1e-9
        assert own[:, 3].max() >= high - 1e-9


def test_what_the_map_knows_the_laser_need_not_show() -> None:
    wall = np.array([(1.0, y) for y in np.arange(-1.0, 1.0, 0.05)])
    hits = np.array([(0.97, 0.2), (0.5, 0.2), (1.3, 0.0)])
    assert outreach.unexplained(hits, wall) == pytest.approx(hits[1:])
    assert outreach.unexplained(hits, wall[:0]) is hits


def test_hits_of_the_laser_on_a_surface_are_no_walls() -> None:
    desk = Support(np.array([(1.0, -0.5), (1.8, -0.5), (1.8, 0.5), (1.0, 0.5)]), 0.75)
    base_from_odom = Transform((0.5, 0.0, 0.0))
    hits = np.array([(1.6, 0.2), (1.47, 0.2), (1.3, 0.2)])
    assert outreach.beside(hits, [desk], base_from_odom) == pytest.approx(hits[2:])


@given(st.lists(COLUMNS, min_size=1, max_size=5))
def test_a_thin_thing_in_the_cell_of_a_piece_lies_between_its_samples(
    rows: list[tuple[float, float, float, float]],
) -> None:
    """The middles of pieces are looked at first, then the corners of the cell around each."""
    pieces = outreach.cut(np.array([(x, y, low, low + high, 0.005) for x, y, low, high in rows]))
    middles, *corners = outreach.samples(pieces)
    assert middles[:, :2] == pytest.approx(pieces[:, :2])
    assert len(corners) == 4
    spread = np.array(corners)
    assert np.ptp(spread, axis=0)[:, :2] == pytest.approx(outreach.GRID)
    assert spread.mean(axis=0) == pytest.approx(middles)
    assert ((middles[:, 2] > pieces[:, 2]) & (middles[:, 2] < pieces[:, 3])).all()
