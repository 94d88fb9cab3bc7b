"""The parts of a world file, as checked values."""

from __future__ import annotations

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, model_validator

from momantu_bt.geometry import Pose2D
from momantu_worlds.scenes.furniture import Size3, usual_size
from momantu_worlds.scenes.objects import OBJECT_KINDS, ObjectKind
from momantu_worlds.scenes.tag36h11 import CODES
from momantu_worlds.scenes.units import Angle, Force, Length, Mass, Size, Time

Channel: TypeAlias = Annotated[float, Field(ge=0, le=1)]
Rgb: TypeAlias = tuple[Channel, Channel, Channel]
Point: TypeAlias = tuple[Length, Length]
PlanarPose: TypeAlias = tuple[Length, Length, Angle]
Range: TypeAlias = tuple[float, float]
Name: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Friction: TypeAlias = Annotated[float, Field(gt=0, le=1)]
Count: TypeAlias = Annotated[int, Field(ge=0, le=50)]
FurnitureKind: TypeAlias = Literal[
    "table",
    "desk",
    "counter",
    "chair",
    "sofa",
    "bed",
    "shelf",
    "crate",
    "pallet",
    "cabinet",
    "plant",
    "figure",
]


def pose2d(pose: tuple[float, float, float]) -> Pose2D:
    """A pose of the file as the value that everything else uses."""
    return Pose2D(*pose)


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Floor(_Part):
    """The slab that everything stands on."""

    center: Point
    size: tuple[Size, Size]
    color: Rgb
    friction: Friction = 0.8


class WallPiece(_Part):
    """One straight wall by the middle of its axis; yaw of its length."""

    name: Name
    length: Size
    center: Point
    yaw: Angle


class Walls(_Part):
    """All walls, in a frame whose origin lies at `origin` of the map."""

    origin: Point = (0.0, 0.0)
    thickness: Size
    height: Size
    color: Rgb
    pieces: tuple[WallPiece, ...]

    def map_from_piece(self, piece: WallPiece) -> Pose2D:
        """Where a piece's middle lies in the map, x along its length."""
        return Pose2D(piece.center[0] + self.origin[0], piece.center[1] + self.origin[1], piece.yaw)


class Doorway(_Part):
    """A gap to drive through: its middle, and the radius around it that is kept free."""

    at: Point
    clear: Size


class Piece(_Part):
    """One piece of furniture."""

    kind: FurnitureKind
    at: PlanarPose
    size: tuple[Size, Size, Size] | None = None
    color: Rgb | None = None
    moves: bool = False

    @property
    def pose(self) -> Pose2D:
        """Where it stands by the file."""
        return pose2d(self.at)

    @property
    def extent(self) -> Size3:
        """(depth, width, height), m."""
        return self.size or usual_size(self.kind)


class Table(_Part):
    """A piece of furniture that matters: its top is a surface of the site."""

    kind: Literal["table", "desk", "counter"]
    at: PlanarPose
    size: tuple[Size, Size, Size]
    color: Rgb | None = None
    shift: Annotated[Length, Field(ge=0)] = 0.0
    turn: Annotated[Angle, Field(ge=0)] = 0.0
    lift: Annotated[Length, Field(ge=0)] = 0.0
    sides: Annotated[tuple[Angle, ...], Field(min_length=1)]

    @property
    def pose(self) -> Pose2D:
        """Where it stands by the file."""
        return pose2d(self.at)


class Item(_Part):
    """What is brought: an upright can on a table."""

    name: Name
    kind: Literal["can"]
    on: Name
    at: Point
    shift: Annotated[Length, Field(ge=0)] = 0.0
    radius: Size
    height: Size
    mass: Mass
    friction: Friction
    color: Rgb


class Tag(_Part):
    """An AprilTag of the family 36h11, flat on a table; edge of its black square."""

    name: Name
    id: Annotated[int, Field(ge=0, lt=len(CODES))]
    edge: Size
    on: Name
    at: Point
    shift: Annotated[Length, Field(ge=0)] = 0.0


class Distractors(_Part):
    """Loose things on the tables, 0 to `most` on each. Gaps are between surfaces.

    patterns: they are painted in many ways, not each kind in one.
    """

    most: Annotated[int, Field(ge=0, le=8)]
    gap: Size
    gap_to_item: Size
    kinds: tuple[ObjectKind, ...] = OBJECT_KINDS
    patterns: bool = False


class Start(_Part):
    """Where the robot stands at first, how far an episode shifts that, what it is told."""

    at: PlanarPose
    shift: Annotated[Length, Field(ge=0)] = 0.0
    belief_shift: Annotated[Length, Field(ge=0)] = 0.0
    belief_turn: Annotated[Angle, Field(ge=0)] = 0.0


class Between(_Part):
    """An inclusive range of counts."""

    least: Count
    most: Count

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.least > self.most:
            raise ValueError(f"least ({self.least}) is more than most ({self.most})")
        return self


class Unknown(_Part):
    """What the map does not know: pieces moved, and extra pieces in some areas."""

    shift: Annotated[Length, Field(ge=0)]
    turn: Annotated[Angle, Field(ge=0)]
    moved: Between
    extra: Between
    kinds: Annotated[tuple[FurnitureKind, ...], Field(min_length=1)]
    passage: Size
    stand: Size
    areas: tuple[tuple[Length, Length, Length, Length], ...] = ()


class Light(_Part):
    """Ranges of brightness, and where lamps hang."""

    ambient: Range
    sun: Range
    lamp: Range
    lamps: tuple[Point, ...] = ()


class GoalDemand(_Part):
    """What the referee wants."""

    item: Name
    on: Name
    beside: Name
    tilt: Angle
    distance: Size
    still: Time
    gripper: Size
    others_tilt: Angle
    others_shift: Size
    force: Force


class ObjectSizes(_Part):
    """What the robot is told of a class of objects."""

    category: Name
    diameter: Size | None = None
    height: Size | None = None
    width: Size | None = None
    depth: Size | None = None


class SiteNotes(_Part):
    """What a person would tell the robot, beside what follows from the file."""

    resolution: Size
    laser_height: Size
    robot_height: Size
    places: dict[Name, PlanarPose]
    objects: dict[Name, ObjectSizes]


class WorldFile(_Part):
    """A whole world file."""

    momantu_world: Literal[1]
    name: Name
    floor: Floor
    walls: Walls
    doorways: dict[Name, Doorway] = {}
    tables: dict[Name, Table]
    item: Item
    tag: Tag
    distractors: Distractors
    furniture: dict[Name, Piece] = {}
    start: Start
    unknown: Unknown
    light: Light
    goal: GoalDemand
    site: SiteNotes
