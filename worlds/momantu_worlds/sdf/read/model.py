"""An SDF world as typed values, before frames are resolved and anything is converted."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TypeAlias

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Transform
from momantu_worlds.sdf.read.values import Pose

Rgba: TypeAlias = tuple[float, float, float, float]
Vector: TypeAlias = tuple[float, float, float]

MOVING_JOINTS = (
    "revolute",
    "revolute2",
    "prismatic",
    "continuous",
    "ball",
    "universal",
    "screw",
    "gearbox",
)


@dataclass(frozen=True, slots=True)
class Box:
    """Full edge lengths, m."""

    size: Vector


@dataclass(frozen=True, slots=True)
class Cylinder:
    """Along z; radius and full length, m."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """radius: m."""

    radius: float


@dataclass(frozen=True, slots=True)
class Capsule:
    """Along z; radius, and length of the cylindrical part, m."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Cone:
    """Along z, its point up; radius and full length, m."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """radii: along x, y and z, m."""

    radii: Vector


@dataclass(frozen=True, slots=True)
class Plane:
    """size: extent along its own x and y, m, as drawn; to collide with it has no end."""

    normal: Vector
    size: tuple[float, float]


@dataclass(frozen=True, slots=True)
class MeshFile:
    """Triangles from a file. submesh: this part alone; center: moved to the origin first."""

    file: Path
    scale: Vector = (1.0, 1.0, 1.0)
    submesh: str = ""
    center: bool = False


Geometry: TypeAlias = Box | Cylinder | Sphere | Capsule | Cone | Ellipsoid | Plane | MeshFile


@dataclass(frozen=True, slots=True)
class Material:
    """What a shape looks like. color: None if it is not given. texture: of its colour."""

    color: Rgba | None = None
    texture: Path | None = None


@dataclass(frozen=True, slots=True)
class Shape:
    """A visual or a collision. friction: None if it is not given."""

    name: str
    place: Place
    pose: Pose
    geometry: Geometry
    material: Material = Material()
    friction: float | None = None


class LightKind(StrEnum):
    """SDF's kinds of light."""

    SUN = "directional"
    POINT = "point"
    SPOT = "spot"


@dataclass(frozen=True, slots=True)
class Light:
    """direction: where it shines to, in its own frame."""

    name: str
    kind: LightKind
    place: Place
    pose: Pose
    diffuse: Rgba
    direction: Vector = (0.0, 0.0, -1.0)


@dataclass(frozen=True, slots=True)
class Frame:
    """A named frame; attached_to: empty for the model's or the world's own."""

    name: str
    attached_to: str
    pose: Pose


@dataclass(frozen=True, slots=True)
class Joint:
    """parent and child: names of links or frames, `world` for what stands still."""

    name: str
    kind: str
    parent: str
    child: str
    pose: Pose
    place: Place

    @property
    def moves(self) -> bool:
        """Whether child and parent are not one rigid thing."""
        return self.kind in MOVING_JOINTS


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid thing. mass: kg. sensors: how many it carries.

    unseen, untouched: how many of its visuals and collisions could not be read. weightless: gravity
    does not pull it.
    """

    name: str
    place: Place
    pose: Pose
    mass: float
    visuals: tuple[Shape, ...] = ()
    collisions: tuple[Shape, ...] = ()
    lights: tuple[Light, ...] = ()
    sensors: int = 0
    unseen: int = 0
    untouched: int = 0
    weightless: bool = False


@dataclass(frozen=True, slots=True)
class Model:
    """Links that belong together. merged: its names are also its parent's.

    pose: of `placement_frame` in the scope around it; of the model's own frame if that is empty.
    """

    name: str
    place: Place
    pose: Pose
    static: bool
    placement_frame: str = ""
    merged: bool = False
    links: tuple[Link, ...] = ()
    joints: tuple[Joint, ...] = ()
    frames: tuple[Frame, ...] = ()
    models: tuple[Model, ...] = ()
    plugins: int = 0


@dataclass(frozen=True, slots=True)
class ModelState:
    """Where a saved world had a model, in the world's frame. scale: of all its shapes."""

    place: Place
    pose: Transform | None = None
    scale: Vector = (1.0, 1.0, 1.0)
    links: dict[str, Transform] = field(default_factory=dict)
    models: dict[str, ModelState] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class SdfWorld:
    """A whole world, with everything that it includes. ambient: light from everywhere."""

    name: str
    file: Path
    version: tuple[int, int]
    models: tuple[Model, ...]
    lights: tuple[Light, ...]
    frames: tuple[Frame, ...]
    states: dict[str, ModelState]
    light_states: dict[str, Transform]
    ambient: Rgba | None = None
