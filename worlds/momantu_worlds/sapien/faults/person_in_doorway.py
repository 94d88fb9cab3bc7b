"""person.in_doorway: somebody stops in the next doorway on the robot's path."""

from __future__ import annotations

import math

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.people.walker import Point, Walker
from momantu_worlds.sapien.faults.doorways import doorways_ahead, opening
from momantu_worlds.sapien.faults.figures import Person, has_room
from momantu_worlds.scenes.geometry.bodies import Actor

ASIDE = 0.6
"""Least gap to the robot, m: nobody steps into a doorway that it is about to pass."""
SPEED = (0.8, 0.8)
"""m/s; the figure only steps back."""


class PersonInDoorway(Person):
    """Somebody who looks at the robot and lets it come."""

    def _walker(self) -> Walker:
        for gap in doorways_ahead(self._stage):
            walker = self._standing(opening(self._stage, gap).middle)
            if has_room(self._stage, walker, ASIDE):
                return walker
        raise FaultError(f"{self._fault.name}: the robot is too near to every doorway")

    def _standing(self, at: Point) -> Walker:
        base, draw = self._stage.base(), self._stage.random(self._fault)
        actor = Actor(self._stage.free_name("person"), (), SPEED, (0.0, 0.0))
        walker = Walker(actor, self._stage.crowd.floor, at, draw)
        walker.pose = Pose2D(*at, math.atan2(base.y - at[1], base.x - at[0]))
        return walker
