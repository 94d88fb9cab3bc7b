"""What a simulator builds: bodies made of parts, lights, and the whole episode.

Plain values without a simulator in them. Lengths in m, masses in kg, colours linear-looking sRGB
in 0..1. Every transform is named `target_from_source`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.world import Site

Color: TypeAlias = tuple[float, float, float]

GREY: Color = (0.6, 0.6, 0.6)


@dataclass(frozen=True, slots=True)
class Box:
    """A cuboid around the part's origin; size: full edge lengths along x, y, z, m."""

    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder around the part's origin, its axis along z; radius and full height, m."""

    radius: float
    height: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball around the part's origin, m."""

    radius: float


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh to look at; vertices that faces share are shaded smoothly.

    vertices: (n, 3) m. triangles: (m, 3), counter-clockwise seen from outside. texture: a picture
    (h, w, 3) uint8 instead of the part's colour, with uv (n, 2), whose v = 0 is its last row.
    """

    vertices: Array
    triangles: NDArray[np.int32]
    uv: Array | None = None
    texture: NDArray[np.uint8] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """The convex hull of some points (n, 3) m, to collide with; at most 64 of them."""

    vertices: Array


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A flat picture in the part's xy plane, seen from +z, to look at.

    size: full extent along x and y, m. pixels: (h, w, 3) uint8; row 0 lies at +y, column 0 at -x.
    """

    size: tuple[float, float]
    pixels: NDArray[np.uint8]


Geometry: TypeAlias = Box | Cylinder | Sphere | Mesh | Hull | Picture


@dataclass(frozen=True, slots=True)
class Part:
    """One geometry of a body. visual: cameras see it; collision: it touches and stops lasers."""

    geometry: Geometry
    body_from_part: Transform = field(default_factory=Transform)
    color: Color = GREY
    visual: bool = True
    collision: bool = True


@dataclass(frozen=True, slots=True)
class BodyTop:
    """A level top of a body: the frame in its middle, z up, and its extent along x and y, m.

    round: a disc of that diameter, else a rectangle.
    """

    body_from_top: Transform
    size: tuple[float, float]
    round: bool = False

    def margin(self, x: float, y: float) -> float:
        """How far a point in its frame lies within the nearest edge, m; below 0 beyond it."""
        if self.round:
            return self.size[0] / 2 - math.hypot(x, y)
        return min(self.size[0] / 2 - abs(x), self.size[1] / 2 - abs(y))


@dataclass(frozen=True, slots=True)
class Body:
    """A rigid body.

    name: unique in the episode. category: "can", "bottle", "table", "wall" … static: it never
    moves. mass: kg, ignored when static; its density is uniform over the colliding parts.
    friction: coefficient, static and dynamic alike. top: the surface on which objects stand; None:
    the upper faces of its boxes. kinematic: physics does not move it, but the world does; it counts
    as static for all who ask what may be pushed. foot: `body_from_foot`, the middle of what it
    stands on; None: its origin.
    """

    name: str
    category: str
    map_from_body: Transform
    parts: tuple[Part, ...]
    static: bool = True
    mass: float = 0.0
    friction: float = 0.6
    top: BodyTop | None = None
    kinematic: bool = False
    foot: Transform | None = None

    def foot_at(self, map_from_body: Transform) -> Transform:
        """`map_from_foot` while the body is at a pose."""
        return map_from_body if self.foot is None else map_from_body @ self.foot

    def with_foot_at(self, map_from_foot: Transform) -> Transform:
        """`map_from_body` while its foot is at a pose."""
        return map_from_foot if self.foot is None else map_from_foot @ self.foot.inverse()


@dataclass(frozen=True, slots=True)
class Actor:
    """Somebody who walks between stops.

    stops: (x, y) in the map, m. speed, pause: the least and the most, m/s and s; each way and each
    stop draws its own. group: how many people walk one behind the other. color: of the clothes.
    """

    name: str
    stops: tuple[tuple[float, float], ...]
    speed: tuple[float, float]
    pause: tuple[float, float]
    group: int = 1
    color: Color = GREY


@dataclass(frozen=True, slots=True)
class SunLight:
    """Parallel light. direction: (3,) where it shines to, map frame. color: its strength."""

    direction: tuple[float, float, float]
    color: Color


@dataclass(frozen=True, slots=True)
class PointLight:
    """A lamp. position: (3,) m, map frame. color: its strength at 1 m."""

    position: tuple[float, float, float]
    color: Color


@dataclass(frozen=True, slots=True)
class Goal:
    """One demand of the referee: `item` stands on `support` beside `marker` (names of bodies).

    marker: None: it need not stand beside anything. max_tilt: rad from upright; lying: from level,
    as the item lies on its side. max_distance: m between item and marker, along the floor.
    still_for: s without moving. min_gripper_distance: m from the item. max_others_tilt: rad and
    max_others_shift: m that any other loose body may have moved. max_force: N of any contact
    of the robot with anything but the item.
    """

    item: str
    support: str
    marker: str | None
    max_tilt: float
    max_distance: float
    still_for: float
    min_gripper_distance: float
    max_others_tilt: float
    max_others_shift: float
    max_force: float
    lying: bool = False

    def __str__(self) -> str:
        beside = "" if self.marker is None else f" beside {self.marker}"
        lying = " lying" if self.lying else ""
        return f"{self.item}{lying} on {self.support}{beside}"


@dataclass(frozen=True, slots=True)
class Gap:
    """A doorway. at: its middle (x, y), m. clear: radius around it without furniture, m."""

    at: tuple[float, float]
    clear: float


@dataclass(frozen=True, slots=True)
class Episode:
    """One episode. All poses are in the map; the floor is z = 0.

    start: the true pose of the robot's base at the start. ambient: light from all directions.
    site: what the robot is told. goals: what the referee demands. goals_place: where that is
    written. doorways: by name. actors: who walks about; their bodies are not among `bodies`.
    """

    name: str
    seed: int
    bodies: tuple[Body, ...]
    start: Pose2D
    ambient: Color
    suns: tuple[SunLight, ...]
    lamps: tuple[PointLight, ...]
    site: Site
    goals: tuple[Goal, ...] = ()
    doorways: Mapping[str, Gap] = field(default_factory=lambda: MappingProxyType({}))
    goals_place: str = ""
    actors: tuple[Actor, ...] = ()

    @property
    def goal(self) -> Goal | None:
        """The first of the goals: what the episode is about."""
        return self.goals[0] if self.goals else None

    def body(self, name: str) -> Body:
        """The body of that name; KeyError lists the known names if there is none."""
        for body in self.bodies:
            if body.name == name:
                return body
        raise KeyError(f"no body {name!r}; bodies: {', '.join(b.name for b in self.bodies)}")
