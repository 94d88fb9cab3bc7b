"""The layout of one episode: where everything stands, before bodies are made of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.scenes.catalogue.objects import Thing
from momantu_worlds.scenes.file.furniture import Piece
from momantu_worlds.scenes.file.objects import TagNote
from momantu_worlds.scenes.geometry.bodies import Color, PointLight, SunLight

FRICTION = 0.6
"""Friction of painted wood and of most things on it; tables of physics give 0.4 to 0.8."""


@dataclass(frozen=True, slots=True)
class PlacedTable:
    """A surface as it truly is: on the floor plan, with the height and extent of its top, m.

    sides: directions in its own frame to stand at, preferred first. above: free height over it, m.
    """

    pose: Pose2D
    height: float
    size: tuple[float, float]
    sides: tuple[float, ...] = (0.0,)
    above: float = math.inf

    @property
    def map_from_top(self) -> Transform:
        """Frame of the top's surface, z up."""
        return self.pose.transform(self.height)


@dataclass(frozen=True, slots=True)
class PlacedThing:
    """A loose thing upright on a table; `at` is in the table's own frame."""

    name: str
    thing: Thing
    table: str
    at: Pose2D
    friction: float = FRICTION


@dataclass(frozen=True, slots=True)
class PlacedTag:
    """A tag: lying at `at` in the frame of a table, or hung in the map."""

    name: str
    note: TagNote
    table: str | None
    at: Pose2D


@dataclass(frozen=True, slots=True)
class PlacedPiece:
    """A piece of furniture as it truly stands; known: it is somewhere on the map."""

    name: str
    piece: Piece
    pose: Pose2D
    known: bool


@dataclass(frozen=True, slots=True)
class Lighting:
    """Light of one episode."""

    ambient: Color
    suns: tuple[SunLight, ...]
    lamps: tuple[PointLight, ...]


@dataclass(frozen=True, slots=True)
class Layout:
    """One episode's arrangement.

    tables: every surface by name. objects: what the file names; things: what else is loose.
    start: where the base truly stands. believed_start: what the robot is told.
    """

    seed: int
    tables: Mapping[str, PlacedTable]
    objects: tuple[PlacedThing, ...]
    tags: tuple[PlacedTag, ...]
    things: tuple[PlacedThing, ...]
    pieces: tuple[PlacedPiece, ...]
    start: Pose2D
    believed_start: Pose2D
    light: Lighting

    def object(self, name: str) -> PlacedThing:
        """One of the objects; KeyError if there is none of that name."""
        return {placed.name: placed for placed in self.objects}[name]

    def tag(self, name: str) -> PlacedTag:
        """One of the tags; KeyError if there is none of that name."""
        return {placed.name: placed for placed in self.tags}[name]
