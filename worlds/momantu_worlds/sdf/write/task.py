"""What is to be brought in an imported world: the item, a tag beside which it goes, the goal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from momantu_bt.errors import InputError
from momantu_bt.formats.names import valid_names
from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.level_tops import Top
from momantu_worlds.sdf.body.parts import MeshPart, hull_of
from momantu_worlds.sdf.write.proposal import Surface

ITEM_MASS = 0.4
"""Mass of an item that was static, kg."""
FROM_EDGE = 0.2
"""Distance of what is put down from the edge where the robot stands, m."""
SMALL = 0.4
"""Longest edge of a thing that is offered for bringing, m."""
STANDS = 0.02
"""Height above a top up to which something stands on it, m."""
EDGE = 0.15
"""Edge of a tag's black square, m."""
BLACK = 0.8
"""Edge of a tag's black square, of that of its picture: one cell of ten on each side is white."""
TAG = "tag"
ROUND = 0.1
"""Largest share by which the sides of a round thing differ."""
_NAMED_TAG = re.compile(r"april_?tag|tag_?36_?h?_?11")


@dataclass(frozen=True, slots=True)
class Wanted:
    """Names as they were given: the thing to bring, surfaces; empty: not said."""

    bring: str = ""
    start: str = ""
    goal: str = ""
    tag: str = ""


@dataclass(frozen=True, slots=True)
class TagNote:
    """A tag to write: its id, edge (m), surface, and place (x, y, yaw) in the surface's frame."""

    id: int
    edge: float
    on: str
    at: Pose2D


@dataclass(frozen=True, slots=True)
class Task:
    """item, on: names of bodies, empty if nothing is brought. sizes: what the robot is told."""

    item: str = ""
    start: str = ""
    on: str = ""
    sizes: dict[str, str | float] | None = None
    tag: TagNote | None = None


def with_task(
    bodies: Sequence[ImportedBody], surfaces: dict[str, Surface], wanted: Wanted
) -> tuple[list[ImportedBody], Task]:
    """The bodies as the task needs them, and the task.

    Raises:
        InputError: there is no such thing or surface, or only one of both surfaces is said.
    """
    found, task = list(bodies), Task()
    if wanted.bring:
        for option, name in (("--from", wanted.start), ("--to", wanted.goal)):
            if not name:
                known = valid_names("", surfaces, "surfaces")
                raise InputError(f"--bring {wanted.bring} needs {option} SURFACE; {known}")
        start = _surface(surfaces, "--from", wanted.start)
        on = _surface(surfaces, "--to", wanted.goal)
        item = _thing(bodies, wanted.bring, surfaces)
        placed = _based(_on_top(_as_item(item), surfaces[start], bodies))
        sizes = sizes_of(placed)
        placed = replace(placed, category=str(sizes["category"]))
        found = [placed if body is item else body for body in bodies]
        task = Task(item.name, start, on, sizes)
    for option, name in (("--from", wanted.start), ("--to", wanted.goal)):
        if name and not wanted.bring:
            raise InputError(f"{option} needs --bring MODEL, the thing to bring")
    if wanted.tag or wanted.bring:
        on = _surface(surfaces, "--tag", wanted.tag or wanted.goal)
        found, tag = _tag(found, on, surfaces[on])
        task = replace(task, tag=tag)
    return found, task


def _surface(surfaces: dict[str, Surface], option: str, name: str) -> str:
    if name not in surfaces:
        known = valid_names(name, surfaces, "surfaces")
        raise InputError(f"{option} {name}: there is no such surface; {known}")
    return name


def _thing(bodies: Sequence[ImportedBody], name: str, surfaces: dict[str, Surface]) -> ImportedBody:
    found = next((body for body in bodies if name in (body.name, body.title)), None)
    others = [body for body in bodies if body.name not in surfaces and _touched(body)]
    names = [body.name for body in others if np.ptp(_all(body), axis=0).max() < SMALL]
    if found is None or found.name in surfaces:
        known = valid_names(name, names, "small things")
        raise InputError(f"--bring {name}: there is no such thing; {known}")
    if not _touched(found):
        raise InputError(f"--bring {name}: it cannot be touched; choose another thing")
    return found


def _touched(body: ImportedBody) -> bool:
    return any(part.hulls for part in body.parts)


def _as_item(body: ImportedBody) -> ImportedBody:
    """A body that can be carried, with its mesh and its colours."""
    return replace(body, still=False, mass=body.mass or ITEM_MASS)


