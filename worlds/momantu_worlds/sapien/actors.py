"""The actors of an episode: everybody is put on a stop, groups one behind the other."""

from __future__ import annotations

import math

from momantu_bt.world import WorldError, seeded
from momantu_worlds.people.floor import FROM_START, PeopleFloor
from momantu_worlds.people.walker import BEHIND, RADIUS, Follower, Point, Walker
from momantu_worlds.sapien.crowd import Crowd
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.geometry.bodies import Actor, Episode

RING = 16
"""Directions around the first of a group in which the others are put."""


def crowd_of(simulator: Simulator, episode: Episode, seed: int) -> Crowd:
    """The people of an episode, each on a stop; WorldError if there is no room for somebody."""
    stops = [stop for actor in episode.actors for stop in actor.stops]
    crowd = Crowd(simulator, PeopleFloor(episode.bodies, stops))
    start = (episode.start.x, episode.start.y)
    for actor in episode.actors:
        _admit(crowd, actor, start, seed)
    return crowd


def _admit(crowd: Crowd, actor: Actor, start: Point, seed: int) -> None:
    """Put a person, and those who walk behind it, on one of its stops."""
    random = seeded(seed, "actor", actor.name)
    able = Actor(
        actor.name, _stops(crowd, actor), actor.speed, actor.pause, actor.group, actor.color
    )
    begins = [stop for stop in able.stops if _has_room(crowd, stop, start)]
    if not begins:
        raise WorldError(
            f"the actor {actor.name!r} has no stop to begin at: each is within {FROM_START:g} "
            "m of the robot, or somebody stands there; give it another stop"
        )
    first = begins[int(random.integers(len(begins)))]
    leader = Walker(able, crowd.floor, first, random)
    crowd.join(leader, actor.name, actor.color)
    for number in range(2, actor.group + 1):
        name = f"{actor.name}_{number}"
        member = Actor(name, able.stops, able.speed, able.pause, 1, able.color)
        place = _beside(crowd, leader.at, start, actor.name)
        before, draw = crowd.walkers[-1], seeded(seed, "actor", name)
        crowd.join(Follower(member, crowd.floor, place, draw, before), actor.name, actor.color)


def _stops(crowd: Crowd, actor: Actor) -> tuple[Point, ...]:
    """The stops of an actor, moved to where there is room."""
    found: list[Point] = []
    for number, wanted in enumerate(actor.stops, 1):
        stop = crowd.floor.stop(wanted)
        if stop is None:
            raise WorldError(
                f"the actor {actor.name!r} cannot stand at its stop {number}, ({wanted[0]:g}, "
                f"{wanted[1]:g}): no free floor within half a metre; move the stop, or what "
                "stands there"
            )
        found.append(stop)
    return tuple(found)


def _beside(crowd: Crowd, point: Point, start: Point, name: str) -> Point:
    """A place for the next of a group, near the first one."""
    for away in (BEHIND, 1.5 * BEHIND, 2.0 * BEHIND, 3.0 * BEHIND):
        for k in range(RING):
            turn = 2.0 * math.pi * k / RING
            there = (point[0] + away * math.cos(turn), point[1] + away * math.sin(turn))
            if _has_room(crowd, there, start) and crowd.floor.free(there):
                return there
    raise WorldError(f"there is no room for the group of the actor {name!r} at its first stop")


def _has_room(crowd: Crowd, point: Point, start: Point) -> bool:
    """Whether a point is far from the robot's start and from everybody."""
    return math.dist(point, start) > FROM_START and all(
        math.dist(point, walker.at) > 3 * RADIUS for walker in crowd.walkers
    )
