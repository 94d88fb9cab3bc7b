"""The layout of one episode: all poses, before bodies are made of it."""

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
"""Friction coefficient of painted wood and of most objects on it; tables of values give 0.4 to
0.8."""


@dataclass(frozen=True, slots=True)
class PlacedTable:
    """A surface at its true pose on the floor plan, with the height and extent of its top, m.

    sides: directions in its own frame to stand at, preferred first. above: free height over it, m.
    round: the top is a disc.
    """

    pose: Pose2D
    height: float
    size: tuple[float, float]
    sides: tuple[float, ...] = (0.0,)
    above: float = math.inf
    round: bool = False

    @property
    def map_from_top(self) -> Transform:
        """Frame of the top's surface, z up."""
        return self.pose.transform(self.height)


@dataclass(frozen=True, slots=True)
class PlacedThing:
    """A distractor upright on a table; `at` is in the table's frame."""

    name: str
    thing: Thing
    table: str
    at: Pose2D
    friction: float = FRICTION


@dataclass(frozen=True, slots=True)
class PlacedTag:
    """A tag: flat at `at` in the frame of a table, or upright in the map."""

    name: str
    note: TagNote
    table: str | None
    at: Pose2D


@dataclass(frozen=True, slots=True)
class PlacedPiece:
    """A piece of furniture at its true pose; known: it is on the map, maybe at another pose."""

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

    tables: every surface by name. objects: those named in the file; things: all other loose
    objects. start: the base's true pose. believed_start: the start pose that the robot is given.
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
