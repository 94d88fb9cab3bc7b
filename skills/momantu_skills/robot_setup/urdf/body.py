"""A robot from its URDF alone: where its links are, and which of them meet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial import QhullError

from momantu_bt.geometry import Array
from momantu_skills.manipulation.model.hulls import convex, link_hulls, part_points, placed
from momantu_skills.manipulation.model.shapes import BodyShapes, LinkShapes
from momantu_skills.manipulation.model.urdf import UrdfSource, base_urdf
from momantu_skills.robot_setup.urdf.skeleton import SetupError, Skeleton

TOUCH = 1e-6
"""Least distance, m, at which links count as meeting. At 0 coal takes hulls for apart that have one
middle, such as those of tubes that slide in each other."""


class Body:
    """Kinematics and shapes of everything below the base frame; poses are in that frame.

    A posture is positions by joint name, rad or m; joints that are not named stand as near to 0
    as their limits let them, and joints that follow others follow.
    """

    def __init__(self, skeleton: Skeleton, source: UrdfSource) -> None:
        """Raises SetupError: the URDF is not a mechanism, or a shape has no volume."""
        self.skeleton, self.base_frame = skeleton, source.base_frame
        self.urdf = base_urdf(source)
        try:
            self.pin: pin.Model = pin.buildModelFromXML(self.urdf.text)
        except (RuntimeError, ValueError) as error:
            raise SetupError(f"the URDF's joints do not form a mechanism: {error}") from None
        try:
            self.hulls = link_hulls(self.urdf.parts)
        except (QhullError, ValueError, RuntimeError) as error:
            reason = str(error).strip().splitlines()[0]
            raise SetupError(f"a collision shape cannot be used: {reason}") from None
        self.shapes = BodyShapes(self.pin, self.hulls, self.urdf.parts)
        self.frames = {str(f.name): i for i, f in enumerate(self.pin.frames) if _is_body(f)}
        self._data = self.pin.createData()
        self._points: dict[str, Array] = {}
        self.index = {
            str(name): int(joint.idx_q)
            for name, joint in zip(self.pin.names, self.pin.joints, strict=True)
            if str(name) in skeleton.joints and int(joint.nq) == 1
        }
        self._mimics = [
            (self.index[name], self.index[joint.mimic.leader], joint.mimic)
            for name, joint in skeleton.joints.items()
            if joint.mimic and name in self.index and joint.mimic.leader in self.index
        ]

    @property
    def free_joints(self) -> tuple[str, ...]:
        """Joints that follow no other."""
        return tuple(name for name in self.index if self.skeleton.joints[name].mimic is None)

    def rest(self) -> dict[str, float]:
        """Every joint as near to 0 as its limits let it."""
        return {name: self._rest(name) for name in self.index}

    def _rest(self, name: str) -> float:
        lower, upper = self.skeleton.joints[name].range
        return min(max(0.0, lower), upper)

    def configuration(self, posture: Mapping[str, float]) -> Array:
        """All joints (nq,) in pinocchio's order."""
        q = np.asarray(pin.neutral(self.pin), dtype=np.float64)
        for name, i in self.index.items():
            q[i] = posture[name] if name in posture else self._rest(name)
        return self.follow(q)

    def named(self, q: Array) -> dict[str, float]:
        """Joints (nq,) by name."""
        return {name: float(q[i]) for name, i in self.index.items()}

    def follow(self, q: Array) -> Array:
        """Joints (nq,) with those that follow others where they follow; changed in place."""
        for own, leader, mimic in self._mimics:
            q[own] = mimic.multiplier * q[leader] + mimic.offset
        return q

    def link_poses(
        self, posture: Mapping[str, float], links: Iterable[str] | None = None
    ) -> dict[str, Array]:
        """base_from_link (4, 4) of some links, or of every one."""
        pin.framesForwardKinematics(self.pin, self._data, self.configuration(posture))
        frames = self._data.oMf
        wanted = self.frames if links is None else links
        return {link: np.array(frames[self.frames[link]].homogeneous) for link in wanted}

    def corners(self, links: Iterable[str], posture: Mapping[str, float]) -> Array:
        """Corners (n, 3) of the hulls of those links that have one."""
        shaped = [link for link in links if link in self.hulls]
        poses = self.link_poses(posture, shaped)
        some = [placed(self.hulls[link], poses[link]) for link in shaped]
        return np.vstack(some) if some else np.zeros((0, 3))

    def points(self, links: Iterable[str], posture: Mapping[str, float]) -> Array:
        """Every corner (n, 3) of the collision shapes of links, not thinned, in the base."""
        shaped = [link for link in links if link in self.hulls]
        poses = self.link_poses(posture, shaped)
        some = [placed(self.link_points(link), poses[link]) for link in shaped]
        return np.vstack(some) if some else np.zeros((0, 3))

    def link_points(self, link: str) -> Array:
        """Every corner (n, 3) of a link's collision shapes, not thinned, in its own frame."""
        if link not in self._points:
            some = [part_points(part) for part in self.urdf.parts if part.link == link]
            self._points[link] = np.vstack(some)
        return self._points[link]

    def lowest(self, posture: Mapping[str, float]) -> float:
        """Height of the lowest corner of all, m; 0 for a robot without shapes."""
        corners = self.corners(self.hulls, posture)
        return float(corners[:, 2].min()) if len(corners) else 0.0

    def random_configurations(self, count: int, seed: int) -> Array:
        """Postures (count, nq) spread evenly within the limits."""
        q = np.tile(np.asarray(pin.neutral(self.pin), dtype=np.float64), (count, 1))
        random = np.random.default_rng(seed)
        for name, i in self.index.items():
            lower, upper = self.skeleton.joints[name].range
            q[:, i] = random.uniform(lower, upper, count)
        for row in q:
            self.follow(row)
        return q


