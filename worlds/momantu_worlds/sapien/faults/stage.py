"""What effects work on: the simulator, the episode, its goal and the referee."""

from __future__ import annotations

import dataclasses
from itertools import chain, count
from typing import TYPE_CHECKING

import numpy as np

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.robot import RobotDescription
from momantu_bt.world import seeded
from momantu_worlds.people.floor import PeopleFloor
from momantu_worlds.people.walker import Walker
from momantu_worlds.sapien.crowd import Crowd
from momantu_worlds.sapien.robot_room import RobotRoom
from momantu_worlds.scenes.catalogue.person import CATEGORY as FIGURE
from momantu_worlds.scenes.geometry.bodies import Body, Episode, Gap, Goal, Picture
from momantu_worlds.scenes.geometry.prisms import Prism, body_prism, part_prisms
from momantu_worlds.scenes.geometry.support import UprightCylinder

if TYPE_CHECKING:
    from momantu_worlds.sapien.simulator import Simulator
    from momantu_worlds.scenes.referee.referee import Referee

IN_HAND = 0.03
"""Distance from the centre between the pads to the item, m, below which the item is between the
fingers."""

LIFTED = 0.01
"""Least height of a held object above what is below it, m."""
WALL = "wall"
"""Category of what bounds the rooms."""
OUTDOORS = 10.0
"""How far people walk from the robot's start where no walls stand, along x and y, m."""


class Stage:
    """Ground truth, and the means to change it.

    simulator, episode, description, referee (None in a run without one), crowd (None where nobody
    walks about): of this run.
    """

    def __init__(
        self,
        simulator: Simulator,
        episode: Episode,
        description: RobotDescription,
        seed: int,
        referee: Referee | None,
        crowd: Crowd | None = None,
    ) -> None:
        self.simulator, self.episode, self.description = simulator, episode, description
        self.referee = referee
        self._seed, self._crowd = seed, crowd
        self._room = RobotRoom(simulator.model)

    def random(self, fault: Fault) -> np.random.Generator:
        """Random numbers for one fault of one run; independent of everything else in the run."""
        return seeded(self._seed, "fault", fault.name)

    @property
    def goal(self) -> Goal:
        """The goal: what to bring where; FaultError in an episode without a goal."""
        if self.episode.goal is None:
            raise FaultError(f"the world {self.episode.name!r} has no goal, so no object to break")
        return self.episode.goal

    @property
    def item(self) -> Body:
        """The item, as at the start of the episode."""
        return self.episode.body(self.goal.item)

    @property
    def marker(self) -> Body:
        """The tag beside which the item is to be placed; FaultError if the goal has no such tag."""
        if self.goal.marker is None:
            raise FaultError(f"the goal of {self.episode.name!r} names no marker")
        body = self.episode.body(self.goal.marker)
        if not any(isinstance(part.geometry, Picture) for part in body.parts):
            raise FaultError(f"the goal's marker {body.name!r} is not a picture to cover")
        return body

    @property
    def doorways(self) -> tuple[Gap, ...]:
        """Centres of the doorways; FaultError in a world without any."""
        if not self.episode.doorways:
            raise FaultError(f"the world {self.episode.name!r} has no doorways")
        return tuple(self.episode.doorways.values())

    @property
    def bodies(self) -> tuple[Body, ...]:
        """All current bodies."""
        return (*self.episode.bodies, *self.simulator.added)

    def base(self) -> Pose2D:
        """Pose of the robot."""
        return self.simulator.truth.base()

    def item_pose(self) -> Transform:
        """Pose of the item, that is of its foot: `map_from_item`."""
        return self.item.foot_at(self.simulator.truth.pose(self.goal.item))

    def item_prism(self, map_from_item: Transform | None = None) -> Prism:
        """The space that the item occupies, at its pose or at another one."""
        item = self.item
        prism = body_prism(item, item.with_foot_at(map_from_item or self.item_pose()))
        assert prism is not None  # what is brought can be touched
        return prism

    def in_hand(self) -> bool:
        """Whether the item is between the fingers, gripped or not yet."""
        if self.description.end_effector is None:
            return False
        hand = self.simulator.truth.link(self.description.hand.frame)
        return UprightCylinder(self.item).distance(self.item_pose(), hand) < IN_HAND

    def held(self) -> bool:
        """Whether the item is in the hand, lifted off every surface."""
        if self.episode.goal is None:
            return False
        foot = self.item_prism().foot()
        height, _ = self.simulator.truth.height_below(self.goal.item, foot)
        return self.in_hand() and height > LIFTED

    def robot_prisms(self, map_from_base: Pose2D | None = None) -> list[Prism]:
        """The space that the robot occupies, at its pose or with its base at another one."""
        return self._room.prisms(self.base(), map_from_base)

    def prisms(self, *without: str, categories: tuple[str, ...] = ()) -> list[Prism]:
        """The space that bodies occupy, without those named; of some categories, or of all."""
        pose = self.simulator.truth.pose
        found = (
            body_prism(body, pose(body.name))
            for body in self.bodies
            if body.name not in without and (not categories or body.category in categories)
        )
        return [prism for prism in found if prism is not None]

    def part_prisms(self, *without: str) -> list[Prism]:
        """The space that the parts of bodies occupy, without the bodies named."""
        pose = self.simulator.truth.pose
        found = (part_prisms(b, pose(b.name)) for b in self.bodies if b.name not in without)
        return list(chain.from_iterable(found))

    def move_item(self, map_from_item: Transform) -> None:
        """Move the item elsewhere, at rest; this does not count as dropped by the robot."""
        self.simulator.put(self.goal.item, self.item.with_foot_at(map_from_item))
        if self.referee is not None:
            self.referee.relocated(self.goal.item)

    def add(self, body: Body) -> str:
        """Add a body to the world; the referee watches it if it is loose, or a person.

        Returns: its name, with a number added if another body has that name.
        """
        name = self.free_name(body.name)
        body = dataclasses.replace(body, name=name)
        self.simulator.add(body)
        if self.referee is not None:
            self.referee.added(body)
            if body.category == FIGURE:
                self.referee.admitted(name)
        return name

    def free_name(self, wanted: str) -> str:
        """A name for a body: the wanted one, with a number added if another body has it."""
        names = {other.name for other in self.bodies}
        taken = (f"{wanted}_{number}" for number in count(2))
        return next(name for name in chain([wanted], taken) if name not in names)

    @property
    def crowd(self) -> Crowd:
        """The people of this run, to whom others can be added."""
        if self._crowd is None:
            start, indoors = self.episode.start, any(b.category == WALL for b in self.bodies)
            ends = [(start.x + far, start.y + far) for far in (-OUTDOORS, OUTDOORS)]
            floor = PeopleFloor(self.episode.bodies, () if indoors else ends)
            self._crowd = Crowd(self.simulator, floor)
        return self._crowd

    def admit(self, walker: Walker) -> None:
        """Let somebody walk from now on; the referee watches how hard they are pushed."""
        self.crowd.join(walker, walker.name)
        if self.referee is not None:
            self.referee.admitted(walker.name)

    def dismiss(self, name: str) -> None:
        """Take away somebody who was admitted."""
        self.crowd.leave(name)

    def remove(self, name: str) -> None:
        """Remove an added body."""
        self.simulator.remove(name)
        if self.referee is not None:
            self.referee.removed(name)
