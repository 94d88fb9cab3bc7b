"""The floor plan of scans: free where a beam went, occupied where it ended."""

from __future__ import annotations

import numpy as np
from momantu_skills.mapping.occupancy import floor_plan
from momantu_skills.navigation.map.sensing import Rays

from momantu_bt.geometry import Pose2D


def test_a_beam_frees_its_cells_and_occupies_its_last():
    rays = Rays(np.zeros(2), np.array([[1.0, 0.0]]), np.array([1.02]), np.array([True]))
    plan = floor_plan([(Pose2D(0.02, 0.02), rays)], 0.1, 25.0)
    row = round(-plan.origin[1] / 0.1)
    cells = plan.cells()[row]
    start = round(-plan.origin[0] / 0.1)
    assert list(cells[start : start + 11]) == [0] * 10 + [1]
    assert cells[start + 11] == 2


def test_a_beam_without_a_hit_says_nothing():
    rays = Rays(
        np.zeros(2),
        np.array([[1.0, 0.0], [0.0, 1.0]]),
        np.array([1.0, 9.0]),
        np.array([True, False]),
    )
    plan = floor_plan([(Pose2D(0.0, 0.0), rays)], 0.1, 25.0)
    assert (plan.cells() == 0).sum() <= 11
