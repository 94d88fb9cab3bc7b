"""People in a simulation: they walk between its ticks, and their bodies follow."""

from __future__ import annotations

import sapien

from momantu_bt.geometry import Pose2D
from momantu_bt.world import TICK
from momantu_worlds.people.floor import PeopleFloor
from momantu_worlds.people.walker import Point, Seen, Walker
from momantu_worlds.sapien.config import SUB_STEPS
from momantu_worlds.sapien.poses import pose_of
from momantu_worlds.sapien.robot_room import RobotRoom
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.scenes.catalogue.person import CLOTHES, person_body
from momantu_worlds.scenes.geometry.bodies import Color
from momantu_worlds.scenes.geometry.plane import Rectangle

WATCHED = 3.0
"""Distance from the robot's base within which people look at its links, m."""


class Crowd:
    """Walks all people of a simulation. The earlier of two people has the right of way."""

    def __init__(self, simulator: Simulator, floor: PeopleFloor) -> None:
        """Begin without anybody, and move with the simulator's ticks from now on."""
        self.simulator, self.floor = simulator, floor
        self.walkers: list[Walker] = []
        self._room = RobotRoom(simulator.model)
        self._groups: list[str] = []
        self._from: list[Pose2D] = []
        self._to: list[Pose2D] = []
        simulator.before_tick.append(self._plan)
        simulator.before_step.append(self._move)

    @property
    def names(self) -> frozenset[str]:
        """Names of everybody's body."""
        return frozenset(walker.name for walker in self.walkers)

    def join(self, walker: Walker, group: str, color: Color = CLOTHES) -> None:
        """Let somebody walk from now on. group: those who do not give way to each other."""
        self.simulator.add(person_body(walker.name, walker.pose, color))
        self.walkers.append(walker)
        self._groups.append(group)
        self._from.append(walker.pose)
        self._to.append(walker.pose)

    def leave(self, name: str) -> None:
        """Take somebody away; KeyError if nobody has that name."""
        self.simulator.remove(name)
        number = [walker.name for walker in self.walkers].index(name)
        for each in (self.walkers, self._groups, self._from, self._to):
            del each[number]

    def _plan(self) -> None:
        """Decide where everybody is at the end of the next tick."""
        now, base = self.simulator.now(), self.simulator.truth.base()
        self._from = [walker.pose for walker in self.walkers]
        near = any(pose.distance_to(base) < WATCHED for pose in self._from)
        robot = [prism.base for prism in self._room.prisms(base)] if near else []
        for number, walker in enumerate(self.walkers):
            walker.advance(now, TICK, self._seen(number, robot, (base.x, base.y)))
        self._to = [walker.pose for walker in self.walkers]

    def _move(self, index: int) -> None:
        """Move everybody's body in one physics step of the tick, at an even speed."""
        share = (index + 1) / SUB_STEPS
        for walker, a, b in zip(self.walkers, self._from, self._to, strict=True):
            here = a.inverse() @ b
            pose = a @ Pose2D(here.x * share, here.y * share, here.yaw * share)
            entity = self.simulator.truth.entity(walker.name)
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
