"""Objects and tags of a world file."""

from __future__ import annotations

import math
from typing import Annotated, Self, TypeAlias

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Angle, Mass, Size
from momantu_bt.geometry import Transform
from momantu_bt.tags import USUAL_FAMILY, TagFamily, TagPlate
from momantu_worlds.scenes.catalogue.objects import LYING_KINDS, OBJECT_KINDS, ObjectKind
from momantu_worlds.scenes.catalogue.tags import MOST_IDS, known_ids, picture_edge
from momantu_worlds.scenes.file.furniture import MeshUse
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
    transform,
)

GRIP = 0.6
"""Default friction coefficient of an object: painted metal or plastic on wood."""


class ObjectNote(Part):
    """A loose object on a table or board. Omitted values are drawn from the seed.

    on: one surface, or several of which an episode takes one. at: position on it, in its own frame;
    anywhere on it if omitted. size: of a box; radius and height: of all round kinds. mesh: it is
    this mesh, and counts as one of its kind. color: the object has the usual paint of its kind in
    this colour, not one of many patterns. lying: it lies on its side; `yaw` is the direction from
    its bottom to its top then.
    """

    kind: ObjectKind
    mesh: MeshUse | None = None
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
    lying: bool = False

    @model_validator(mode="after")
    def _lies(self) -> Self:
        if self.lying and self.kind not in LYING_KINDS:
            raise ValueError(
                f"a {self.kind} does not lie here; lying things: {', '.join(LYING_KINDS)}"
            )
        return self

    @model_validator(mode="after")
    def _sizes(self) -> Self:
        if self.mesh is not None:
            self._of_mesh(self.mesh)
            return self
        box = self.kind == "box"
        if box and (self.radius is not None or self.height is not None):
            raise ValueError("a box has a size, no radius and height")
        if not box and self.size is not None:
            raise ValueError(f"a {self.kind} has a radius and a height, no size")
        if (self.radius is None) != (self.height is None):
            raise ValueError("write both radius and height, or neither")
        return self

    def _of_mesh(self, mesh: MeshUse) -> None:
        if any(size is not None for size in (self.radius, self.height, self.size)):
            raise ValueError("a mesh has its own sizes; scale it by mesh.scale or mesh.size")
        if self.lying:
            raise ValueError("a mesh does not lie here; turn it in its file, and let it stand so")
        if mesh.collision == "none":
            raise ValueError("a mesh that nothing touches cannot stand; leave out mesh.collision")

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


TagId: TypeAlias = Annotated[int, Field(ge=0, lt=MOST_IDS)]
MOST_PLATES = 400
"""Most tags of a bundle."""


class TagGrid(Part):
    """Tags in rows, their ids counted from `first` at the lower left, row by row upwards.

    gap: between two tags, m.
    """

    columns: Annotated[int, Field(ge=1, le=20)]
    rows: Annotated[int, Field(ge=1, le=20)]
    gap: Size
    first: TagId = 0


class PlateNote(Part):
    """One tag of a bundle. edge: if it differs from the bundle's, m.

    at: in the bundle's frame, whose x points right, y up and z out of the print.
    """

    id: TagId
    at: Pose3D
    edge: Size | None = None


class TagNote(Part):
    """An AprilTag, or several that are fixed to each other; edge: of a tag, m.

    One tag (`id`), a grid of them (`grid`) or any (`bundle`). Flat on a surface (`on`, `at`), or
    upright (`hung`: x, y, z of its centre in the map, and the direction that its front faces).
    """

    family: TagFamily = USUAL_FAMILY
    id: TagId | None = None
    grid: TagGrid | None = None
    bundle: Annotated[tuple[PlateNote, ...], Field(min_length=1, max_length=MOST_PLATES)] | None = (
        None
    )
    edge: Size
    on: Name | None = None
    at: Point | None = None
    hung: Pose3D | None = None
    shift: NotNegative = 0.0
    yaw: Angle = 0.0
    turn: Turn = math.pi

    @model_validator(mode="after")
    def _known_ids(self) -> Self:
        if sum(each is not None for each in (self.id, self.grid, self.bundle)) != 1:
            raise ValueError("write one of id, grid and bundle")
        most = known_ids(self.family) - 1
        ids = [plate.tag_id for plate in self.plates]
        wrong = [each for each in ids if each > most]
        if wrong:
            raise ValueError(f"id {wrong[0]}: the ids of {self.family} go from 0 to {most} here")
        paper = picture_edge(self.edge, self.family)
        if self.grid is not None and self.grid.gap < paper - self.edge - 1e-9:
            raise ValueError(
                f"the tags would overlap: with what belongs around it a tag is {paper:g} m wide; "
                f"make the gap {paper - self.edge:g} m or more"
            )
        if len(set(ids)) < len(ids):
            twice = next(each for each in ids if ids.count(each) > 1)
            raise ValueError(f"the id {twice} is there twice; a bundle has each id once")
        return self

    @property
    def plates(self) -> tuple[TagPlate, ...]:
        """Its tags, in the frame of the middle of all."""
        if self.bundle is not None:
            return tuple(
                TagPlate(each.id, each.edge or self.edge, transform(each.at))
                for each in self.bundle
            )
        if self.grid is None:
            return (TagPlate(self.id or 0, self.edge),)
        columns, rows, step = self.grid.columns, self.grid.rows, self.edge + self.grid.gap
        return tuple(
            TagPlate(
                self.grid.first + row * columns + column,
                self.edge,
                Transform(((column - (columns - 1) / 2) * step, (row - (rows - 1) / 2) * step, 0)),
            )
            for row in range(rows)
            for column in range(columns)
        )

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
