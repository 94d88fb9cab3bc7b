"""The robot's own shapes, as collision checks use them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product

import coal
import pinocchio as pin

from momantu_bt.geometry import Array, Transform
from momantu_skills.manipulation.model.hulls import convex, load_mesh, part_points
from momantu_skills.manipulation.model.urdf import CollisionPart

LONGEST_HULL = 0.4
"""Longest link that is replaced by its hull, m. Longer links keep their mesh: the hull around a
torso with shoulders and neck would include the arm folded in front of it. Checks against a mesh are
slower, but few."""


class LinkShapes:
    """Shapes of links, placed in a pinocchio model.

    geometry: all shapes. links: indices of each link's shapes in it.
    """

    def __init__(self, model: pin.Model, links: Iterable[str]) -> None:
        """links: their names; shapes are added one by one."""
        self.geometry = pin.GeometryModel()
        self.links: dict[str, list[int]] = {link: [] for link in links}
        self._pin = model
        self._frames = {
            link: int(model.getFrameId(link, pin.FrameType.BODY)) for link in self.links
        }

    def add(self, link: str, shape: coal.CollisionGeometry, link_from_shape: Transform) -> None:
        """Add a shape of a link."""
        identity = self._frames[link]
        frame = self._pin.frames[identity]
        place = frame.placement * pin.SE3(link_from_shape.matrix)
        name = f"{link}:{len(self.links[link])}" if self.links[link] else link
        thing = pin.GeometryObject(name, frame.parentJoint, identity, place, shape)
        self.links[link].append(int(self.geometry.addGeometryObject(thing)))

    def pairs(self, one: str, other: str) -> Iterator[tuple[int, int]]:
        """Pairs of shape indices of two links."""
        return product(self.links[one], self.links[other])

    def joint(self, link: str) -> int:
        """Index of the joint that carries a link."""
        return int(self._pin.frames[self._frames[link]].parentJoint)

    def adjacent(self, one: str, other: str) -> bool:
        """Whether two links share a joint, or are fixed to the same one."""
        a, b = self.joint(one), self.joint(other)
        parents = self._pin.parents
        return a == b or int(parents[a]) == b or int(parents[b]) == a


class BodyShapes(LinkShapes):
    """One hull per link, or the meshes of long links."""

    def __init__(
        self, model: pin.Model, hulls: Mapping[str, Array], parts: Iterable[CollisionPart]
    ) -> None:
        """hulls: corners (k, 3) in the link's frame. parts: the collision parts of each link."""
        super().__init__(model, hulls)
        every = tuple(parts)
        for link, corners in hulls.items():
            if float((corners.max(axis=0) - corners.min(axis=0)).max()) < LONGEST_HULL:
                self.add(link, convex(corners), Transform())
                continue
            for part in (part for part in every if part.link == link):
                shape = load_mesh(part) if part.kind == "mesh" else convex(part_points(part))
                place = part.link_from_part if part.kind == "mesh" else Transform()
                self.add(link, shape, place)
