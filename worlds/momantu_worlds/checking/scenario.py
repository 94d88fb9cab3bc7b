"""One episode as the checks see it: its bodies as solids, the floor, the surfaces, the robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from momantu_bt.formats.places import KeyPath
from momantu_bt.geometry import Array, Transform
from momantu_worlds.checking.ground import Ground, Obstacle, obstacle
from momantu_worlds.checking.measures import Measures
from momantu_worlds.scenes.geometry.bodies import Body, Episode
from momantu_worlds.scenes.geometry.convex import Convex, solids_of
from momantu_worlds.scenes.geometry.support import SupportTop

MARGIN = 1.0
"""m of floor around everything that the checks cover."""
FLOOR, WALL = "floor", "wall"
"""Categories of bodies."""
UNKNOWN = "extra_"
"""Prefix of the names of furniture that an episode adds."""


class Scenario:
    """An episode and a robot in it; everything is computed when it is first used."""

    def __init__(self, episode: Episode, robot: Measures, place: Callable[[str], KeyPath]) -> None:
        """place: where in the world file a body or a doorway comes from, by its name."""
        self.episode, self.robot, self.place = episode, robot, place

    @property
    def bodies(self) -> Iterator[Body]:
        """All but the floor itself."""
        return (body for body in self.episode.bodies if body.category != FLOOR)

    @cached_property
    def solids(self) -> Mapping[str, tuple[Convex, ...]]:
        """The colliding parts of every body but the floor, by its name."""
        return {body.name: solids_of(body) for body in self.bodies}

    @cached_property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """All obstacles of the robot's base."""
        found = (
            obstacle(name, solid, self.robot.height)
            for name, solids in self.solids.items()
            for solid in solids
        )
        return tuple(each for each in found if each is not None)

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Corners (2,) of the checked area: around the start and all colliding parts."""
        points = [np.array([[self.episode.start.x, self.episode.start.y]])]
        points += [s.vertices[:, :2] for solids in self.solids.values() for s in solids]
        everything = np.concatenate(points)
        return everything.min(axis=0) - MARGIN, everything.max(axis=0) + MARGIN

    @cached_property
    def kept_out(self) -> tuple[Obstacle, ...]:
        """The site's keep-out zones, as obstacles."""
        return tuple(
            Obstacle(f"the keep-out zone {name}", np.array(zone.corners))
            for name, zone in self.episode.site.zones.items()
            if zone.kind == "keep_out"
        )

    @cached_property
    def ground(self) -> Ground:
        """The floor with everything on it, keep-out zones too."""
        return Ground(self.obstacles, *self.extent, self.kept_out)

    @cached_property
    def known_ground(self) -> Ground:
        """The floor without furniture that an episode adds."""
        known = [each for each in self.obstacles if not each.body.startswith(UNKNOWN)]
        if len(known) == len(self.obstacles):
            return self.ground
        return Ground(known, *self.extent, self.kept_out)

    @cached_property
    def walls(self) -> Ground:
        """The floor with nothing but walls."""
        walls = {body.name for body in self.bodies if body.category == WALL}
        return Ground([o for o in self.obstacles if o.body in walls], *self.extent)

    @cached_property
    def reached(self) -> NDArray[np.bool_]:
        """Cells of `ground` that the middle of the base reaches from the start."""
        start = self.episode.start
        return self.ground.reached((start.x, start.y), self.robot.half_width)

    def stands_near(self, point: Array, distance: float) -> Array:
        """Centres (n, 2) of `reached` within `distance` m of a point, along x and along y."""
        return self.ground.centres(self.reached, np.asarray(point), distance)

    @cached_property
    def surfaces(self) -> Mapping[str, tuple[Transform, tuple[float, float]]]:
        """Frame of the top (z up) and its extent, m, of every surface at its true pose."""
        found = {}
        for name in self.episode.site.surfaces:
            body = self.episode.body(name)
            top = SupportTop(body)
            found[name] = (top.surface(body.map_from_body), (top.size[0], top.size[1]))
        return found

    def is_wall(self, body: str) -> bool:
        """Whether a body is a wall."""
        names = (each.name for each in self.bodies if each.category == WALL)
        return body in names

    def hit(self, origins: Array, rays: Array, but: frozenset[str]) -> tuple[Array, list[str]]:
        """Where segments first meet a body, in lengths of the ray (inf: nowhere), and which.

        origins, rays: (n, 3). but: bodies that do not count.
        """
        low = np.minimum(origins, origins + rays).min(axis=0)
        high = np.maximum(origins, origins + rays).max(axis=0)
        first, which = np.full(len(rays), np.inf), [""] * len(rays)
        for name, solids in self.solids.items():
            if name in but:
                continue
            for solid in solids:
                if (solid.box[0] > high).any() or (solid.box[1] < low).any():
                    continue
                at = solid.hits(origins, rays)
                for i in np.flatnonzero((at <= 1.0) & (at < first)):
                    first[i], which[i] = at[i], name
        return first, which
