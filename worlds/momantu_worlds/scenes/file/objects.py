"""Objects and tags of a world file."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Angle, Mass, Size
from momantu_worlds.scenes.catalogue.objects import OBJECT_KINDS, ObjectKind
from momantu_worlds.scenes.catalogue.tag36h11 import CODES
from momantu_worlds.scenes.file.values import (
    Friction,
    Name,
    NotNegative,
    Part,
    Point,
    Pose3D,
    Rgb,
    Size3D,
    Turn,
)

GRIP = 0.6
"""Default friction coefficient of an object: painted metal or plastic on wood."""


class ObjectNote(Part):
    """A loose object on a table or board. Omitted values are drawn from the seed.

    on: one surface, or several of which an episode takes one. at: position on it, in its own frame;
    anywhere on it if omitted. size: of a box; radius and height: of all round kinds. color: the
    object has the usual paint of its kind in this colour, not one of many patterns.
    """

    kind: ObjectKind
    on: Name | Annotated[tuple[Name, ...], Field(min_length=1, max_length=50)]
    at: Point | None = None
    yaw: Angle = 0.0
    shift: NotNegative = 0.0
    turn: Turn = math.pi
    radius: Size | None = None
    height: Size | None = None
    size: Size3D | None = None
    mass: Mass | None = None
    friction: Friction = GRIP
    color: Rgb | None = None

    @model_validator(mode="after")
    def _sizes(self) -> Self:
        box = self.kind == "box"
        if box and (self.radius is not None or self.height is not None):
            raise ValueError("a box has a size, no radius and height")
        if not box and self.size is not None:
            raise ValueError(f"a {self.kind} has a radius and a height, no size")
        if (self.radius is None) != (self.height is None):
            raise ValueError("write both radius and height, or neither")
        return self

    @property
    def tops(self) -> tuple[str, ...]:
        """Surfaces that it may stand on."""
        return (self.on,) if isinstance(self.on, str) else self.on

    @property
    def extent(self) -> tuple[float, float, float] | None:
        """Its edges, or twice the radius, and the height, m; None if an episode draws them."""
        if self.size is not None:
            return self.size
        if self.radius is None or self.height is None:
            return None
        return 2 * self.radius, 2 * self.radius, self.height


class Item(ObjectNote):
    """The object to bring, unless the goal names another one."""

    name: Name


class TagNote(Part):
    """An AprilTag of the family 36h11; edge: of its black square, m.

    Flat on a surface (`on`, `at`), or upright (`hung`: x, y, z of its centre in the map, and the
    direction that its front faces).
    """

    id: Annotated[int, Field(ge=0, lt=len(CODES))]
    edge: Size
    on: Name | None = None
    at: Point | None = None
    hung: Pose3D | None = None
    shift: NotNegative = 0.0
    yaw: Angle = 0.0
    turn: Turn = math.pi

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        lying = self.on is not None and self.at is not None
        half = (self.on is None) != (self.at is None)
        if half or lying == (self.hung is not None):
            raise ValueError("write on and at, or hung")
        if self.hung is not None and self.model_fields_set & {"shift", "yaw", "turn"}:
            raise ValueError("a tag that is hung has no shift, yaw and turn")
        return self


class Tag(TagNote):
    """The tag next to which the item is to be placed."""

    name: Name


class Distractors(Part):
    """Random objects on the tables, 0 to `most` on each. Gaps are measured between surfaces.

    on: the tables that they may stand on; all if omitted. patterns: paint each kind in many
    patterns, not in one.
    """

    most: Annotated[int, Field(ge=0, le=8)]
    gap: Size = 0.03
    gap_to_item: Size = 0.1
    kinds: Annotated[tuple[ObjectKind, ...], Field(min_length=1)] = OBJECT_KINDS
    on: tuple[Name, ...] | None = None
    patterns: bool = False
