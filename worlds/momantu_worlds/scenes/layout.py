"""Where everything stands in one episode: what `reset` decides, before bodies are made of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.scenes.bodies import Color, PointLight, SunLight
from momantu_worlds.scenes.objects import Thing
from momantu_worlds.scenes.world_file import Piece


@dataclass(frozen=True, slots=True)
class PlacedTable:
    """A table as it truly stands: on the floor plan, with the height and extent of its top, m."""

    pose: Pose2D
    height: float
    size: tuple[float, float]

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
    sun: SunLight
    lamps: tuple[PointLight, ...]


@dataclass(frozen=True, slots=True)
class Layout:
    """One episode's arrangement. item_at and tag_at are in their tables' own frames.

    start: where the base truly stands. believed_start: what the robot is told.
    """

    seed: int
    tables: Mapping[str, PlacedTable]
    item_at: Pose2D
    tag_at: Pose2D
    things: tuple[PlacedThing, ...]
    pieces: tuple[PlacedPiece, ...]
    start: Pose2D
    believed_start: Pose2D
    light: Lighting
