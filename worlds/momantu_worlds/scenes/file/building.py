"""The building of a world file: floor, walls, rooms, doors."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Angle, Size
from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.file.values import Friction, Name, Part, Point, Rgb

DOOR_HEIGHT = 2.0
"""Default height of doors, m, as many building codes require."""
DOOR_CLEAR = 0.9
"""Radius around a doorway's centre, m, without furniture that is not on the map."""
MOST_ROOMS, MOST_DOORS, MOST_WALLS = 100, 200, 1000
MOST_CORNERS = 60
MOST_FLOOR = 500.0
"""Largest edge of the floor, m; path search on a larger floor would take too long."""


class Floor(Part):
    """The floor. Without center and size: under all walls and bodies."""

    center: Point | None = None
    size: tuple[Size, Size] | None = None
    color: Rgb = (0.63, 0.61, 0.57)
    friction: Friction = 0.8

    @model_validator(mode="after")
    def _both(self) -> Self:
        if (self.center is None) != (self.size is None):
            raise ValueError("write both center and size, or neither")
        if self.size is not None and max(self.size) > MOST_FLOOR:
            raise ValueError(f"the floor is at most {MOST_FLOOR:g} m wide")
        return self


class WallPiece(Part):
    """One straight wall by the centre of its axis; yaw of its length."""

    name: Name
    length: Size
    center: Point
    yaw: Angle


class Walls(Part):
    """Values for all walls, and single walls in a frame with its origin at `origin`."""

    origin: Point = (0.0, 0.0)
    thickness: Size = 0.12
    height: Size = 2.5
    color: Rgb = (0.86, 0.85, 0.81)
    pieces: Annotated[tuple[WallPiece, ...], Field(max_length=MOST_WALLS)] = ()

    def map_from_piece(self, piece: WallPiece) -> Pose2D:
        """Pose of a wall's centre in the map, x along its length."""
        return Pose2D(piece.center[0] + self.origin[0], piece.center[1] + self.origin[1], piece.yaw)


class Room(Part):
    """A room by its outline along the centre lines of its walls.

    Either `corner` (the one with the smallest x and y) and `size`, or `outline`: its corners in
    order.
    """

    corner: Point | None = None
    size: tuple[Size, Size] | None = None
    outline: Annotated[tuple[Point, ...], Field(min_length=3, max_length=MOST_CORNERS)] | None = (
        None
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        rectangle = self.corner is not None and self.size is not None
        half = (self.corner is None) != (self.size is None)
        if half or rectangle == (self.outline is not None):
            raise ValueError("write corner and size, or an outline")
        if any(a == b for a, b in pairwise((*self.corners, self.corners[0]))):
            raise ValueError("two corners of the outline in turn are the same")
        return self

    @property
    def corners(self) -> tuple[Point, ...]:
        """The corners of its outline in order, m."""
        if self.outline is not None:
            return self.outline
        assert self.corner is not None
        assert self.size is not None
        (x, y), (along_x, along_y) = self.corner, self.size
        return (x, y), (x + along_x, y), (x + along_x, y + along_y), (x, y + along_y)


class Door(Part):
    """A gap in a wall of a room, at a point of that wall. closed: a door leaf fills it."""

    at: Point
    width: Size = 0.9
    height: Size = DOOR_HEIGHT
    closed: bool = False
    clear: Size = DOOR_CLEAR
    color: Rgb = (0.72, 0.60, 0.45)


class Doorway(Part):
    """A gap to drive through: its centre, and the radius around it that is kept free."""

    at: Point
    clear: Size
