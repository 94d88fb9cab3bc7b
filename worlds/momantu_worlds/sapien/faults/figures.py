"""People whom a fault brings: somebody who stands where there is room, until the fault ends."""

from __future__ import annotations

from momantu_bt.fault import Fault
from momantu_worlds.people.walker import Walker
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.catalogue.person import person_body
from momantu_worlds.scenes.geometry.prisms import body_prism


class Person:
    """A figure that lasers and cameras see, and that steps back from the robot."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._fault = stage, fault
        self._admitted: str | None = None

    def begin(self) -> None:
        """Let somebody come; FaultError while there is no room."""
        walker = self._walker()
        self._stage.admit(walker)
        self._admitted = walker.name

    def end(self) -> None:
        """Remove the figure."""
        if self._admitted is not None:
            self._stage.dismiss(self._admitted)
            self._admitted = None

    def _walker(self) -> Walker:
        """Who comes, and where to; FaultError while there is no room."""
        raise NotImplementedError(f"{type(self).__name__} has no _walker()")


def has_room(stage: Stage, walker: Walker, aside: float) -> bool:
    """Whether somebody meets nothing where they stand, and keeps `aside` m from the robot."""
    figure = person_body(walker.name, walker.pose)
    prism = body_prism(figure, figure.map_from_body)
    assert prism is not None
    return prism.clear_of(stage.robot_prisms(), aside) and prism.clear_of(stage.prisms(), 0.0)
