"""Checks of people who walk about: whether they can stand at their stops, and get there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.people.floor import FROM_START, NEAR, PeopleFloor
from momantu_worlds.people.walker import Point
from momantu_worlds.scenes.geometry.bodies import Actor


def actors(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check every actor's stops, and the ways between them."""
    episode = scenario.episode
    if not episode.actors:
        return
    stops = [stop for actor in episode.actors for stop in actor.stops]
    floor = PeopleFloor(episode.bodies, stops)
    start = (episode.start.x, episode.start.y)
    for actor in episode.actors:
        free = [floor.stop(stop) for stop in actor.stops]
        yield from _blocked(actor, free)
        there = [stop for stop in free if stop is not None]
        if len(there) == len(free):
            yield from _no_beginning(actor, there, start)
            yield from _no_ways(actor, there, floor)


def _blocked(actor: Actor, free: list[Point | None]) -> Iterator[FindingAtKeys]:
    for number, (stop, found) in enumerate(zip(actor.stops, free, strict=True)):
        if found is None:
            yield FindingAtKeys(
                Severity.ERROR,
                "stop-blocked",
                f"{actor.name} cannot stand at stop {number + 1}, ({stop[0]:g}, {stop[1]:g}): no "
                f"free floor within {NEAR:g} m",
                "move the stop, or what stands there",
                ("actors", actor.name, "stops", number),
                about=(actor.name, str(number)),
            )


def _no_beginning(actor: Actor, stops: list[Point], start: Point) -> Iterator[FindingAtKeys]:
    farthest = max(math.dist(stop, start) for stop in stops)
    if farthest <= FROM_START:
        yield FindingAtKeys(
            Severity.ERROR,
            "stops-at-start",
            f"{actor.name} has no stop to begin at: all are within {farthest:.2f} m of the robot's "
            "start",
            f"give a stop that is more than {FROM_START:g} m away from it",
            ("actors", actor.name, "stops"),
            about=(actor.name,),
            amount=FROM_START - farthest,
        )


def _no_ways(actor: Actor, stops: list[Point], floor: PeopleFloor) -> Iterator[FindingAtKeys]:
    apart = [pair for pair in combinations(range(len(stops)), 2) if math.dist(*_of(stops, pair))]
    lost = [pair for pair in apart if not len(floor.way(*_of(stops, pair)))]
    if lost:
        a, b = lost[0]
        yield FindingAtKeys(
            Severity.WARNING,
            "stops-apart",
            f"{actor.name} cannot walk from stop {a + 1} to stop {b + 1}: no way is wide enough",
            "give stops on one side, or make room between them",
            ("actors", actor.name, "stops", b),
            about=(actor.name,),
        )


def _of(stops: list[Point], pair: tuple[int, int]) -> tuple[Point, Point]:
    return stops[pair[0]], stops[pair[1]]
