"""Furniture of a world file: pieces of the catalogue or meshes, and tables."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Size
from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.catalogue.furniture import usual_size
from momantu_worlds.scenes.catalogue.shelves import BOARDED
from momantu_worlds.scenes.file.values import (
    Name,
    NotNegative,
    Part,
    PlanarPose,
    Rgb,
    Sides,
    Size3D,
    Turn,
    pose2d,
    with_one_diameter,
)
from momantu_worlds.scenes.geometry.parts import Size3

FurnitureKind: TypeAlias = Literal[
    "table",
    "desk",
    "counter",
    "chair",
    "sofa",
    "bed",
    "shelf",
    "rack",
    "crate",
    "pallet",
    "cabinet",
    "plant",
    "figure",
]
TableKind: TypeAlias = Literal["table", "desk", "counter", "cabinet", "crate", "pallet"]
MESH_ENDINGS = (".glb", ".gltf", ".obj", ".stl", ".dae", ".ply")
MOST_BOARDS = 20


class MeshUse(Part):
    """A mesh file, relative to the world file or with an absolute path.

    size: the extents (depth, width, height) that it is scaled to, m; `scale`: a factor instead. up:
    which of its own axes points up. collision: the collision shape: the convex hull of all, the box
    around all, the convex hull of each of its parts, or none.
    """

    file: Annotated[str, Field(min_length=1, max_length=500)]
    size: Size3D | None = None
    scale: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    up: Literal["z", "y"] = "z"
    collision: Literal["hull", "box", "parts", "none"] = "hull"

    @model_validator(mode="before")
    @classmethod
    def _short(cls, data: Any) -> Any:
        return {"file": data} if isinstance(data, str) else data

    @model_validator(mode="after")
    def _known(self) -> Self:
        if not self.file.lower().endswith(MESH_ENDINGS):
            raise ValueError(
                f"{self.file!r} is not a mesh file; endings: {', '.join(MESH_ENDINGS)}"
            )
        if self.size is not None and self.scale != 1.0:
            raise ValueError("write size or scale, not both")
        return self


class Piece(Part):
    """One piece of furniture: of a kind of the catalogue, or a mesh.

    boards: heights of the boards of a shelf or rack, m. moves: an episode may move it, as `unknown`
    says; shift, turn: every episode moves it, by up to this much.
    """

    kind: FurnitureKind | None = None
    mesh: MeshUse | None = None
    at: PlanarPose
    size: Size3D | None = None
    color: Rgb | None = None
    boards: Annotated[tuple[Size, ...], Field(max_length=MOST_BOARDS)] = ()
    moves: bool = False
    shift: NotNegative = 0.0
    turn: Turn = 0.0

    @model_validator(mode="after")
    def _one_look(self) -> Self:
        if (self.kind is None) == (self.mesh is None):
            raise ValueError("write a kind of the catalogue or a mesh")
        if self.mesh is not None and self.size is not None:
            raise ValueError("the size of a mesh is written as mesh.size")
        if self.boards and self.kind not in BOARDED:
            raise ValueError(f"only a {' or a '.join(BOARDED)} has boards")
        if list(self.boards) != sorted(set(self.boards)):
            raise ValueError("boards are heights from below upwards, each once")
        if self.boards and self.boards[-1] > self.extent[2]:
            raise ValueError(f"a board at {self.boards[-1]:g} m is above {self.extent[2]:g} m")
        return self

    @property
    def pose(self) -> Pose2D:
        """Its pose in the file."""
        return pose2d(self.at)

    @property
    def extent(self) -> Size3:
        """(depth, width, height), m."""
        if self.kind is None:
            raise ValueError("a mesh has the size of its file; see obstacles.piece_size")
        return self.size or usual_size(self.kind)


class Table(Part):
    """A body with a top that is a surface of the site: a table, a mesh, or a board of a shelf.

    board_of, board: a piece of `furniture`, and the number of its board, counted from 1 at the
    lowest. sides: the directions, in its own frame, to stand at; the first is preferred. round: its
    top is a disc, on a column if it is no mesh, and depth and width are its diameter.
    """

    kind: TableKind = "table"
    at: PlanarPose | None = None
    size: Size3D | None = None
    mesh: MeshUse | None = None
    board_of: Name | None = None
    board: Annotated[int, Field(ge=1, le=MOST_BOARDS)] | None = None
    color: Rgb | None = None
    shift: NotNegative = 0.0
    turn: Turn = 0.0
    lift: NotNegative = 0.0
    sides: Sides
    round: bool = False

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.board_of is None:
            if self.at is None or self.size is None or self.board is not None:
                raise ValueError("needs at and size, or board_of and board")
            if self.mesh is not None and self.mesh.size is not None:
                raise ValueError("a mesh that is a table has the table's own size, not mesh.size")
            if self.round:
                if self.kind != "table" or (
                    self.mesh is not None and "kind" in self.model_fields_set
                ):
                    raise ValueError(
                        f"a {self.kind} is not round; write kind: table, or a mesh alone"
                    )
                with_one_diameter(self.size[:2])
        elif self.board is None:
            raise ValueError("needs the key 'board': which board, counted from 1 at the lowest")
        elif set(self.model_fields_set) - {"board_of", "board", "sides", "color"}:
            raise ValueError("a board has the place and size of its shelf; write only sides, color")
        return self
