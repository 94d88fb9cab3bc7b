"""person.follows: somebody walks behind the robot for a while, and stands when it stands."""

from __future__ import annotations

import math

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.people.walker import BEHIND, Follower, Point, Walker
from momantu_worlds.sapien.faults.figures import Person, has_room
from momantu_worlds.sapien.faults.floor_space import walls_between
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.geometry.bodies import Actor

TURNS = tuple(math.radians(turn) for turn in (180, 150, -150, 120, -120, 90, -90))
"""Directions from the robot that are tried at first, rad: straight behind it, then aside."""
FARTHER = (0.4, 0.8, 1.2, 1.6)
"""Distances beyond a pace behind that are tried at first, m."""
ASIDE = 0.4
"""Least gap to the robot at first, m."""
SPEED = (1.2, 1.2)
"""m/s; who follows walks a little faster than the robot, and no faster than this."""


class PersonFollows(Person):
    """Somebody who keeps a pace behind the robot."""

    def _walker(self) -> Walker:
        base = self._stage.base()
        for farther in FARTHER:
            for turn in TURNS:
                at = base @ Pose2D(0.0, 0.0, turn) @ Pose2D(BEHIND + farther, 0.0)
                walker = self._follower((at.x, at.y))
                if self._clear(walker, base):
                    return walker
        raise FaultError(f"{self._fault.name}: there is no room for a person behind the robot")

    def _clear(self, walker: Walker, base: Pose2D) -> bool:
        stage = self._stage
        return (
            stage.crowd.floor.free(walker.at)
            and has_room(stage, walker, ASIDE)
            and not walls_between(stage, (base.x, base.y), walker.at)
        )

    def _follower(self, at: Point) -> Walker:
        actor = Actor(self._stage.free_name("follower"), (), SPEED, (0.0, 0.0))
        floor, draw = self._stage.crowd.floor, self._stage.random(self._fault)
        return Follower(actor, floor, at, draw, _Robot(self._stage))


class _Robot:
    """The robot as whom somebody follows."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    @property
    def at(self) -> Point:
        base = self._stage.base()
        return base.x, base.y

    @property
    def speed(self) -> float:
        return self._stage.simulator.truth.base_speed()[0]
