"""Plans exist where there is a way, keep their room, and are nearly as short as can be."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.config import NavigationConfig, PlannerConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.plan.planner import plan

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D

RADIUS = 0.3
COSTS = PlannerConfig()


def _costmap(boxes: list[tuple[int, int, int, int]]) -> Costmap:
    """6 m x 5 m from the origin with boxes (row, column, height, width) of 0.25 m blocks."""
    blocks = np.zeros((20, 24), np.uint8)
    blocks[[0, -1], :] = OCCUPIED
    blocks[:, [0, -1]] = OCCUPIED
    for row, column, height, width in boxes:
        blocks[row : row + height, column : column + width] = OCCUPIED
    return Costmap(
        GridMap(blocks.repeat(5, 0).repeat(5, 1), 0.05, (0.0, 0.0)), None, NavigationConfig()
    )


def _reachable(costmap: Costmap, start: Pose2D, goal: Pose2D, radius: float) -> bool:
    """By flooding the cells with enough room."""
    free = costmap.field > radius
    seen = np.zeros_like(free)
    stack = [costmap.grid.index(start.x, start.y)]
    while stack:
        row, column = stack.pop()
        if free[row, column] and not seen[row, column]:
            seen[row, column] = True
            stack += [(row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)]
    return bool(seen[costmap.grid.index(goal.x, goal.y)])


BOXES = st.lists(
    st.tuples(st.integers(1, 18), st.integers(1, 22), st.integers(1, 8), st.integers(1, 8)),
    max_size=5,
)
SPOTS = st.builds(Pose2D, st.floats(0.6, 5.4), st.floats(0.6, 4.4))


@settings(max_examples=60)
@given(BOXES, SPOTS, SPOTS)
def test_a_plan_is_found_where_there_is_a_way(
    boxes: list[tuple[int, int, int, int]], start: Pose2D, goal: Pose2D
) -> None:
    costmap = _costmap(boxes)
    found = plan(costmap, start, goal, RADIUS, 0.12, COSTS)
    if _reachable(costmap, start, goal, RADIUS):
        assert found is not None
    elif found is not None:
        assert _reachable(costmap, start, goal, RADIUS - COSTS.tight_by)


@settings(max_examples=60)
@given(BOXES, SPOTS, SPOTS)
def test_paths_keep_their_room(
    boxes: list[tuple[int, int, int, int]], start: Pose2D, goal: Pose2D
) -> None:
    costmap = _costmap(boxes)
    assume(_reachable(costmap, start, goal, RADIUS))
    found = plan(costmap, start, goal, RADIUS, 0.12, COSTS)
    assert found is not None
    disc = np.array([[0.0, 0.0, RADIUS - COSTS.tight_by]])
    rooms = [costmap.room(Pose2D(float(x), float(y)), disc) for x, y in found.path]
    assert min(rooms) > -0.06
    assert np.hypot(*np.diff(found.path, axis=0).T).max() < 0.11
    assert found.path[0] == pytest.approx((start.x, start.y))
    assert found.path[-1] == pytest.approx((goal.x, goal.y))


@given(SPOTS, SPOTS)
def test_in_the_open_the_way_is_straight(start: Pose2D, goal: Pose2D) -> None:
    found = plan(_costmap([]), start, goal, 0.05, 0.02, COSTS)
    assert found is not None
    assert found.length <= 1.04 * start.distance_to(goal) + 0.05


def test_the_wider_gap_is_taken() -> None:
    walls = [(1, 11, 2, 2), (8, 11, 6, 2), (17, 11, 2, 2)]
    found = plan(_costmap(walls), Pose2D(1.0, 2.5), Pose2D(5.0, 2.5), RADIUS, 0.12, COSTS)
    assert found is not None
    crossing = found.path[np.abs(found.path[:, 0] - 3.0).argmin()]
    assert crossing[1] == pytest.approx(1.375, abs=0.15) or crossing[1] == pytest.approx(
        3.6, abs=0.2
    )


def test_no_plan_through_a_gap_that_is_too_narrow() -> None:
    walls = [(1, 11, 9, 2), (12, 11, 7, 2)]
    start, goal = Pose2D(1.0, 2.5), Pose2D(5.0, 2.5)
    assert plan(_costmap(walls), start, goal, 0.4, 0.12, COSTS) is None
    assert plan(_costmap(walls), start, goal, 0.2, 0.12, COSTS) is not None


@pytest.mark.parametrize("goal", [Pose2D(-1.0, 2.0), Pose2D(2.0, 99.0), Pose2D(0.1, 0.1)])
def test_no_plan_off_the_map_or_into_a_wall(goal: Pose2D) -> None:
    assert plan(_costmap([]), Pose2D(1.0, 1.0), goal, RADIUS, 0.12, COSTS) is None


def test_known_alone_ignores_what_is_seen() -> None:
    costmap = _costmap([])
    costmap.field[:, 55:65] = 0.0
    start, goal = Pose2D(1.0, 2.5), Pose2D(5.0, 2.5)
    assert plan(costmap, start, goal, RADIUS, 0.12, COSTS) is None
    assert plan(costmap, start, goal, RADIUS, 0.12, COSTS, known=True) is not None


def test_cost_falls_along_the_path() -> None:
    costmap = _costmap([(5, 8, 8, 2)])
    found = plan(costmap, Pose2D(0.8, 2.2), Pose2D(5.2, 2.2), RADIUS, 0.12, COSTS)
    assert found is not None
    cells = np.floor(found.path / 0.05).astype(int)
    along = found.cost[cells[:, 1], cells[:, 0]]
    assert along[0] > math.hypot(4.4, 0.0)
    assert (np.diff(along) < 0.15).all()