class Contacts:
    """Which of some pairs of links meet, and how far apart they are."""

    def __init__(
        self,
        body: Body,
        pairs: Iterable[tuple[str, str]],
        margin: float = 0.0,
        close: Mapping[tuple[str, str], float] | None = None,
        shapes: LinkShapes | None = None,
    ) -> None:
        """margin: pairs nearer than this count as meeting, m; `close` have a margin of their own.

        shapes: what the links are taken for; default: what planning takes them for.
        """
        self.body, self.pairs = body, tuple(pairs)
        own: LinkShapes = body.shapes if shapes is None else shapes
        self._geometry = own.geometry.copy()
        self._owner: list[int] = []
        for number, (one, other) in enumerate(self.pairs):
            for a, b in own.pairs(one, other):
                self._geometry.addCollisionPair(pin.CollisionPair(a, b))
                self._owner.append(number)
        self._shapes, self._data = self._geometry.createData(), body.pin.createData()
        for index, owner in enumerate(self._owner):
            own_margin = (close or {}).get(self.pairs[owner], margin)
            self._shapes.collisionRequests[index].security_margin = max(own_margin, TOUCH)

    def meeting(self, q: Array) -> NDArray[np.bool_]:
        """(n,) which of the pairs meet at joints (nq,)."""
        pin.computeCollisions(self.body.pin, self._data, self._geometry, self._shapes, q, False)
        found = np.zeros(len(self.pairs), dtype=bool)
        for owner, result in zip(self._owner, self._shapes.collisionResults, strict=True):
            if result.isCollision():
                found[owner] = True
        return found

    def free(self, q: Array) -> bool:
        """Whether none of them meet at joints (nq,)."""
        return not pin.computeCollisions(
            self.body.pin, self._data, self._geometry, self._shapes, q, True
        )

    def names(self, q: Array) -> list[tuple[str, str]]:
        """The pairs that meet at joints (nq,)."""
        return [pair for pair, met in zip(self.pairs, self.meeting(q), strict=True) if met]

    def distance(self, q: Array) -> float:
        """Of the nearest pair at joints (nq,), m; below 0 where shapes pass through each other."""
        pin.computeDistances(self.body.pin, self._data, self._geometry, self._shapes, q)
        return min((float(r.min_distance) for r in self._shapes.distanceResults), default=np.inf)


def hulls_meet(one: Array, other: Array) -> bool:
    """Whether the convex hulls of corners (n, 3) and (m, 3) meet."""
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    still = coal.Transform3s.Identity()
    return bool(coal.collide(convex(one), still, convex(other), still, request, result))


def _is_body(frame: pin.Frame) -> bool:
    return bool(frame.type == pin.FrameType.BODY)
