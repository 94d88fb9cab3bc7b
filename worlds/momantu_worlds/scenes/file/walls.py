"""Walls from rooms: a wall shared by several rooms is built once, and doors are cut into it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.file.building import Door, Doorway, Room, Walls
from momantu_worlds.scenes.geometry.plane import Rectangle

SAME_LINE, SAME_TURN = 0.005, 1e-3
"""Tolerances within which edges of two rooms are one wall, m and rad."""
BUCKET, BUCKET_TURN = 0.5, 0.01
"""Steps in which lines are sorted, m and rad. Far from the origin a small turn changes a line's
offset: together with `SAME_LINE` by less than one step up to 500 m away."""
ON_WALL = 0.05
"""Largest distance of a door's point from the faces of its wall, m."""
LEAF = 0.04
"""m; thickness of a closed door."""
LINTEL = 0.02
"""A wall above a door that is lower than this is left out, m."""


@dataclass(frozen=True, slots=True)
class WallRun:
    """A straight piece of wall. name: of its body. pose: of its centre, x along it. m."""

    name: str
    pose: Pose2D
    length: float
    thickness: float
    bottom: float
    top: float

    @property
    def base(self) -> Rectangle:
        """The floor area under it."""
        return Rectangle(self.pose, (self.length, self.thickness))


def given_runs(walls: Walls) -> Iterator[WallRun]:
    """The walls that the file gives one by one."""
    for piece in walls.pieces:
        pose = walls.map_from_piece(piece)
        name = f"wall_{piece.name}"
        yield WallRun(name, pose, piece.length, walls.thickness, 0.0, walls.height)


@dataclass(slots=True)
class _Line:
    """Edges on one straight line: its direction (0 to pi), its offset, and its segments."""

    angle: float
    offset: float
    stretches: list[tuple[float, float, str]] = field(default_factory=list)

    def along(self, point: tuple[float, float]) -> float:
        return point[0] * math.cos(self.angle) + point[1] * math.sin(self.angle)

    def across(self, point: tuple[float, float]) -> float:
        return point[1] * math.cos(self.angle) - point[0] * math.sin(self.angle) - self.offset

    def pose(self, at: float) -> Pose2D:
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        return Pose2D(at * cos - self.offset * sin, at * sin + self.offset * cos, self.angle)


@dataclass(slots=True)
class _Wall:
    """One segment of a line, from `start` to `end` along it, and the doors in it."""

    name: str
    line: _Line
    start: float
    end: float
    doors: dict[str, Door] = field(default_factory=dict)


