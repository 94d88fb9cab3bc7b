"""Two rooms in which nothing is wrong; each test changes one thing, and just that is found."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from momantu_worlds.checking.measures import Measures
from momantu_worlds.checking.run import CHECKS
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.scenes.geometry.bodies import (
    Actor,
    Body,
    Box,
    Cylinder,
    Episode,
    Gap,
    Goal,
    Part,
    Picture,
)

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.world import Site, Surface
from momantu_bt.zone import Zone

HEIGHT = 0.7
"""m, of the tables."""
PIXELS = np.zeros((8, 8, 3), dtype=np.uint8)

ROBOT = Measures(
    name="carrier",
    footprint=np.array([(0.3, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.3, -0.25)]),
    half_width=0.25,
    height=1.2,
    reach=(0.3, 0.6, 0.9),
    eyes=(1.1,),
    hand=np.array([(0.6, h / 100) for h in range(30, 120)]),
    max_width=0.1,
)


def wall(name: str, x: float, y: float, dx: float, dy: float) -> Body:
    return Body(name, "wall", Transform((x, y, 1.0)), (Part(Box((dx, dy, 2.0))),))


def table(name: str, x: float, y: float, height: float = HEIGHT) -> Body:
    top = Part(Box((0.8, 0.8, height)), Transform((0, 0, height / 2)))
    return Body(name, "table", Transform((x, y, 0.0)), (top,))


def can(name: str, x: float, y: float, bottom: float = HEIGHT, radius: float = 0.03) -> Body:
    part = Part(Cylinder(radius, 0.12))
    return Body(name, "can", Transform((x, y, bottom + 0.06)), (part,), static=False, mass=0.3)


def tag(pose: Transform) -> Body:
    return Body("tag", "tag", pose, (Part(Picture((0.15, 0.15), PIXELS), collision=False),))


BODIES = (
    wall("wall_south", 0.0, -3.0, 6.1, 0.1),
    wall("wall_north", 0.0, 3.0, 6.1, 0.1),
    wall("wall_west", -3.0, 0.0, 0.1, 6.1),
    wall("wall_east", 3.0, 0.0, 0.1, 6.1),
    wall("wall_middle_south", 0.0, -1.75, 0.1, 2.5),
    wall("wall_middle_north", 0.0, 1.75, 0.1, 2.5),
    table("a", -2.0, 2.0),
    table("b", 2.0, 2.0),
    can("can", -2.0, 1.75),
    tag(Transform((2.0, 1.85, HEIGHT + 0.0005))),
)
"""Two rooms of 3 x 6 m, a door of 1 m between them at the origin."""

SURFACES = {
    name: Surface(Pose2D(x, 2.0, 0.0), (0.8, 0.8), HEIGHT, (-math.pi / 2, 0.0, math.pi))
    for name, x in (("a", -2.0), ("b", 2.0))
}
EPISODE = Episode(
    name="two_rooms",
    seed=0,
    bodies=BODIES,
    start=Pose2D(-1.5, -1.0, 0.4),
    ambient=(0.5, 0.5, 0.5),
    suns=(),
    lamps=(),
    site=Site("two_rooms", places={"there": Pose2D(1.5, -1.0, 0.0)}, surfaces=SURFACES),
    goals=(Goal("can", "b", "tag", 0.1, 0.3, 1.0, 0.1, 0.5, 0.1, 100.0),),
    doorways={"door": Gap((0.0, 0.0), 0.4)},
)


def changed(*bodies: Body, robot: Measures = ROBOT, **fields: object) -> Scenario:
    """The scenario with some bodies put in the place of those of their names, or added."""
    new = {body.name: body for body in bodies}
    kept = [new.pop(b.name, b) for b in BODIES]
    episode = replace(EPISODE, bodies=(*kept, *new.values()), **fields)
    return Scenario(episode, robot, lambda name: ("bodies", name))


def all_codes(scenario: Scenario) -> list[tuple[str, tuple[str, ...]]]:
    return [(remark.code, remark.about) for check in CHECKS for remark in check(scenario)]


def test_nothing_is_wrong_at_first() -> None:
    assert all_codes(changed()) == []


high, narrow = Part(Box((0.3, 0.02, 0.6))), Part(Box((0.02, 0.22, 0.6)))
CASES = {
    "furniture in a wall": (
        changed(table("a", -2.56, 2.0), can("can", -2.5, 1.75)),
        "overlap",
        ("a", "wall_west"),
    ),
    "furniture in furniture": (changed(table("c", 1.4, 2.0)), "overlap", ("c", "b")),
    "a can in a can": (
        changed(can("other", -2.03, 1.76)),
        "overlap",
        ("other", "can"),
    ),
    "a can in a table": (changed(can("other", 2.0, 2.2, HEIGHT - 0.02)), "overlap", ("other", "b")),
    "a can in the floor": (changed(can("other", 1.0, -2.0, -0.02)), "in-floor", ("other",)),
    "a can in the air": (changed(can("other", 2.0, 2.2, HEIGHT + 0.04)), "in-the-air", ("other",)),
    "a can over the edge": (
        changed(can("other", 2.0, 1.59)),
        "over-the-edge",
        ("other",),
    ),
    "a start in a wall": (
        changed(start=Pose2D(-2.8, -1.0, 0.0)),
        "start-in-collision",
        ("wall_west",),
    ),
    "a place in a wall": (
        changed(site=replace(EPISODE.site, places={"there": Pose2D(2.9, -1.0, 0.0)})),
        "place-blocked",
        ("there",),
    ),
    "a place outside": (
        changed(site=replace(EPISODE.site, places={"there": Pose2D(3.6, -1.0, 0.0)})),
        "place-unreachable",
        ("there",),
    ),
    "a tag in a table": (changed(tag(Transform((2.0, 1.85, 0.4)))), "tag-unseen", ("tag",)),
    "a tag that faces a wall": (
        changed(tag(Transform.from_rpy((2.94, -1.0, 1.0), (0, math.pi / 2, 0)))),
        "tag-unseen",
        ("tag",),
    ),
    "a tag under something": (
        changed(
            Body("lid", "crate", Transform((2.0, 2.0, 0.75)), (Part(Box((0.8, 0.8, 0.02))),)),
        ),
        "tag-unseen",
        ("tag",),
    ),
    "an item too wide": (changed(can("can", -2.0, 1.75, radius=0.06)), "item-too-wide", ("can",)),
}


CASES |= {
    "a door too narrow": (
        changed(wall("wall_middle_south", 0.0, -1.4, 0.1, 3.0)),
        "door-narrow",
        ("door",),
    ),
    "a door with a crate in it": (
        changed(Body("crate", "crate", Transform((0, 0, 0.2)), (Part(Box((0.5, 0.5, 0.4))),))),
        "door-blocked",
        ("door", "crate"),
    ),
    "a table behind a wall": (
        changed(wall("wall_middle_south", 0.0, -1.45, 0.1, 3.1)),
        "surface-unreachable",
        ("b",),
    ),
    "a table too high": (
        changed(table("b", 2.0, 2.0, 1.3), tag(Transform((2.0, 1.85, 1.3005)))),
        "surface-height",
        ("b",),
    ),
    "an item too far from every side": (
        changed(
            table("a", -2.55, 2.55),
            can("can", -2.7, 2.7),
            robot=replace(ROBOT, reach=(0.2, 0.4, 0.6)),
        ),
        "item-out-of-reach",
        ("can",),
    ),
    "a goal that is met": (changed(can("can", 2.0, 2.0)), "goal-met", ()),
    "a goal without room": (
        changed(
            *(
                can(f"c{i}{j}", 1.7 + 0.1 * i, 1.7 + 0.1 * j, radius=0.045)
                for i in range(7)
                for j in range(7)
            ),
            tag(Transform((2.0, 2.0, HEIGHT + 0.05))),
        ),
        "goal-no-room",
        (),
    ),
    "a goal out of reach": (
        changed(
            table("b", 2.55, 2.55),
            tag(Transform((2.8, 2.8, HEIGHT + 0.0005))),
            robot=replace(ROBOT, reach=(0.2, 0.4, 0.5)),
            goals=(replace(EPISODE.goal, max_distance=0.1),),
        ),
        "goal-out-of-reach",
        (),
    ),
}
CONSEQUENCES = {
    "a door too narrow": {
        "surface-unreachable",
        "place-unreachable",
        "tag-unseen",
        "goal-out-of-reach",
    },
    "a door with a crate in it": {
        "surface-unreachable",
        "place-unreachable",
        "tag-unseen",
        "goal-out-of-reach",
    },
    "a table behind a wall": {
        "door-narrow",
        "place-unreachable",
        "tag-unseen",
        "goal-out-of-reach",
    },
    "a table too high": {"tag-unseen"},
    "a tag under something": {"goal-no-room"},
    "a goal without room": {"tag-unseen"},
    "a tag that faces a wall": {"goal-no-room"},
    "a tag beyond the room": {"goal-no-room"},
}
"""What follows from what is wrong, and is found beside it."""


@pytest.mark.parametrize("case", CASES)
def test_one_thing_is_wrong(case: str) -> None:
    scenario, code, about = CASES[case]
    found = all_codes(scenario)
    assert (code, about) in found
    assert {other for other, _ in found} <= {code} | CONSEQUENCES.get(case, set())


def zoned(*corners: tuple[float, float]) -> set[str]:
    """What is found where a keep-out zone has these corners."""
    site = replace(EPISODE.site, zones={"stairs": Zone("keep_out", corners)})
    return {code for code, _ in all_codes(changed(site=site))}


def test_zones_to_keep_out_of_are_where_the_robot_does_not_get() -> None:
    assert zoned((2.0, -2.9), (2.9, -2.9), (2.9, -2.0)) == set()
    assert "start-kept-out" in zoned((-1.5, -1.0), (-1.0, -1.0), (-1.0, -0.5))
    assert zoned((50.0, 50.0), (51.0, 50.0), (51.0, 51.0)) == {"zone-elsewhere"}
    assert zoned((1.4, -1.1), (1.6, -1.1), (1.5, -0.9)) == {"place-blocked"}
    closed = zoned((-0.2, -0.6), (0.2, -0.6), (0.2, 0.6), (-0.2, 0.6))
    assert {"place-unreachable", "door-blocked", "surface-unreachable"} <= closed


def acted(*stops: tuple[float, float]) -> set[str]:
    """What is found where somebody walks between these stops."""
    anna = Actor("anna", stops, (0.8, 0.9), (0.0, 1.0))
    return {code for code, _ in all_codes(changed(actors=(anna,)))}


def test_people_can_stand_at_their_stops_and_walk_between_them() -> None:
    x, y = EPISODE.start.x, EPISODE.start.y
    assert acted((-2.0, -2.0), (2.0, -2.0)) == set()
    assert acted((-2.0, -2.0), (2.0, 2.0)) == {"stop-blocked"}
    assert acted((-2.0, -2.0), (9.0, -2.0)) == {"stops-apart"}
    assert acted((x + 0.5, y), (x, y + 0.5)) == {"stops-at-start"}
