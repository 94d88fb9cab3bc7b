"""Collision checks of the robot and its held object, with itself and the surroundings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product

import coal
import numpy as np
import pinocchio as pin

from momantu_bt.geometry import Array, Transform
from momantu_skills.manipulation.model.arm_model import ArmModel
from momantu_skills.manipulation.model.hulls import convex
from momantu_skills.manipulation.model.shapes import BodyShapes

FLOOR = 0.01
"""Height of the top of the floor's box, m: no moving link belongs below it."""
SAMPLES = 200
"""Random postures for finding pairs of links that always touch."""
SELF_MARGIN = 0.008
"""Clearance between the robot's own links on free motions, m, as a path is checked at points
only."""
ALWAYS = 0.95
"""Share of the postures in which a pair must touch to count as always overlapping."""


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A convex solid: corners (n, 3) in base, m. support: the held object may touch it."""

    name: str
    corners: Array
    support: bool = False


@dataclass(frozen=True, eq=False)
class Cells:
    """Occupied cubes of one size: their centres (n, 3) in a frame of their own, and their edge, m.

    The frame's axes run along the edges, and its origin is a corner of the raster. doubt: how much
    nearer they may be, m.
    """

    name: str
    centres: Array
    edge: float
    base_from_cells: Transform
    doubt: float = 0.0


@dataclass(frozen=True, eq=False)
class Attached:
    """The held object: corners (n, 3) of its hull in the tip's frame, m."""

    corners: Array


class BodyPairs:
    """The robot's own shapes, and the pairs of links that need checks."""

    def __init__(self, model: ArmModel) -> None:
        self.model = model
        self.shapes = BodyShapes(model.pin, model.hulls, model.urdf.parts)
        self.geometry, self.links = self.shapes.geometry, self.shapes.links
        self.moving = self._moving_links()
        self.pairs = self._sometimes_apart(self._worthwhile())
        self.close = self._always_close()

    def _moving_links(self) -> tuple[str, ...]:
        first = min(int(self.model.pin.getJointId(name)) for name in self.model.group.names)
        below = set(self.model.pin.subtrees[first])
        return tuple(link for link in self.model.hulls if self.shapes.joint(link) in below)

    def _worthwhile(self) -> list[tuple[int, int]]:
        ignored = {frozenset(pair) for pair in self.model.description.ignored_collisions}
        return [
            pair
            for one, other in combinations(self.model.hulls, 2)
            for pair in self.shapes.pairs(one, other)
            if frozenset((one, other)) not in ignored
            and not self.shapes.adjacent(one, other)
            and (one in self.moving or other in self.moving)
        ]

    def _sometimes_apart(self, pairs: list[tuple[int, int]]) -> tuple[tuple[int, int], ...]:
        geometry = self.geometry.copy()
        for a, b in pairs:
            geometry.addCollisionPair(pin.CollisionPair(a, b))
        data, shapes = self.model.pin.createData(), geometry.createData()
        random = np.random.default_rng(0)
        lower = np.maximum(self.model.pin.lowerPositionLimit, -np.pi)
        upper = np.minimum(self.model.pin.upperPositionLimit, np.pi)
        touching = np.zeros(len(pairs))
        for _ in range(SAMPLES):
            q = random.uniform(lower, upper)
            pin.computeCollisions(self.model.pin, data, geometry, shapes, q, False)
            touching += [result.isCollision() for result in shapes.collisionResults]
        return tuple(p for p, n in zip(pairs, touching, strict=True) if n < ALWAYS * SAMPLES)

    def _always_close(self) -> frozenset[tuple[int, int]]:
        """Pairs of `pairs` nearer than SELF_MARGIN in a named pose, with the hand shut or open."""
        geometry = self.geometry.copy()
        for a, b in self.pairs:
            geometry.addCollisionPair(pin.CollisionPair(a, b))
        data, shapes = self.model.pin.createData(), geometry.createData()
        for index in range(len(self.pairs)):
            shapes.collisionRequests[index].security_margin = SELF_MARGIN
        close: set[tuple[int, int]] = set()
        effector = self.model.description.end_effector
        widths = (0.0,) if effector is None else (0.0, effector.max_width)
        for pose, width in product(self.model.description.named_poses.values(), widths):
            q = self.model.posture(pose, width)
            pin.computeCollisions(self.model.pin, data, geometry, shapes, q, False)
            results = zip(self.pairs, shapes.collisionResults, strict=True)
            close |= {pair for pair, result in results if result.isCollision()}
        return frozenset(close)


@lru_cache(maxsize=4)
def body_pairs(model: ArmModel) -> BodyPairs:
    """Return the shapes and pairs of a model; built once per process."""
    return BodyPairs(model)


