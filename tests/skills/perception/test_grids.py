"""Grids: counts, patches and clearances against their definitions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.geometry.grids import (
    Grid,
    clearance,
    closed,
    components,
    largest_component,
)

seeds = st.integers(0, 10_000)


@given(seeds, st.floats(0.01, 0.2))
def test_every_point_is_counted_in_the_cell_it_lies_in(seed: int, cell: float) -> None:
    points = np.random.default_rng(seed).uniform(-2, 2, (50, 2))
    grid = Grid.over(points, cell, margin=0.05)
    assert grid.counts(points).sum() == 50
    middles = grid.centres().reshape(-1, 2)[grid.cells(points)]
    assert np.abs(middles - points).max() <= cell / 2 + 1e-9


@settings(deadline=None)
@given(seeds)
def test_clearance_is_the_distance_to_the_nearest_blocked_cell(seed: int) -> None:
    blocked = np.random.default_rng(seed).random((12, 15)) < 0.1
    if not blocked.any():
        return
    cells = np.argwhere(blocked)
    every = np.stack(np.meshgrid(np.arange(12), np.arange(15), indexing="ij"), axis=-1)
    apart = np.linalg.norm(every[:, :, None, :] - cells[None, None], axis=-1).min(axis=2)
    assert clearance(blocked, 0.05) == pytest.approx(0.05 * apart, abs=1e-5)


def test_nothing_blocked_is_endless_clearance() -> None:
    assert np.isinf(clearance(np.zeros((3, 4), dtype=bool), 0.1)).all()


def test_patches_touch_at_corners_and_the_largest_is_kept() -> None:
    mask = np.array([[1, 0, 0, 0, 1], [0, 1, 0, 0, 0], [0, 0, 1, 0, 1]], dtype=bool)
    count, labels = components(mask)
    assert count == 3
    assert (labels > 0).tolist() == mask.tolist()
    assert largest_component(mask).sum() == 3
    assert not largest_component(np.zeros((2, 2), dtype=bool)).any()


@given(seeds)
def test_closing_only_adds(seed: int) -> None:
    mask = np.random.default_rng(seed).random((20, 20)) < 0.3
    filled = closed(mask, 1)
    assert (filled >= mask).all()
    assert (closed(filled, 1) == filled).all()