class RoomWalls:
    """The walls of all rooms. problems: of doors, by name, in words."""

    def __init__(self, walls: Walls, rooms: Mapping[str, Room], doors: Mapping[str, Door]) -> None:
        self._shared = walls
        self._walls = list(_walls(rooms))
        self.problems: dict[str, str] = {}
        for name, door in doors.items():
            problem = self._hang(name, door)
            if problem is not None:
                self.problems[name] = problem

    def runs(self) -> Iterator[WallRun]:
        """Solid pieces of wall: between doors, and above them."""
        half, top = self._shared.thickness / 2, self._shared.height
        for wall in self._walls:
            cuts = sorted(
                (wall.line.along(d.at) - d.width / 2, wall.line.along(d.at) + d.width / 2, d.height)
                for d in wall.doors.values()
            )
            edges = [wall.start - half, *(e for cut in cuts for e in cut[:2]), wall.end + half]
            solid = [(a, b, 0.0) for a, b in list(pairwise(edges))[::2]]
            solid += [(a, b, height) for a, b, height in cuts if height < top - LINTEL]
            for number, (a, b, bottom) in enumerate(solid, 1):
                name = wall.name if len(solid) == 1 else f"{wall.name}_{number}"
                pose = wall.line.pose((a + b) / 2)
                yield WallRun(name, pose, b - a, self._shared.thickness, bottom, top)

    def leaves(self) -> Iterator[tuple[str, Door, Pose2D]]:
        """Closed doors: name, door, and the pose of its leaf's centre, x along it."""
        for name, door, pose in self._hung():
            if door.closed:
                yield name, door, pose

    def doorways(self) -> dict[str, Doorway]:
        """Open doors as gaps to drive through, in the order of the file."""
        return {
            name: Doorway(at=(pose.x, pose.y), clear=door.clear)
            for name, door, pose in self._hung()
            if not door.closed
        }

    def thresholds(self) -> Iterator[Rectangle]:
        """The floor in open doors, as deep as the wall."""
        for _, door, pose in self._hung():
            if not door.closed:
                yield Rectangle(pose, (door.width, self._shared.thickness))

    def _hung(self) -> Iterator[tuple[str, Door, Pose2D]]:
        for wall in self._walls:
            for name, door in wall.doors.items():
                yield name, door, wall.line.pose(wall.line.along(door.at))

    def _hang(self, name: str, door: Door) -> str | None:
        """Put a door into its wall; returns the reason if that is not possible."""
        near = [(abs(w.line.across(door.at)), w) for w in self._walls if _beside(w, door)]
        if not near:
            return "no wall of a room is there; `at` is a point on the line between two corners"
        away, wall = min(near, key=lambda pair: pair[0])
        if away > self._shared.thickness / 2 + ON_WALL:
            return f"no wall of a room is there; the nearest, {wall.name}, is {away:.2f} m away"
        middle = wall.line.along(door.at)
        if middle - door.width / 2 < wall.start or middle + door.width / 2 > wall.end:
            ends = f"{middle - wall.start:.2f} m and {wall.end - middle:.2f} m"
            return f"a door {door.width:g} m wide does not fit: its wall ends {ends} beside it"
        for other, hung in wall.doors.items():
            apart = abs(wall.line.along(hung.at) - middle)
            if apart < (door.width + hung.width) / 2:
                return f"overlaps with the door {other!r}: {apart:.2f} m from its middle"
        if door.height > self._shared.height:
            return f"is {door.height:g} m high, but the walls are {self._shared.height:g} m"
        wall.doors[name] = door
        return None


def _beside(wall: _Wall, door: Door) -> bool:
    return wall.start <= wall.line.along(door.at) <= wall.end


def _walls(rooms: Mapping[str, Room]) -> Iterator[_Wall]:
    lines = _Lines()
    for name, room in rooms.items():
        for a, b in pairwise((*room.corners, room.corners[0])):
            line = lines.through(a, b)
            start, end = sorted((line.along(a), line.along(b)))
            line.stretches.append((start, end, name))
    counts: dict[str, int] = {}
    for line in lines.found:
        for start, end, room_name in _joined(line.stretches):
            counts[room_name] = number = counts.get(room_name, 0) + 1
            yield _Wall(f"wall_{room_name}_{number}", line, start, end)


class _Lines:
    """The lines of all edges, each once, in the order of their first use."""

    def __init__(self) -> None:
        self.found: list[_Line] = []
        self._alike: dict[tuple[int, int], list[_Line]] = {}

    def through(self, a: tuple[float, float], b: tuple[float, float]) -> _Line:
        """The line through two points: an existing one, or a new one."""
        angle = math.atan2(b[1] - a[1], b[0] - a[0]) % math.pi
        if angle > math.pi - SAME_TURN:
            angle = 0.0
        offset = a[1] * math.cos(angle) - a[0] * math.sin(angle)
        turn, away = round(angle / BUCKET_TURN), round(offset / BUCKET)
        near = ((turn + i, away + j) for i in (0, -1, 1) for j in (0, -1, 1))
        for line in (line for key in near for line in self._alike.get(key, ())):
            on = abs(line.across(a)) <= SAME_LINE and abs(line.across(b)) <= SAME_LINE
            if on and abs(line.angle - angle) <= SAME_TURN:
                return line
        fresh = _Line(angle, offset)
        self.found.append(fresh)
        self._alike.setdefault((turn, away), []).append(fresh)
        return fresh


def _joined(stretches: list[tuple[float, float, str]]) -> Iterator[tuple[float, float, str]]:
    """Merge segments that touch or overlap, named after the room that comes first in the file."""
    order = {name: i for i, (_, _, name) in enumerate(stretches)}
    start, end, first = math.inf, -math.inf, ""
    for a, b, name in sorted(stretches):
        if first and a <= end + SAME_LINE:
            end = max(end, b)
            first = min(first, name, key=order.__getitem__)
            continue
        if first:
            yield start, end, first
        start, end, first = a, b, name
    if first:
        yield start, end, first