def sizes_of(body: ImportedBody) -> dict[str, str | float]:
    """What the robot is told about a thing in an upright frame: round or a box, and its size, m."""
    points = np.concatenate([p.body_from_part.apply(h) for p in body.parts for h in p.hulls])
    width, depth, height = (round(float(v), 3) for v in np.ptp(points, axis=0))
    around = np.unique(np.round(points[:, :2], 3), axis=0)
    if abs(width - depth) < ROUND * max(width, depth) and len(around) > len(range(8)):
        return {"category": "can", "diameter": max(width, depth), "height": height}
    return {"category": "box", "width": width, "depth": depth, "height": height}


def _all(body: ImportedBody) -> Array:
    """Points (n, 3) of a body in the map."""
    found = [*body.hulls()]
    for part in body.parts:
        if not part.hulls and not isinstance(part.solid, MeshPart):
            found.append(body.at.apply(part.body_from_part.apply(hull_of(part.solid))))
        elif part.seen is not None:
            found.append(body.at.apply(part.body_from_part.apply(part.seen)))
    return np.concatenate(found) if found else np.asarray(body.at.position)[None]


def _within(top: Top, points: Array) -> bool:
    """Whether the middle of something is over a top, and its bottom on it."""
    low, high = points.min(axis=0), points.max(axis=0)
    own = top.pose.inverse() @ Pose2D(*((low + high)[:2] / 2).tolist())
    inside = abs(own.x) < top.size[0] / 2 and abs(own.y) < top.size[1] / 2
    return inside and abs(float(low[2]) - top.height) < STANDS


def _on_top(item: ImportedBody, surface: Surface, bodies: Sequence[ImportedBody]) -> ImportedBody:
    """The item on a surface: where it stands, or at a free spot near where the robot stands."""
    top, points = surface.top, np.concatenate(list(item.hulls()))
    low, high = points.min(axis=0), points.max(axis=0)
    if _within(top, points):
        return item.lifted(top.height - float(low[2]))
    taken = [_all(body) for body in bodies if body.name != item.name]
    x, y = _free_spot(top, surface.sides[0], [p for p in taken if _within(top, p)])
    middle = (low + high) / 2
    step = (x - float(middle[0]), y - float(middle[1]), top.height - float(low[2]))
    return replace(item, at=Transform(step) @ item.at)


def _based(item: ImportedBody) -> ImportedBody:
    """The item with its frame upright in the middle of its base, as the referee judges objects."""
    points = np.concatenate(list(item.hulls()))
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = ((low + high)[:2] / 2).tolist()
    at = Transform((0.0, 0.0, float(low[2]))) @ Pose2D(x, y, item.at.yaw).transform()
    step = at.inverse() @ item.at
    parts = tuple(replace(p, body_from_part=step @ p.body_from_part) for p in item.parts)
    return replace(item, at=at, parts=parts)


def _free_spot(top: Top, side: float, taken: Sequence[Array]) -> tuple[float, float]:
    """A point in the map on a top, near the edge of a side, and far from other things."""
    cos, sin = np.cos(side), np.sin(side)
    along_x = abs(cos) > abs(sin)
    half, width = (top.size[0] / 2, top.size[1]) if along_x else (top.size[1] / 2, top.size[0])
    out = max(half - FROM_EDGE, 0.0)
    spots = []
    for share in (0.0, 0.25, -0.25, 0.125, -0.125):
        at = top.pose @ Pose2D(out * cos - share * width * sin, out * sin + share * width * cos)
        room = min(
            (float(np.hypot(*(p[:, :2] - (at.x, at.y)).T).min()) for p in taken), default=9.0
        )
        spots.append((-min(room, FROM_EDGE), abs(share), at.x, at.y))
    return min(spots)[2:]


def _tag(
    bodies: Sequence[ImportedBody], on: str, surface: Surface
) -> tuple[list[ImportedBody], TagNote]:
    """The bodies without the picture of a tag on a surface, and a tag in its or in a new place."""
    top = surface.top
    for body in bodies:
        points = _all(body)
        if _NAMED_TAG.search(f"{body.title} {body.name}".lower()) and _within(top, points):
            number = re.findall(r"\d+", body.name)
            low, high = points.min(axis=0), points.max(axis=0)
            x, y = ((low + high)[:2] / 2).tolist()
            own = top.pose.inverse() @ Pose2D(x, y, body.at.yaw)
            sides = np.sort(np.ptp(body.at.inverse().apply(points), axis=0))
            edge = BLACK * float(sides[1])
            note = TagNote(int(number[-1]) if number else 1, edge, on, own)
            return [other for other in bodies if other is not body], note
    taken = [p for p in map(_all, bodies) if _within(top, p)]
    x, y = _free_spot(top, surface.sides[0], taken)
    own = top.pose.inverse() @ Pose2D(x, y, top.pose.yaw)
    return list(bodies), TagNote(1, min(EDGE, 0.4 * min(top.size)), on, own)
