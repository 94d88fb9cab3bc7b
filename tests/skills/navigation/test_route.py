"""Routes: the best stand that is free and can be reached, and what a route says of itself."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.drive.route import (
    choose,
    free_stands,
    no_way,
    planning_radius,
    route_to,
)
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.plan.goals import Stand
from momantu_skills.navigation.plan.planner import UNREACHED

from momantu_bt.failure import Failure
from momantu_bt.geometry import Pose2D
from tests.skills.scenery.obedient import MakeObedient

TABLE = (4.0, 2.0, 5.0, 4.0)
POSES = st.builds(Pose2D, st.floats(0.6, 7.4), st.floats(0.6, 5.4), st.floats(-3.1, 3.1))
MANY = st.lists(st.tuples(POSES, st.integers(0, 3), st.floats(0, 5)), min_size=1, max_size=12)


@settings(max_examples=60)
@given(MANY)
def test_one_free_stand_of_each_variant_the_cheapest_first(
    obedient: MakeObedient, drawn: Any
) -> None:
    base = obedient(Pose2D(1.0, 3.0, 0.0), [TABLE])
    stands = [Stand(*each) for each in drawn]
    found = free_stands(base, stands)
    assert [s.cost for s in found] == sorted(s.cost for s in found)
    free = [s for s in stands if base.room(s.pose, whole=False) > base.config.margin]
    assert {s.variant for s in found} == {s.variant for s in free}
    assert len({s.variant for s in found}) == len(found)
    for stand in found:
        assert stand.cost == min(s.cost for s in free if s.variant == stand.variant)


@settings(max_examples=20)
@given(POSES, POSES)
def test_a_route_leads_from_the_base_to_its_lead_in_with_room(
    obedient: MakeObedient, start: Pose2D, goal: Pose2D
) -> None:
    base = obedient(start, [TABLE])
    if base.room(start, whole=False) < 0.1 or base.room(goal, whole=False) < 0.1:
        return
    route = route_to(base, goal)
    assert route is not None
    path = route.plan.path
    cell = base.costmap.grid.resolution
    assert np.hypot(*(path[0] - (start.x, start.y))) < 2 * cell
    assert np.hypot(*(path[-1] - (route.lead_in.x, route.lead_in.y))) < 2 * cell
    back = goal.inverse() @ route.lead_in
    assert back.y == pytest.approx(0.0, abs=1e-9)
    assert -0.6 - 1e-9 <= back.x <= 0.0
    assert route.to_go(route.lead_in) <= 2 * cell * 10
    assert route.to_go(start) >= np.hypot(*(path[-1] - path[0])) - 2 * cell
    assert not route.crossed(base, start)


def test_to_go_falls_along_the_way_and_is_large_off_the_map(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(1.0, 3.0, 0.0), [TABLE])
    route = route_to(base, Pose2D(6.5, 3.0, 0.0))
    assert route is not None
    left = [route.to_go(Pose2D(x, y)) for x, y in route.plan.path[::8]]
    assert (np.diff(left) < 0.0).all()
    assert route.to_go(Pose2D(-3.0, 3.0)) >= UNREACHED
    assert route.to_go(Pose2D(1.0, 60.0)) >= UNREACHED


def test_the_heading_is_along_the_path(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(1.0, 1.0, 2.0))
    route = route_to(base, Pose2D(6.0, 4.0, math.atan2(3.0, 5.0)))
    assert route is not None
    for x, y in route.plan.path[::10]:
        assert route.heading(Pose2D(x, y)) == pytest.approx(math.atan2(3.0, 5.0), abs=0.25)


def test_what_comes_to_stand_on_the_path_crosses_it_and_beside_it_does_not(
    obedient: MakeObedient,
) -> None:
    for bearing, crosses in ((0.0, True), (1.2, False), (-1.2, False)):
        base = obedient(Pose2D(1.0, 3.0, 0.0))
        route = route_to(base, Pose2D(6.0, 3.0, 0.0))
        assert route is not None
        angles = bearing + np.linspace(-0.05, 0.05, 11)
        ways = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        rays = Rays(np.zeros(2), ways, np.full(11, 1.5), np.ones(11, dtype=bool))
        base.costmap.see_laser(base.pose(), rays)
        base.costmap.refresh()
        assert route.crossed(base, base.pose()) is crosses
        assert not route.crossed(base, Pose2D(3.5, 3.0, 0.0)), "it lies behind"


def test_where_the_best_stand_is_taken_the_next_one_serves(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(1.0, 3.0, 0.0), [TABLE])
    stands = [Stand(Pose2D(4.5, 3.0, 0.0), 0, 0.0), Stand(Pose2D(3.4, 3.0, 0.0), 1, 1.0)]
    assert choose(base, stands, 0).stand == stands[1].pose


def test_a_stand_that_cannot_be_reached_is_passed_over(obedient: MakeObedient) -> None:
    cell = [(5.0, 0.0, 5.2, 6.0)]
    base = obedient(Pose2D(1.0, 3.0, 0.0), cell)
    stands = [Stand(Pose2D(6.5, 3.0, 0.0), 0, 0.0), Stand(Pose2D(3.4, 3.0, 0.0), 1, 1.0)]
    assert choose(base, stands, 0).stand == stands[1].pose
    assert choose(base, stands, 1).stand == stands[1].pose


def test_each_way_of_failing_has_its_code(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(1.0, 3.0, 0.0), [TABLE, (6.0, 0.0, 6.2, 6.0)])
    with pytest.raises(Failure) as caught:
        choose(base, [Stand(Pose2D(4.5, 3.0, 0.0), 0, 0.0)], 0)
    assert caught.value.code == "GOAL_BLOCKED"
    with pytest.raises(Failure) as caught:
        choose(base, [Stand(Pose2D(7.0, 3.0, 0.0), 0, 0.0)], 0)
    assert caught.value.code == "NO_PATH"
    assert no_way(base, Pose2D(3.0, 3.0, 0.0)).code == "PATH_BLOCKED"


def test_the_planner_keeps_more_room_than_the_bases_side(obedient: MakeObedient) -> None:
    base = obedient(Pose2D(1.0, 3.0, 0.0))
    assert planning_radius(base) > base.half_width


def test_the_narrowest_point_is_told_also_from_beside_the_path(obedient: MakeObedient) -> None:
    """Between two blocks the way is 0.8 m wide; a base that was pushed aside is 1.5 m off it."""
    base = obedient(Pose2D(1.0, 3.0, 0.0), [(3.0, 0.0, 3.4, 2.6), (3.0, 3.4, 3.4, 6.0)])
    route = route_to(base, Pose2D(6.0, 3.0, 0.0))
    assert route is not None
    x, y, room = route.narrowest(base, Pose2D(2.6, 3.0, 0.0))
    assert 2.8 < x < 3.6
    assert abs(y - 3.0) < 0.2
    assert abs(room - 0.4) < 0.1
    assert route.narrowest(base, Pose2D(2.6, 4.5, 0.0))[2] > 0.0
