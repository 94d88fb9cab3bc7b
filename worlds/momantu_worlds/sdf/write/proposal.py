"""A proposed site of an imported world: surfaces, a start, places, objects to bring.

All of it is guessed from shapes and should be corrected by a person.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.level_tops import Top, proposed_tops
from momantu_worlds.sdf.read.model import Box, Cylinder
from momantu_worlds.sdf.write.free_floor import FreeFloor, free_floor
from momantu_worlds.sdf.write.rooms import rooms

STAND_OFF = 0.6
"""Distance from a top's edge to the centre of a robot that reaches onto it, m."""
ASIDE = 0.25
"""Share of a side's width by which a robot may stand beside its middle."""
COMFORT = 0.8
"""Clearance above which a start pose is not rated better, m."""
GRASPED = 0.09
"""Largest width of a proposed object, m: about the opening of a gripper."""
LIGHT = 2.0
"""Largest mass of a proposed object, kg."""
MOST_PLACES = 12
ROOMY = 0.5
"""Least clearance of a place, m."""
FOOT, TALLEST, WIDEST = 0.3, 2.3, 12.0
"""What names a room begins below the first height and ends between both, m, and is no wider, m2."""


@dataclass(frozen=True, slots=True)
class Surface:
    """A top and the sides to stand at, as angles in its own frame, the best first."""

    top: Top
    sides: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Proposal:
    """surfaces: by name of the body. objects: sizes of what can be brought, by name of the body.

    clear: half the edge of the free square around the start, m.
    """

    start: Pose2D
    clear: float
    surfaces: dict[str, Surface]
    places: dict[str, Pose2D]
    objects: dict[str, dict[str, str | float]]


def propose(bodies: Sequence[ImportedBody], start: Pose2D | None) -> Proposal:
    """The site of some bodies. start: where a robot stood; else a free place is chosen."""
    still = [hull for body in bodies if body.still for hull in body.hulls()]
    loose = [hull for body in bodies if not body.still for hull in body.hulls()]
    floor = free_floor([*still, *loose])
    tops = proposed_tops(bodies)
    sides = {name: _sides(top, floor) for name, top in tops.items()}
    if start is not None and (home := floor.region(start.x, start.y)):
        region = home
    else:
        region = _region(sides.values(), floor)
    surfaces = {}
    for name, ways in sides.items():
        top = tops[name]
        angles = tuple(angle for angle, at in ways if at == region)
        if angles:
            surfaces[name] = Surface(top, angles)
    if start is None:
        start = _start(floor, region, [surface.top for surface in surfaces.values()])
    return Proposal(
        start,
        _clear(floor, start),
        surfaces,
        _places(floor, region, start, bodies),
        {body.name: sizes for body in bodies if (sizes := _sizes(body))},
    )


def propose_places(floor: FreeFloor) -> Proposal:
    """A start and places on the largest region of a floor, where nothing is known but the floor."""
    region = _region((), floor)
    start = _start(floor, region, ())
    return Proposal(start, _clear(floor, start), {}, _places(floor, region, start, ()), {})


def _sides(top: Top, floor: FreeFloor) -> list[tuple[float, int]]:
    """Directions from which a robot can stand at a top, with their regions, the best first."""
    found = []
    for angle, reach in (
        (0.0, top.size[0]),
        (math.pi / 2, top.size[1]),
        (math.pi, top.size[0]),
        (-math.pi / 2, top.size[1]),
    ):
        away, width = reach / 2 + STAND_OFF, top.size[0] + top.size[1] - reach
        spots = []
        for beside in (0.0, -ASIDE * width, ASIDE * width):
            c, s = math.cos(angle), math.sin(angle)
            at = top.pose @ Pose2D(away * c - beside * s, away * s + beside * c)
            region, index = floor.region(at.x, at.y), floor.index(at.x, at.y)
            if region and index is not None and floor.inside[index]:
                spots.append((-round(float(floor.clearance[index]), 2), region))
        if spots:
            # the nearer the middle of the top, the better; then the more room
            room, region = min(spots)
            found.append((round(reach, 3), room, angle, region))
    return [(angle, region) for *_, angle, region in sorted(found)]


def _region(sides: Iterable[list[tuple[float, int]]], floor: FreeFloor) -> int:
    """The region from which most tops can be reached; else the largest."""
    votes = Counter(region for ways in sides for region in sorted({r for _, r in ways}))
    if votes:
        inner = {r: n for r, n in votes.items() if (floor.inside & (floor.regions == r)).any()}
        votes = Counter(inner) or votes
        return min(votes, key=lambda region: (-votes[region], -floor.area(region), region))
    counts = np.bincount(floor.regions[floor.inside], minlength=2)
    counts[0] = 0
    return int(counts.argmax()) if counts.any() else 0


