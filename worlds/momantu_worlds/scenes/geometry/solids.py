"""Bodies in the world: their extent, and what is inside, below and beside them.

Parts that do not collide are ignored here. A small hull is replaced by the box around it: the hulls
of hollow objects are thin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_worlds.scenes.geometry.bodies import Body, BodyTop, Box, Cylinder, Hull, Part, Sphere

with lazily():
    import trimesh

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
"""Corners of a box with edges of 1."""
SIDES = 32
"""Number of sides of the prism that replaces a cylinder."""
BALL = np.array(
    [
        (math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise))
        for turn in np.arange(16) * (math.pi / 8)
        for rise in np.arange(-4, 5) * (math.pi / 8)
    ]
)
"""(144, 3) points around a ball of radius 1, its poles and its equator among them."""
DIRECTIONS = np.stack(
    [np.cos(np.arange(180) * math.pi / 90), np.sin(np.arange(180) * math.pi / 90)]
)
"""(2, 180) unit vectors on the floor, every two degrees."""
SMALL = 0.25
"""m; smaller hulls belong to loose objects."""
FLUSH = 0.005
"""m between a body's lowest point and a top that it stands on."""
FLOOR = "floor"
"""Name of the plane at z = 0."""


@dataclass(frozen=True)
class Solid:
    """One colliding part in the map. vertices: (n, 3) of its convex outline."""

    part: Part
    map_from_part: Transform
    vertices: Array

    def inside(self, points: Array) -> NDArray[np.bool_]:
        """Which of points (n, 3) in the map lie in it."""
        own = self.map_from_part.inverse().apply(points)
        geometry = self.part.geometry
        if isinstance(geometry, Cylinder):
            near = np.hypot(own[:, 0], own[:, 1]) <= geometry.radius
            return np.asarray(near & (np.abs(own[:, 2]) <= geometry.height / 2))
        if isinstance(geometry, Sphere):
            return np.asarray(np.linalg.norm(own, axis=1) <= geometry.radius)
        around = outline(self.part)
        if isinstance(geometry, Hull) and np.ptp(around, axis=0).max() > SMALL:
            normals, offsets = _planes(geometry)
            return np.asarray((own @ normals.T <= offsets).all(axis=1))
        return np.asarray(((own >= around.min(axis=0)) & (own <= around.max(axis=0))).all(axis=1))

    def beside(self, point: Array) -> float:
        """Distance along the floor from a point (2,) to its outline, m; at most 0 inside."""
        reach = (self.vertices[:, :2] @ DIRECTIONS).max(axis=0)
        return float((point @ DIRECTIONS - reach).max())


class PlacedBody:
    """A body at its pose of one moment."""

    def __init__(self, body: Body, map_from_body: Transform) -> None:
        self.body, self.pose = body, map_from_body

    @cached_property
    def solids(self) -> tuple[Solid, ...]:
        """Its colliding parts."""
        return tuple(_solids(self.body, self.pose))

    @cached_property
    def lowest(self) -> float:
        """Height of its lowest point, m."""
        return min(float(solid.vertices[:, 2].min()) for solid in self.solids)

    @cached_property
    def highest(self) -> float:
        """Height of its highest point, m."""
        return max(float(solid.vertices[:, 2].max()) for solid in self.solids)

    @cached_property
    def _box(self) -> tuple[Array, Array]:
        parts = [part for part in self.body.parts if part.collision]
        own = np.concatenate([part.body_from_part.apply(outline(part)) for part in parts])
        return own.min(axis=0), own.max(axis=0)

    @property
    def size(self) -> Array:
        """Extent (3,) along its own axes, m."""
        low, high = self._box
        return np.asarray(high - low)

    @property
    def centre(self) -> Array:
        """The middle of the axis above its foot (3,), map, m: of a mug without its handle."""
        low, high = self._box
        foot = self.body.foot_at(Transform()).position
        return self.pose.apply(np.array([foot[0], foot[1], (low[2] + high[2]) / 2]))

    def inside(self, points: Array) -> NDArray[np.bool_]:
        """Which of points (n, 3) in the map lie in it."""
        return np.asarray(np.any([solid.inside(points) for solid in self.solids], axis=0))


