"""The people of an episode: they walk between the world's ticks, and their bodies follow."""

from __future__ import annotations

import math
from collections.abc import Sequence

from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.world import TICK, WorldError, seeded
from momantu_worlds.people.floor import PeopleFloor
from momantu_worlds.people.walker import BEHIND, RADIUS, Follower, Point, Seen, Walker
from momantu_worlds.sapien.config import SUB_STEPS
from momantu_worlds.sapien.faults.robot_room import RobotRoom
from momantu_worlds.sapien.poses import pose_of
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.catalogue.person import person_body
from momantu_worlds.scenes.geometry.bodies import Actor, Episode
from momantu_worlds.scenes.geometry.plane import Rectangle

with lazily():  # after `momantu_worlds.sapien`, which looks for a Vulkan driver first
    import sapien

WATCHED = 3.0
"""Distance from the robot's base within which people look at its links, m."""
FROM_START = 1.5
"""Least distance of a person from the robot at first, m."""
RING = 16
"""Directions around the first of a group in which the others are put."""


class Crowd:
    """Walks all people of an episode. Each tick: `plan` before its physics, `move` in each step.

    The earlier of two people has the right of way.
    """

    def __init__(self, simulator: Simulator, episode: Episode, seed: int) -> None:
        """Put everybody on a stop; WorldError if there is no room for somebody."""
        self._simulator, self._room = simulator, RobotRoom(simulator.model)
        self._floor = PeopleFloor(
            episode.bodies, [stop for actor in episode.actors for stop in actor.stops]
        )
        self._start = (episode.start.x, episode.start.y)
        self.walkers: list[Walker] = []
        self._groups = [actor.name for actor in episode.actors for _ in range(actor.group)]
        for actor in episode.actors:
            self._admit(actor, seed)
        for walker, color in zip(self.walkers, self._colors(episode.actors), strict=True):
            simulator.add(person_body(walker.name, walker.pose, color))
        self._from = self._to = [walker.pose for walker in self.walkers]

    @property
    def names(self) -> frozenset[str]:
        """Names of everybody's body."""
        return frozenset(walker.name for walker in self.walkers)

    def plan(self) -> None:
        """Decide where everybody is at the end of the next tick."""
        now, base = self._simulator.now(), self._simulator.truth.base()
        self._from = [walker.pose for walker in self.walkers]
        near = any(pose.distance_to(base) < WATCHED for pose in self._from)
        robot = [prism.base for prism in self._room.prisms(base)] if near else []
        for number, walker in enumerate(self.walkers):
            walker.advance(now, TICK, self._seen(number, robot, (base.x, base.y)))
        self._to = [walker.pose for walker in self.walkers]

    def move(self, index: int) -> None:
        """Move everybody's body in one physics step of the tick, at an even speed."""
        share = (index + 1) / SUB_STEPS
        for walker, a, b in zip(self.walkers, self._from, self._to, strict=True):
            here = a.inverse() @ b
            pose = a @ Pose2D(here.x * share, here.y * share, here.yaw * share)
            entity = self._simulator.truth.entity(walker.name)
            part = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
            part.set_kinematic_target(pose_of(pose.transform()))

    def _seen(self, number: int, robot: list[Rectangle], base: Point) -> Seen:
        own = self._groups[number]
        others = list(enumerate(zip(self.walkers, self._groups, strict=True)))
        return Seen(
            robot,
            base,
            [each.at for k, (each, group) in others if k < number and group != own],
            [each.at for k, (each, group) in others if k > number and group != own],
            [each.at for k, (each, group) in others if k != number and group == own],
        )

    def _admit(self, actor: Actor, seed: int) -> None:
        random = seeded(seed, "actor", actor.name)
        stops = [self._floor.stop(stop) for stop in actor.stops]
        for number, (stop, wanted) in enumerate(zip(stops, actor.stops, strict=True), 1):
            if stop is None:
                raise WorldError(
                    f"the actor {actor.name!r} cannot stand at its stop {number}, ({wanted[0]:g}, "
                    f"{wanted[1]:g}): no free floor within half a metre; move the stop, or what "
                    "stands there"
                )
        free = [stop for stop in stops if stop is not None]
        able = Actor(actor.name, tuple(free), actor.speed, actor.pause, actor.group, actor.color)
        begins = [stop for stop in free if math.dist(stop, self._start) > FROM_START]
        begins = [stop for stop in begins if self._apart(stop)]
        if not begins:
            raise WorldError(
                f"the actor {actor.name!r} has no stop to begin at: each is within {FROM_START:g} "
                "m of the robot, or somebody stands there; give it another stop"
            )
        first = begins[int(random.integers(len(begins)))]
        leader = Walker(able, self._floor, first, random)
        self.walkers.append(leader)
        for number in range(2, actor.group + 1):
            name = f"{actor.name}_{number}"
            member = Actor(name, able.stops, able.speed, able.pause, 1, able.color)
            place = self._beside(leader.at, actor.name)
            draw = seeded(seed, "actor", name)
            self.walkers.append(Follower(member, self._floor, place, draw, self.walkers[-1]))

    def _beside(self, point: Point, name: str) -> Point:
        for away in (BEHIND, 1.5 * BEHIND, 2.0 * BEHIND, 3.0 * BEHIND):
            for k in range(RING):
                turn = 2.0 * math.pi * k / RING
                there = (point[0] + away * math.cos(turn), point[1] + away * math.sin(turn))
                apart = math.dist(there, self._start) > FROM_START and self._apart(there)
                if apart and self._floor.free(there):
                    return there
        raise WorldError(f"there is no room for the group of the actor {name!r} at its first stop")

    def _apart(self, point: Point) -> bool:
        return all(math.dist(point, walker.at) > 3 * RADIUS for walker in self.walkers)

    @staticmethod
    def _colors(actors: Sequence[Actor]) -> list[tuple[float, float, float]]:
        return [actor.color for actor in actors for _ in range(actor.group)]
