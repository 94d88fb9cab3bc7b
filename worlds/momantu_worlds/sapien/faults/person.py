"""person.in_way: someone stands before the robot for a while."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.sapien.faults.floor_space import walls_between
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.catalogue.person import DEPTH, person_body
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.prisms import body_prism

DISTANCE = 1.0
"""Distance from the centre of the base to the person's chest, m."""
TURNS = tuple(math.radians(turn) for turn in (0, 15, -15, 30, -30, 45, -45))
"""Directions that are tried, rad: straight ahead first, then to the sides."""
FARTHER = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Additional distances that are tried, m."""
ASIDE = 0.3
"""Least gap to the robot and its held object, m."""
FROM_THINGS = 0.03
"""Least gap to everything else, m."""


class PersonInWay:
    """A standing figure that lasers and cameras see; it is removed at the end."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._fault = stage, fault
        self._added: str | None = None

    def begin(self) -> None:
        """Add the figure where the robot drives to; FaultError while there is no room."""
        for farther in FARTHER:
            for turn in TURNS:
                body = self._figure(turn, DISTANCE + farther)
                if self._clear(body):
                    self._added = self._stage.add(body)
                    return
        raise FaultError(f"{self._fault.name}: there is no room for a person before the robot")

    def end(self) -> None:
        """Remove the figure."""
        if self._added is not None:
            self._stage.remove(self._added)
            self._added = None

    def _figure(self, turn: float, distance: float) -> Body:
        """A figure that faces the robot; behind the robot while that backs up."""
        backwards = self._stage.simulator.robot.base.linear < 0.0
        heading = Pose2D(0.0, 0.0, turn + (math.pi if backwards else 0.0))
        away = Pose2D(distance + DEPTH / 2, 0.0, math.pi)
        pose = self._stage.base() @ heading @ away
        return person_body("person", pose)

    def _clear(self, figure: Body) -> bool:
        prism = body_prism(figure, figure.map_from_body)
        assert prism is not None
        stage = self._stage
        near = [*stage.robot_prisms(), *([stage.item_prism()] if stage.held() else [])]
        base, at = stage.base(), prism.base.pose
        return (
            prism.clear_of(near, ASIDE)
            and prism.clear_of(stage.prisms(), FROM_THINGS)
            and not walls_between(stage, (base.x, base.y), (at.x, at.y))
        )
