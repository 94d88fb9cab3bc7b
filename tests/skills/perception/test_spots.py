"""Spots: every one keeps its distances, and none is invented."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.perception.geometry.grids import Grid
from momantu_skills.perception.surface.spots import Ground, SpotConfig, free_spots

CONFIG = SpotConfig()
OUTLINE = np.array([[0.0, 0.0], [0.6, 0.0], [0.6, 1.0], [0.0, 1.0]])
NEAR, ROBOT, RADIUS = np.array([0.3, 0.5]), np.array([-0.5, 0.5]), 0.035


def ground(obstacles: np.ndarray, unseen: np.ndarray | None = None) -> Ground:
    """A seen table with things 3 cm in radius at `obstacles` (k, 2), some of it unseen."""
    grid = Grid.over(OUTLINE, CONFIG.cell, margin=0.05)
    centres = grid.centres()
    covered = np.zeros(grid.shape, dtype=bool)
    for thing in obstacles:
        covered |= np.linalg.norm(centres - thing, axis=2) < 0.03
    seen = ((centres > 0.0) & (centres < (0.6, 1.0))).all(axis=2) & ~covered
    if unseen is not None:
        seen &= np.linalg.norm(centres - unseen, axis=2) > 0.1
    return Ground(grid, covered, seen)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 6))
def test_every_spot_keeps_every_distance(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    things = random.uniform((0.05, 0.05), (0.55, 0.95), (count, 2))
    unseen = random.uniform((0.0, 0.0), (0.6, 1.0))
    spots = np.array(free_spots(ground(things, unseen), OUTLINE, NEAR, ROBOT, RADIUS, CONFIG))
    assert len(spots) <= CONFIG.most
    for n, spot in enumerate(spots):
        assert np.linalg.norm(spot - NEAR) <= CONFIG.reach
        inside = min(*spot, *(np.array([0.6, 1.0]) - spot))
        assert inside >= RADIUS + CONFIG.edge - 1e-9
        for thing in things:
            assert np.linalg.norm(spot - thing) > 0.03 + RADIUS + CONFIG.fingers - 0.01
        assert np.linalg.norm(spot - unseen) > 0.1 + RADIUS
        assert all(np.linalg.norm(spot - other) >= CONFIG.apart for other in spots[:n])


def test_an_empty_table_has_several_spots_beside_the_tag_towards_the_robot() -> None:
    spots = np.array(free_spots(ground(np.empty((0, 2))), OUTLINE, NEAR, ROBOT, RADIUS, CONFIG))
    assert len(spots) >= 4
    assert np.linalg.norm(spots[0] - NEAR) >= CONFIG.on_top + RADIUS
    assert spots[0, 0] < NEAR[0]


@pytest.mark.parametrize("radius", [0.28, 0.5])
def test_what_is_too_large_has_no_spot(radius: float) -> None:
    assert free_spots(ground(np.empty((0, 2))), OUTLINE, NEAR, ROBOT, radius, CONFIG) == []


def test_a_full_table_has_no_spot() -> None:
    x, y = np.meshgrid(np.arange(0.05, 0.6, 0.1), np.arange(0.05, 1.0, 0.1))
    crowd = np.column_stack([x.ravel(), y.ravel()])
    assert free_spots(ground(crowd), OUTLINE, NEAR, ROBOT, RADIUS, CONFIG) == []
