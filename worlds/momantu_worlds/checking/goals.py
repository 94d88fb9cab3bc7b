"""Checks of the goal: it is not met at the start, and it can be met."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.places import KeyPath
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array, Transform
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.scenes.geometry.bodies import Body, Goal
from momantu_worlds.scenes.geometry.convex import Convex, solids_of
from momantu_worlds.scenes.geometry.solids import FLUSH
from momantu_worlds.scenes.geometry.support import SupportTop

SPARSE = 3
"""Every third reachable cell is tested: cells are 2 cm apart."""
RIM_LEAST = 0.045
"""Height from which a hollow thing can be held by its rim, m: fingers that reach 2 cm below the rim
stay 2.5 cm above what it stands on."""
STEP = 0.05
"""Grid step of the item positions that are tested, m."""


FAR = 2.0
"""Distance along x and along y that no arm can reach, m."""


def goals(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """No demand is met at the start; each item can be reached, grasped and set down."""
    several = len(scenario.episode.goals) > 1
    for number, goal in enumerate(scenario.episode.goals):
        yield from _demand(scenario, goal, ("goal", number) if several else ("goal",))


def _demand(scenario: Scenario, goal: Goal, place: KeyPath) -> Iterator[FindingAtKeys]:
    item = scenario.episode.body(goal.item)
    yield from _item(scenario, item)
    if _met(scenario, goal, item):
        yield FindingAtKeys(
            Severity.ERROR,
            "goal-met",
            f"{goal.item} already stands {_where(goal)} at the start",
            "begin with the item elsewhere, or demand less `goal.distance`",
            place,
            about=(),
        )
    spots = _spots(scenario, goal, item)
    if len(spots) == 0:
        yield FindingAtKeys(
            Severity.ERROR,
            "goal-no-room",
            f"there is no free spot for {goal.item} {_where(goal)}",
            "move the tag further in, or make room beside it",
            place,
            about=(),
        )
    elif (far := _farness(scenario, spots)) > scenario.robot.reach[2]:
        yield FindingAtKeys(
            Severity.ERROR,
            "goal-out-of-reach",
            f"every free spot for {goal.item} {_where(goal)} is {_meters(far)} from the floor that "
            f"{scenario.robot.name} can reach; its arm reaches {scenario.robot.reach[2]:g} m",
            "move the tag nearer to the edge",
            place,
            about=(),
            amount=far,
        )


def _where(goal: Goal) -> str:
    """Where the item is to be placed, in words."""
    beside = "" if goal.marker is None else f" within {goal.max_distance:g} m of {goal.marker}"
    return f"on {goal.support}{beside}"


def _item(scenario: Scenario, item: Body) -> Iterator[FindingAtKeys]:
    points = np.concatenate([solid.vertices for solid in scenario.solids[item.name]])
    place, robot = scenario.place(item.name), scenario.robot
    width = _width(points[:, :2])
    if width > robot.max_width and not _has_rim(scenario.solids[item.name], points):
        yield FindingAtKeys(
            Severity.ERROR,
            "item-too-wide",
            f"{item.name} is {100 * width:.1f} cm wide; {robot.name}'s hand opens "
            f"{100 * robot.max_width:.1f} cm",
            "make it narrower, or choose another robot",
            place,
            about=(item.name,),
            amount=width,
        )
    middle = (points.min(axis=0) + points.max(axis=0))[None, :2] / 2
    if (far := _farness(scenario, middle)) > robot.reach[2]:
        yield FindingAtKeys(
            Severity.ERROR,
            "item-out-of-reach",
            f"{item.name} is {_meters(far)} from the floor that {robot.name} can reach; its arm "
            f"reaches {robot.reach[2]:g} m",
            "move it nearer to an edge",
            place,
            about=(item.name,),
            amount=far,
        )


def _has_rim(solids: Sequence[Convex], points: Array) -> bool:
    """Whether a hand can hold it by its rim: it is hollow, open above and high enough.

    points: (n, 3) all vertices of its solids.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    middle[2] = (low[2] + 3 * high[2]) / 4
    solid = any((s.normals @ middle <= s.offsets).all() for s in solids)
    return bool(high[2] - low[2] >= RIM_LEAST and not solid)


