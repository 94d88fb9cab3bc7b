"""People walk to their stops, give way to the robot and to each other, and never run into it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from momantu_worlds.people.floor import PeopleFloor
from momantu_worlds.people.walker import BEHIND, RADIUS, Follower, Seen, Walker
from momantu_worlds.scenes.geometry.bodies import Actor, Body, Box, Part
from momantu_worlds.scenes.geometry.plane import Rectangle
from momantu_worlds.scenes.geometry.prisms import body_prism

from momantu_bt.geometry import Pose2D, Transform

DT = 0.05
FAR = Seen([], (50.0, 50.0))


def _wall(x: float, y: float, dx: float, dy: float) -> Body:
    return Body("wall", "wall", Transform((x, y, 1.0)), (Part(Box((dx, dy, 2.0))),))


HALL = (
    _wall(0.0, -3.0, 8.0, 0.1),
    _wall(0.0, 3.0, 8.0, 0.1),
    _wall(-4.0, 0.0, 0.1, 6.0),
    _wall(4.0, 0.0, 0.1, 6.0),
    _wall(0.0, 1.9, 0.1, 2.2),
    _wall(0.0, -1.9, 0.1, 2.2),
)
"""Two rooms and a door of 1.6 m between them."""
FLOOR = PeopleFloor(HALL)
ANNA = Actor("anna", ((-3.0, 2.0), (3.0, -2.0), (3.0, 2.0)), (0.8, 1.0), (0.5, 1.0))


def _walker(seed: int = 0, start: tuple[float, float] = (-3.0, 2.0)) -> Walker:
    return Walker(ANNA, FLOOR, start, np.random.default_rng(seed))


def _from_walls(point: tuple[float, float]) -> float:
    prisms = [body_prism(wall, wall.map_from_body) for wall in HALL]
    at = np.array([point])
    return min(float(each.base.distance(at)[0]) for each in prisms if each is not None)


def _robot(x: float, y: float, yaw: float = 0.0) -> Seen:
    return Seen([Rectangle(Pose2D(x, y, yaw), (0.55, 0.5))], (x, y))


def test_a_way_leads_through_the_door_and_keeps_clear() -> None:
    way = FLOOR.way((-3.0, 2.0), (3.0, 2.0))
    assert math.dist(way[-1], (3.0, 2.0)) < 0.1
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(way)])
    assert all(FLOOR.free((float(x), float(y))) for x, y in dense)
    assert len(way) < 8
    assert len(FLOOR.way((-3.0, 2.0), (3.0, 2.0), around=[(0.0, 0.0)])) == 0


def test_a_stop_moves_to_free_floor_or_is_refused() -> None:
    assert FLOOR.stop((3.0, 2.0)) == (3.0, 2.0)
    near = FLOOR.stop((3.9, 2.0))
    assert near is not None
    assert FLOOR.free(near)
    assert FLOOR.stop((9.0, 2.0)) is None


@pytest.mark.parametrize("seed", range(4))
def test_it_gets_about_at_its_pace_and_the_same_seed_walks_the_same(seed: int) -> None:
    one, same = _walker(seed), _walker(seed)
    way, fastest = 0.0, 0.0
    for k in range(1200):
        before = one.pose
        one.advance(k * DT, DT, FAR)
        same.advance(k * DT, DT, FAR)
        assert one.pose == same.pose
        step = before.distance_to(one.pose)
        way, fastest = way + step, max(fastest, step / DT)
        assert _from_walls(one.at) > RADIUS - 0.01
    assert way > 25.0
    assert fastest <= 1.0 + 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_before_a_robot_in_the_door_it_stands(seed: int) -> None:
    walker, least = _walker(seed), math.inf
    seen = _robot(0.0, 0.0)
    for k in range(800):
        walker.advance(k * DT, DT, seen)
        least = min(least, seen.gap(walker.at))
    assert least > 0.25


def test_it_steps_back_from_a_robot_that_comes() -> None:
    walker, least = _walker(start=(2.0, 0.0)), math.inf
    for k in range(120):
        seen = _robot(-1.0 + 0.5 * k * DT, 0.0)
        walker.advance(k * DT, DT, seen)
        least = min(least, seen.gap(walker.at))
        assert _from_walls(walker.at) > RADIUS - 0.01
    assert least > 0.1


def test_two_who_meet_in_the_door_both_get_through() -> None:
    here = Walker(Actor("a", ((-3.0, 0.0), (3.0, 0.0)), (0.9, 0.9), (0.0, 0.0)), FLOOR,
                  (-3.0, 0.0), np.random.default_rng(0))  # fmt: skip
    there = Walker(Actor("b", ((3.0, 0.0), (-3.0, 0.0)), (0.9, 0.9), (0.0, 0.0)), FLOOR,
                   (3.0, 0.0), np.random.default_rng(1))  # fmt: skip
    turns = [0, 0]
    ends = [3.0, -3.0]
    nearest = math.inf
    for k in range(2400):
        here.advance(k * DT, DT, Seen([], (50.0, 50.0), later=[there.at]))
        there.advance(k * DT, DT, Seen([], (50.0, 50.0), earlier=[here.at]))
        nearest = min(nearest, math.dist(here.at, there.at))
        for n, walker in enumerate((here, there)):
            if abs(walker.at[0] - ends[n]) < 0.3:
                turns[n] += 1
                ends[n] = -ends[n]
    assert min(turns) >= 4
    assert nearest > 1.2 * RADIUS


def test_a_follower_stays_behind_its_leader() -> None:
    leader = _walker(3)
    member = Follower(ANNA, FLOOR, (-2.1, 2.0), np.random.default_rng(9), leader)
    apart = []
    for k in range(1600):
        leader.advance(k * DT, DT, Seen([], (50.0, 50.0), group=[member.at]))
        member.advance(k * DT, DT, Seen([], (50.0, 50.0), group=[leader.at]))
        apart.append(math.dist(leader.at, member.at))
    assert np.median(apart) < 2.0 * BEHIND
    assert np.quantile(apart, 0.95) < 4.0
