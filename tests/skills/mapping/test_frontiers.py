"""Frontiers: what is near comes first, nooks far away are not worth it, and vain looks end."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.mapping import frontiers
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.planner import UNREACHED

from momantu_bt.formats.maps import FREE, OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import frozen

CELL = 0.05


def hall(length: float, nooks: tuple[float, ...], depth: float = 1.0) -> Costmap:
    """A known hall 3 m wide; behind a gap of 1 m at each of `nooks`, x in m, the floor is unknown.

    A wall closes each nook `depth` m behind its gap.
    """
    columns, wide, deep = (round(m / CELL) for m in (length, 3.0, depth))
    cells = np.full((wide + deep + 2, columns), OCCUPIED, np.uint8)
    cells[1 : wide + 1, 1:-1] = FREE
    for x in nooks:
        middle = round(x / CELL)
        cells[wide + 1 : wide + deep + 1, middle - 10 : middle + 10] = UNKNOWN
    return Costmap(GridMap(frozen(cells), CELL, (0.0, 0.0)), None, NavigationConfig(), grows=True)


def looks(costmap: Costmap, x: float, done=(), vain=()) -> frontiers.Outlook:
    """The outlook of a base at (x, 1) to which every metre costs one."""
    rows, columns = np.indices(costmap.grid.cells.shape)
    away = np.hypot((columns + 0.5) * CELL - x, (rows + 0.5) * CELL - 1.0)
    free = costmap.grid.cells == FREE
    cost = np.where(free, away, UNREACHED).astype(np.float32)
    return frontiers.outlook(costmap, cost, costmap.field > 0.3, done, vain)


def test_of_equal_nooks_the_nearest_comes_first():
    found = looks(hall(20.0, (4.0, 9.0)), 6.0).prospects
    assert found[0].frontier[0] == pytest.approx(4.0, abs=0.6)
    assert found[-1].frontier[0] == pytest.approx(9.0, abs=0.6)
    assert found[0].gain > frontiers.LEAST_GAIN


def test_what_is_far_away_must_be_large():
    near = frontiers.Prospect((0.0, 0.0), Pose2D(0.0, 0.0), 0.5, 2.0)
    large = frontiers.Prospect((0.0, 0.0), Pose2D(0.0, 0.0), 20.0, 12.0)
    small = frontiers.Prospect((0.0, 0.0), Pose2D(0.0, 0.0), 2.0, 12.0)
    assert large.score > near.score > small.score


def test_a_nook_far_away_is_left_where_the_rest_is_known():
    costmap = hall(60.0, (58.0,))
    assert looks(costmap, 55.0).prospects
    left = looks(costmap, 2.0)
    assert not left.prospects
    assert 1.0 - frontiers.SPARED < left.share < 1.0


def test_nooks_that_are_much_of_the_floor_together_are_looked_at_all_the_same():
    nooks = tuple(np.arange(30.0, 59.0, 1.6))
    left = looks(hall(60.0, nooks), 2.0)
    assert left.share < 1.0 - frontiers.SPARED
    assert not any(each.worth(170.0) for each in left.prospects)
    assert left.prospects


def test_a_nook_that_lies_sideways_is_seen_from_beside_it():
    """From the first place with a view of its edge, a base along the hall sees next to nothing."""
    found = looks(hall(20.0, (12.0,), depth=3.0), 2.0)
    assert found.prospects
    assert found.share < 0.99


def test_a_look_from_afar_is_followed_by_one_from_near():
    costmap = hall(20.0, (4.0,))
    far = looks(costmap, 4.0).prospects[0]
    near = looks(costmap, 4.0, vain=[far.frontier]).prospects
    again = next(each for each in near if each.frontier == far.frontier)

    def away(each: frontiers.Prospect) -> float:
        return math.dist(each.frontier, (each.view.x, each.view.y))

    assert frontiers.NEAR < away(far) < frontiers.FAR + CELL
    assert away(again) < frontiers.NEAR + CELL


def test_what_was_looked_at_in_vain_hides_what_is_behind_it():
    costmap = hall(20.0, (4.0, 16.0))
    before = looks(costmap, 6.0)
    done = [each for each in frontiers.in_sight(frontiers.thick(costmap), 4.0, 2.0) if each[0] < 6]
    after = looks(costmap, 6.0, done=done)
    assert any(each.frontier[0] < 6.0 for each in before.prospects)
    assert not any(each.frontier[0] < 6.0 for each in after.prospects)
    assert before.share < after.share < 1.0
    grid = frontiers.thick(costmap, done)
    assert frontiers.gain_at(grid, *grid.index(4.0, 2.0)) == 0.0


def test_only_what_is_near_and_not_hidden_is_in_sight():
    grid = frontiers.thick(hall(20.0, (4.0, 16.0)))
    seen = frontiers.in_sight(grid, 4.0, 1.5)
    assert seen
    assert all(math.dist(each, (4.0, 1.5)) < frontiers.FAR for each in seen)
    assert not any(each[0] > 10.0 for each in seen)
