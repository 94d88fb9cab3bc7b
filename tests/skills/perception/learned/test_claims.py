"""Cells that voted for different middles, put together by their coordinates."""

from __future__ import annotations

import math

import numpy as np
from momantu_skills.perception.learned.claims import Cells, claimed

from momantu_bt.categories import USUAL
from momantu_bt.geometry import Array, Transform, quaternion_from_axis_angle
from momantu_bt.world import seeded

SIZE = np.array([0.07, 0.07, 0.26])
LEVEL = quaternion_from_axis_angle((0.0, 1.0, 0.0), math.pi / 2)


def bottle(y: float, count: int = 400) -> tuple[Array, Array]:
    """Points of a bottle that lies along x, m, and their normalized coordinates."""
    draw = seeded("bottle", round(1000 * y))
    bearing = draw.uniform(-math.pi, math.pi, count)
    height = draw.uniform(-0.5, 0.5, count)
    own = np.column_stack([np.cos(bearing) / 2, np.sin(bearing) / 2, height]) * SIZE
    pose = Transform((0.0, y, 0.035), LEVEL)
    return pose.apply(own), own / float(np.linalg.norm(SIZE))


def cells(*of: tuple[Array, Array]) -> Cells:
    points = np.concatenate([each[0] for each in of])
    coordinates = np.concatenate([each[1] for each in of])
    chances = np.zeros((len(points), len(USUAL)))
    chances[:, list(USUAL).index("bottle")] = 0.9
    return Cells(points, coordinates[None], chances, np.zeros(len(points), dtype=bool))


def test_a_neck_that_came_out_by_itself_belongs_to_its_bottle() -> None:
    made = cells(bottle(1.0))
    owner = np.where(made.points[:, 0] > 0.05, 1, 0)
    owner[made.points[:, 0] < -0.11] = -1  # and a few that voted for nothing
    things = claimed(made, owner, USUAL)
    assert list(things) == [0]
    assert (owner == 0).all()
    assert np.allclose(things[0].size, SIZE, atol=0.015)


def test_two_bottles_side_by_side_stay_two() -> None:
    made = cells(bottle(1.0), bottle(1.08))
    owner = np.repeat([0, 1], 400)
    things = claimed(made, owner, USUAL)
    assert sorted(things) == [0, 1]
    assert owner.tolist() == [0] * 400 + [1] * 400


def test_a_few_wrong_cells_change_hands_and_both_things_stay() -> None:
    made = cells(bottle(1.0, 600), bottle(1.08, 400))
    owner = np.repeat([0, 1], [600, 400])
    owner[:60] = 1
    things = claimed(made, owner, USUAL)
    assert sorted(things) == [0, 1]
    assert (owner[:600] == 0).all()
    assert (owner[600:] == 1).all()


def test_nothing_is_claimed_where_nothing_is() -> None:
    assert claimed(cells(bottle(1.0)), np.full(400, -1), USUAL) == {}