class CollisionWorld:
    """Collision checks for one situation: other joints, surroundings, held object.

    cells: occupied cubes. margin: clearance to surroundings, m. held_on_support: the held object
    may touch obstacles that are supports.
    """

    def __init__(
        self,
        body: BodyPairs,
        posture: Array,
        obstacles: Sequence[Obstacle] = (),
        cells: Sequence[Cells] = (),
        attached: Attached | None = None,
        margin: float = 0.0,
        held_on_support: bool = False,
    ) -> None:
        self.body = body
        self.checks = 0
        self._pin = body.model.pin
        self._data = self._pin.createData()
        self._geometry = body.geometry.copy()
        self._q = np.array(posture)
        self._index = body.model.group_index
        around = {obstacle.name: self._add_obstacle(obstacle) for obstacle in obstacles}
        around["floor"] = self._add_floor()
        around |= {some.name: self._add_cells(some) for some in cells if len(some.centres)}
        pairs = list(body.pairs)
        doubts = {some.name: margin + some.doubt for some in cells}
        moving = [shape for link in body.moving for shape in body.links[link]]
        near = [(shape, n, doubts.get(n, margin)) for shape in moving for n in around]
        if attached is not None:
            held = self._attach(attached)
            supports = {o.name for o in obstacles if o.support and held_on_support}
            near += [(held, n, doubts.get(n, margin)) for n in around if n not in supports]
            pairs += [(held, shape) for shape in self._strangers()]
        self._finish(pairs, [((shape, around[n]), gap) for shape, n, gap in near], margin)

    def _finish(
        self,
        pairs: Iterable[tuple[int, int]],
        near: Iterable[tuple[tuple[int, int], float]],
        margin: float,
    ) -> None:
        own = min(margin, SELF_MARGIN)
        kept = [(pair, 0.0 if pair in self.body.close else own) for pair in pairs]
        kept += near
        for (a, b), _ in kept:
            self._geometry.addCollisionPair(pin.CollisionPair(a, b))
        self._shapes = self._geometry.createData()
        for index, (_, clearance) in enumerate(kept):
            self._shapes.collisionRequests[index].security_margin = clearance
        self._manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            self._pin, self._geometry, self._shapes
        )

    def free(self, q: Array) -> bool:
        """Whether the robot touches nothing at joints (n,) of the planning group."""
        self.checks += 1
        self._q[self._index] = q
        self.body.model.follow(self._q)
        return not pin.computeCollisions(self._pin, self._data, self._manager, self._q, True)

    def path_free(self, path: Array) -> bool:
        """Whether the robot touches nothing at each of joints (k, n)."""
        return all(self.free(q) for q in path)

    def touching(self, q: Array) -> list[tuple[str, str]]:
        """Names of all touching pairs at joints (n,), for messages and tests."""
        self._q[self._index] = q
        self.body.model.follow(self._q)
        pin.computeCollisions(self._pin, self._data, self._geometry, self._shapes, self._q, False)
        objects = self._geometry.geometryObjects
        return [
            (str(objects[int(pair.first)].name), str(objects[int(pair.second)].name))
            for pair, result in zip(
                self._geometry.collisionPairs, self._shapes.collisionResults, strict=True
            )
            if result.isCollision()
        ]

    def _add_obstacle(self, obstacle: Obstacle) -> int:
        return self._add(obstacle.name, convex(obstacle.corners), pin.SE3.Identity())

    def _add_floor(self) -> int:
        place = pin.SE3(np.eye(3), np.array([0.0, 0.0, FLOOR - 0.05]))
        return self._add("floor", coal.Box(4.0, 4.0, 0.1), place)

    def _add_cells(self, cells: Cells) -> int:
        tree = coal.makeOctree(np.ascontiguousarray(cells.centres), cells.edge)
        pose = cells.base_from_cells
        return self._add(cells.name, tree, pin.SE3(pose.rotation, np.array(pose.position)))

    def _add(self, name: str, shape: coal.CollisionGeometry, place: pin.SE3) -> int:
        return int(self._geometry.addGeometryObject(pin.GeometryObject(name, 0, 0, place, shape)))

    def _attach(self, attached: Attached) -> int:
        model = self.body.model
        tip = model.frame_ids[model.description.hand.frame]
        frame = model.pin.frames[tip]
        shape = pin.GeometryObject(
            "held", frame.parentJoint, tip, frame.placement, convex(attached.corners)
        )
        return int(self._geometry.addGeometryObject(shape))

    def _strangers(self) -> list[int]:
        """Shapes of the links that the held object must not touch: all except the hand."""
        touch = self.body.model.description.hand.touch_links
        links = self.body.links
        return [shape for link, shapes in links.items() if link not in touch for shape in shapes]
