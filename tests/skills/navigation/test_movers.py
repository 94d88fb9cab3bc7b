"""What moves is found and predicted; what stands is not, however the base moves."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.map.costmap import Costmap
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.movers import Movers
from momantu_skills.navigation.map.sensing import Rays
from momantu_skills.navigation.plan.planner import plan

from momantu_bt.formats.maps import OCCUPIED
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import BaseLimits

CHAIR = [(x, y, 0.025) for x in (2.0, 2.4) for y in (1.0, 1.4)]
"""Four thin legs, of which beams miss some."""
CABINET = [(3.0, -1.0 - 0.1 * k, 0.08) for k in range(9)]


def _rays(pose: Pose2D, discs: list[tuple[float, float, float]], seed: int) -> Rays:
    """A scan of upright cylinders (x, y, radius) and of a wall at x = 6 m."""
    angles = np.linspace(-1.9, 1.9, 500)
    random = np.random.default_rng(seed)
    ways = np.stack([np.cos(angles + pose.yaw), np.sin(angles + pose.yaw)], axis=1)
    with np.errstate(divide="ignore"):
        ranges = np.where(ways[:, 0] > 1e-9, (6.0 - pose.x) / ways[:, 0], np.inf)
    for x, y, radius in discs:
        off = np.array([x - pose.x, y - pose.y])
        along = ways @ off
        aside = np.abs(ways[:, 0] * off[1] - ways[:, 1] * off[0])
        met = (aside < radius) & (along > 0)
        near = along - np.sqrt(np.maximum(radius**2 - aside**2, 0.0))
        ranges = np.where(met, np.minimum(ranges, near), ranges)
    hit = ranges < 20.0
    ranges = np.where(hit, ranges + random.normal(0.0, 0.012, len(ranges)), 25.0)
    flat = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return Rays(np.zeros(2), flat, ranges, hit)


def _legs(x: float, y: float) -> list[tuple[float, float, float]]:
    return [(x, y + 0.13, 0.1), (x, y - 0.13, 0.1)]


def _watched(
    base: Callable[[float], Pose2D],
    person: Callable[[float], tuple[float, float]] | None,
    end: float,
) -> list[Array]:
    movers, found = Movers(), []
    for k in range(round(end / 0.1)):
        now = 0.1 * k
        things = [*CHAIR, *CABINET, *(_legs(*person(now)) if person else [])]
        movers.see(now, base(now), _rays(base(now), things, k))
        found.append(movers.moving(now))
    return found


@pytest.mark.parametrize("turn", [0.0, 0.4, -0.8])
@pytest.mark.parametrize("speed", [0.0, 0.5, 1.0])
def test_nothing_moves_where_only_the_base_does(speed: float, turn: float) -> None:
    def base(t: float) -> Pose2D:
        return Pose2D(-3.0 + speed * t, 0.3, turn * math.sin(t))

    assert all(len(rows) == 0 for rows in _watched(base, None, 5.0))


@pytest.mark.parametrize("velocity", [(0.0, 1.0), (0.0, -0.7), (-0.9, 0.2)])
@pytest.mark.parametrize("speed", [0.0, 0.6])
def test_somebody_who_walks_is_found_within_a_second(
    speed: float, velocity: tuple[float, float]
) -> None:
    def person(t: float) -> tuple[float, float]:
        return 1.2 + velocity[0] * t, -1.3 * np.sign(velocity[1]) + velocity[1] * t

    found = _watched(lambda t: Pose2D(-3.0 + speed * t, 0.0, 0.0), person, 2.2)
    late = found[14:]
    assert all(len(rows) == 1 for rows in late), [len(rows) for rows in found]
    place, seen = late[-1][0, :2], late[-1][0, 2:]
    assert np.hypot(*(place - person(2.1))) < 0.25
    assert np.hypot(*(seen - velocity)) < 0.25


def test_somebody_who_stops_stands() -> None:
    found = _watched(lambda t: Pose2D(-2.0, 0.0), lambda t: (1.0, -1.5 + min(t, 2.0)), 4.0)
    assert len(found[18]) == 1
    assert len(found[-1]) == 0


def _costmap() -> Costmap:
    cells = np.zeros((120, 160), np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = OCCUPIED
    return Costmap(GridMap(cells, 0.05, (0.0, 0.0)), None, NavigationConfig())


def test_the_costmap_forgets_what_walks_away() -> None:
    costmap, pose = _costmap(), Pose2D(1.0, 3.0)
    costmap.see_laser(pose, _rays(pose, _legs(3.0, 3.0), 0))
    costmap.refresh()
    disc = np.array([[0.0, 0.0, 0.2]])
    assert costmap.room(Pose2D(3.0, 3.0), disc) < 0.0
    costmap.forget(np.array([[3.0, 3.0]]), 0.45)
    costmap.refresh()
    assert costmap.room(Pose2D(3.0, 3.0), disc) > 0.1


def test_the_controller_waits_for_somebody_who_is_about_to_cross() -> None:
    limits = BaseLimits(linear=1.0, angular=1.5, linear_acceleration=1.0, angular_acceleration=3.0)
    config, costmap = NavigationConfig(), _costmap()
    disc = np.array([[0.0, 0.0, 0.28]])
    start, goal = Pose2D(2.0, 3.0), Pose2D(7.0, 3.0)
    way = plan(costmap, start, goal, 0.28, config.comfort, config.planner)
    assert way is not None
    speeds = []
    for movers in (np.zeros((0, 4)), np.array([[2.9, 3.9, 0.0, -0.9]])):
        mppi = Mppi(limits, config, np.random.default_rng(0))
        costmap.movers = movers
        for _ in range(8):
            command = mppi.command(start, (0.5, 0.0, 0.0), costmap, disc, way)
        speeds.append(command[0])
    assert speeds[0] > 0.6
    assert speeds[1] < 0.7 * speeds[0]