def _start(floor: FreeFloor, region: int, tops: Sequence[Top]) -> Pose2D:
    """A start inside with clearance near the tops, or the region's centre; faces the nearest."""
    inside = (floor.regions == region) & floor.inside
    room = min(float(floor.clearance[inside].max(initial=0.0)), COMFORT)
    points = floor.points(inside & (floor.clearance >= room - floor.cell / 2))
    if not len(points):
        return Pose2D(0.0, 0.0)
    goals = np.array([(top.pose.x, top.pose.y) for top in tops] or [points.mean(axis=0)])
    away = sum(np.hypot(points[:, 0] - x, points[:, 1] - y) for x, y in goals)
    x, y = (float(v) for v in points[int(np.argmin(away))])
    nearest = goals[int(np.argmin(np.hypot(goals[:, 0] - x, goals[:, 1] - y)))]
    yaw = math.atan2(nearest[1] - y, nearest[0] - x) if tops else 0.0
    return Pose2D(x, y, yaw)


def _clear(floor: FreeFloor, start: Pose2D) -> float:
    """Half the edge of a square around the start that is certainly free, m."""
    index = floor.index(start.x, start.y)
    free = COMFORT if index is None else float(floor.clearance[index]) - floor.cell
    return max(min(free, COMFORT) / math.sqrt(2.0), 0.05)


def _places(
    floor: FreeFloor, region: int, start: Pose2D, bodies: Sequence[ImportedBody]
) -> dict[str, Pose2D]:
    """The start as home, and a roomy reachable point of every other room, by what stands there."""
    places, taken = {"home": start}, {body.name for body in bodies}
    room_of, reach = rooms(floor), floor.regions == region
    things = list(_things(bodies))
    index = floor.index(start.x, start.y)
    own = 0 if index is None else int(room_of[index])
    order = np.argsort(-np.bincount(room_of.reshape(-1)), kind="stable").tolist()
    for room in order:
        if room in (0, own) or len(places) > MOST_PLACES:
            continue
        points = floor.points(reach & (room_of == room) & (floor.clearance > ROOMY))
        if not len(points):
            continue
        rows, columns = ((points - floor.origin) / floor.cell).astype(int).T[::-1]
        free = np.minimum(floor.clearance[rows, columns], COMFORT)
        middle = floor.points(room_of == room).mean(axis=0)
        away = np.hypot(*(points - middle).T)
        x, y = points[int(np.lexsort((away, -free.round(2)))[0])].tolist()
        beside = next((name for name, at in things if _room_at(floor, room_of, at) == room), "")
        stem = f"near_{beside}" if beside else f"room_{len(places)}"
        name, count = stem, 2
        while name in taken or name in places:
            name, count = f"{stem}_{count}", count + 1
        places[name] = Pose2D(x, y)
    return places


def _room_at(floor: FreeFloor, room_of: NDArray[np.int32], at: Array) -> int:
    index = floor.index(float(at[0]), float(at[1]))
    return 0 if index is None else int(room_of[index])


def _things(bodies: Sequence[ImportedBody]) -> Iterator[tuple[str, Array]]:
    """Plain names of furniture and the middle (2,) of each, the widest first."""
    found = []
    for body in bodies:
        hulls = list(body.hulls())
        if not hulls:
            continue
        points = np.concatenate(hulls)
        low, high = points.min(axis=0), points.max(axis=0)
        area = float((high - low)[:2].prod())
        if low[2] < FOOT and FOOT < high[2] < TALLEST and area < WIDEST:
            found.append((-area, body.name, (low + high)[:2] / 2))
    for _, name, middle in sorted(found, key=lambda entry: entry[:2]):
        yield re.sub(r"(_\d+)+$", "", name), middle


def _sizes(body: ImportedBody) -> dict[str, str | float] | None:
    """What the robot is told about a loose object that one hand can hold."""
    touched = [part.solid for part in body.parts if part.collision]
    if body.still or len(touched) != 1 or (body.mass or 0.0) > LIGHT:
        return None
    solid = touched[0]
    if isinstance(solid, Cylinder) and 2 * solid.radius <= GRASPED:
        return {"category": "can", "diameter": 2 * solid.radius, "height": solid.length}
    if isinstance(solid, Box) and min(solid.size[:2]) <= GRASPED:
        x, y, z = solid.size
        return {"category": "box", "width": x, "depth": y, "height": z}
    return None