def _width(points: Array) -> float:
    """The least extent of points (n, 2) in any of 90 directions."""
    turns = np.arange(90) * (math.pi / 90)
    along = points @ np.stack([np.cos(turns), np.sin(turns)])
    return float((along.max(axis=0) - along.min(axis=0)).min())


def _met(scenario: Scenario, goal: Goal, item: Body) -> bool:
    support = scenario.episode.body(goal.support)
    top, foot = SupportTop(support), _foot(scenario, item)
    beside = 0.0
    if goal.marker is not None:
        marker = scenario.episode.body(goal.marker).map_from_body.position
        beside = math.dist(foot.position[:2], marker[:2])
    return (
        top.margin(support.map_from_body, foot) > 0.0
        and abs(top.height_above(support.map_from_body, foot)) <= FLUSH
        and beside <= goal.max_distance
    )


def _foot(scenario: Scenario, item: Body) -> Transform:
    """Below the middle of the item, at its lowest point."""
    points = np.concatenate([solid.vertices for solid in scenario.solids[item.name]])
    low, high = points.min(axis=0), points.max(axis=0)
    return Transform((*(low + high)[:2] / 2, low[2]))


def _spots(scenario: Scenario, goal: Goal, item: Body) -> Array:
    """Positions (n, 2) in the map where the whole item fits on the support beside the marker.

    Without a marker: anywhere on the support. The positions keep FLUSH from everything.
    """
    map_from_top, size = scenario.surfaces[goal.support]
    top = SupportTop(scenario.episode.body(goal.support)).top
    marker, within = map_from_top.position, math.hypot(*size) / 2
    if goal.marker is not None:
        marker = scenario.episode.body(goal.marker).map_from_body.position
        within = goal.max_distance
    foot = _foot(scenario, item)
    points = np.concatenate([solid.vertices for solid in scenario.solids[item.name]])
    radius = float(np.hypot(*(points[:, :2] - foot.position[:2]).T).max())
    steps = np.arange(-within, within + 1e-9, STEP)
    beside = _beside(scenario, item, marker, within + radius)
    spots = []
    for dx in steps:
        for dy in steps:
            at = (float(marker[0] + dx), float(marker[1] + dy), float(map_from_top.position[2]))
            own = map_from_top.inverse().apply(at)
            inside = top.margin(float(own[0]), float(own[1])) >= radius
            if inside and math.hypot(dx, dy) <= within:
                moved = Transform(np.array(at) - foot.position + (0.0, 0.0, FLUSH))
                if _free(beside, replace(item, map_from_body=moved @ item.map_from_body)):
                    spots.append(at[:2])
    return np.array(spots).reshape(-1, 2)


def _beside(scenario: Scenario, item: Body, marker: Array, radius: float) -> list[Convex]:
    """All solids but the item's own that come within `radius` m of the marker on the floor plan."""
    return [
        solid
        for name, solids in scenario.solids.items()
        if name != item.name
        for solid in solids
        if (solid.box[0][:2] <= marker[:2] + radius).all()
        and (solid.box[1][:2] >= marker[:2] - radius).all()
    ]


def _free(solids: list[Convex], item: Body) -> bool:
    """Whether the item at this pose overlaps none of the solids."""
    return not any(
        own.near(solid, 0.0) and own.depth(solid) > 0.0
        for own in solids_of(item)
        for solid in solids
    )


def _farness(scenario: Scenario, spots: Array) -> float:
    """Distance of the nearest of some spots (n, 2) from the reachable floor, m; inf beyond FAR."""
    stands = scenario.stands_near(spots.mean(axis=0), FAR)[::SPARSE]
    if len(stands) == 0:
        return math.inf
    return min(float(np.hypot(*(stands - spot).T).min()) for spot in spots)


def _meters(far: float) -> str:
    return f"{far:.2f} m" if far < FAR else f"more than {FAR:g} m"