@dataclass(frozen=True, slots=True)
class LevelTop:
    """A level top on which things stand, where its body stands now."""

    body: str
    map_from_top: Transform
    top: BodyTop

    @property
    def height(self) -> float:
        """Above the floor, m."""
        return float(self.map_from_top.position[2])

    def margin(self, point: Array) -> float:
        """How far within its nearest edge a point (2 or 3,) in the map lies, m; below 0 beyond."""
        own = self.map_from_top.inverse().apply((point[0], point[1], self.height))
        return self.top.margin(float(own[0]), float(own[1]))


class Scene:
    """All bodies of an episode at one instant. pose: `map_from_body` by name."""

    def __init__(self, bodies: Mapping[str, Body], pose: Callable[[str], Transform]) -> None:
        self._bodies, self._pose = bodies, pose

    def body(self, name: str) -> PlacedBody:
        """One body as it stands now; KeyError if there is none."""
        return PlacedBody(self._bodies[name], self._pose(name))

    def loose(self) -> Iterator[PlacedBody]:
        """All loose bodies."""
        return (self.body(name) for name, body in self._bodies.items() if not body.static)

    def solid(self) -> Iterator[PlacedBody]:
        """Everything that collides."""
        for name, body in self._bodies.items():
            if any(part.collision for part in body.parts):
                yield self.body(name)

    @cached_property
    def tops(self) -> tuple[LevelTop, ...]:
        """Tops of all static bodies: those that are given, or else upper faces of boxes."""
        return tuple(self._tops())

    def _tops(self) -> Iterator[LevelTop]:
        for name, body in self._bodies.items():
            if body.static:
                for top in (body.top,) if body.top is not None else box_tops(body):
                    yield LevelTop(name, self._pose(name) @ top.body_from_top, top)

    def below(self, thing: PlacedBody) -> tuple[str, float]:
        """What is highest below a body, and how far its lowest point is above that, m."""
        under = (
            (top.height, top.body)
            for top in self.tops
            if top.height <= thing.lowest + FLUSH and top.margin(thing.centre) > 0.0
        )
        height, name = max(under, default=(0.0, FLOOR))
        return name, thing.lowest - height


def box_tops(body: Body) -> Iterator[BodyTop]:
    """Upper faces of the boxes of a body."""
    for part in body.parts:
        if part.collision and isinstance(part.geometry, Box):
            x, y, z = part.geometry.size
            yield BodyTop(part.body_from_part @ Transform((0.0, 0.0, z / 2)), (x, y))


def _solids(body: Body, map_from_body: Transform) -> Iterable[Solid]:
    for part in body.parts:
        if part.collision:
            map_from_part = map_from_body @ part.body_from_part
            yield Solid(part, map_from_part, map_from_part.apply(outline(part)))


@lru_cache(maxsize=256)
def _planes(hull: Hull) -> tuple[Array, Array]:
    """Outward normals (k, 3) of a hull's faces, and how far out along them these are (k,), m."""
    mesh = trimesh.convex.convex_hull(np.asarray(hull.vertices))
    normals = np.asarray(mesh.face_normals)
    return normals, np.asarray((normals * mesh.triangles[:, 0]).sum(axis=1))


def outline(part: Part) -> Array:
    """Vertices (n, 3) around a part, in its own frame."""
    geometry = part.geometry
    if isinstance(geometry, Box):
        return np.asarray(CORNERS * geometry.size)
    if isinstance(geometry, Cylinder):
        turns = np.arange(SIDES) * (2.0 * math.pi / SIDES)
        x, y = geometry.radius * np.cos(turns), geometry.radius * np.sin(turns)
        half = np.full(SIDES, geometry.height / 2)
        return np.concatenate([np.stack([x, y, z], axis=1) for z in (-half, half)])
    if isinstance(geometry, Sphere):
        return geometry.radius * BALL
    if isinstance(geometry, Hull):
        return np.asarray(geometry.vertices)
    raise TypeError(f"a {type(geometry).__name__} has no collision shape")
