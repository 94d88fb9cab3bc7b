"""Zones in the costmap: where they block, what they limit, what the planner makes of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.zones import DOUBT, Zones
from momantu_skills.navigation.plan.planner import plan

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Pose2D
from momantu_bt.zone import Zone

SQUARE = ((3.0, 2.0), (4.0, 2.0), (4.0, 4.0), (3.0, 4.0))
DISC = np.array([[0.0, 0.0, 0.25]])
CONFIG = NavigationConfig()


def _costmap(**zones: Zone) -> Costmap:
    """8 m x 6 m from (0, 0), walled in."""
    cells = np.zeros((120, 160), np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    return Costmap(GridMap(cells, 0.05, (0.0, 0.0)), None, CONFIG, Zones(zones))


@given(st.floats(0.5, 7.5), st.floats(0.5, 5.5), st.floats(-3.1, 3.1))
def test_room_never_promises_more_than_there_is_to_the_zone(x: float, y: float, yaw: float) -> None:
    zone = Zone("keep_out", SQUARE)
    costmap, pose = _costmap(stairs=zone), Pose2D(x, y, yaw)
    to_zone = float(zone.distance(np.array([[x, y]]))[0]) - 0.25
    if costmap.room(pose, DISC) > 0.0:
        assert to_zone > 0.0
    entered = costmap.zones.entered(pose, DISC)
    assert entered == ("stairs" if to_zone < -DOUBT else None)


def test_the_map_itself_stays_without_zones() -> None:
    plain, zoned = _costmap(), _costmap(stairs=Zone("keep_out", SQUARE))
    assert np.array_equal(plain.known, zoned.known)
    assert np.array_equal(plain.mapped_field, zoned.mapped_field)
    assert np.array_equal(plain.field, plain.known_field)
    zoned.clear()
    assert np.array_equal(zoned.field, zoned.known_field)
    assert zoned.room(Pose2D(3.5, 3.0), DISC) < 0.0


def test_the_plan_goes_round_a_keep_out_zone() -> None:
    zone = Zone("keep_out", SQUARE)
    for costmap, least in ((_costmap(), -1.0), (_costmap(stairs=zone), 0.24)):
        way = plan(
            costmap, Pose2D(1.0, 3.0), Pose2D(7.0, 3.0), 0.25, CONFIG.comfort, CONFIG.planner
        )
        assert way is not None
        nearest = float(zone.distance(way.path).min())
        assert (nearest > least) if least > 0 else (nearest < 0.0)


def test_the_plan_takes_a_detour_for_a_preferred_zone() -> None:
    lane = Zone("preferred", ((0.5, 4.2), (7.5, 4.2), (7.5, 5.2), (0.5, 5.2)))
    ends = Pose2D(1.0, 3.6), Pose2D(7.0, 3.6)
    inside = []
    for costmap in (_costmap(), _costmap(lane=lane)):
        way = plan(costmap, *ends, 0.25, CONFIG.comfort, CONFIG.planner)
        assert way is not None
        inside.append(float((lane.distance(way.path) < 0.0).mean()))
    assert inside[0] == 0.0
    assert inside[1] > 0.6


@given(st.floats(0.5, 2.7))
def test_from_the_limit_the_base_can_brake_to_the_zones_speed(x: float) -> None:
    zones = Zones({"door": Zone("slow", SQUARE, 0.2)})
    fast = zones.limit(Pose2D(x, 3.0), DISC, 1.0)
    ahead = 3.0 - x - 0.25
    braking = 0.3 * fast + (fast**2 - 0.2**2) / (2 * 0.5)
    assert fast >= 0.2
    assert braking <= max(ahead, 0.0) + 0.3 * 0.2 + 1e-9


def test_inside_the_limit_is_the_zones() -> None:
    zones = Zones({"door": Zone("slow", SQUARE, 0.2), "hall": Zone("slow", SQUARE, 0.5)})
    assert zones.limit(Pose2D(3.5, 3.0), DISC, 1.0) == pytest.approx(0.2)
    assert zones.slowest(Pose2D(2.0, 3.0), 1.5) == 0.2
    assert zones.slowest(Pose2D(2.0, 3.0), 0.5) == math.inf
    assert Zones().limit(Pose2D(0.0, 0.0), DISC, 1.0) == math.inf


def test_the_border_of_the_zone_that_the_base_stands_in_does_not_hold_it() -> None:
    zones = Zones({"stairs": Zone("keep_out", SQUARE)})
    assert len(zones.border(Pose2D(3.5, 3.0, 1.0))) == 0
    seen = zones.border(Pose2D(2.0, 3.0, math.pi / 2))
    assert seen[:, 1].max() == pytest.approx(-1.0)  # x of the map is to the right of the base
