"""doorway.blocked: a crate stands in the next doorway on the robot's path."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.sapien.faults.doorways import HEIGHT, doorways_ahead, opening
from momantu_worlds.sapien.faults.parameters import only
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.catalogue.furniture import furniture
from momantu_worlds.scenes.geometry.bodies import Body, Gap
from momantu_worlds.scenes.geometry.prisms import body_prism

DEPTH = 0.45
"""Depth of the crate along the passage, m; it is as high as what counts as a jamb."""
SLIT = 0.1
"""Width of the doorway that stays open, m, both sides together."""
ASIDE = 0.3
"""Least gap to the robot, m: a doorway that is nearer is not blocked."""


class DoorwayBlocked:
    """A static crate that lasers and cameras see; it is removed at the end."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """No parameters."""
        only(fault)
        self._stage, self._fault = stage, fault
        self._added: str | None = None

    def begin(self) -> None:
        """Add the crate; FaultError if the robot stands in every doorway in question."""
        for gap in doorways_ahead(self._stage):
            body = self._crate(gap)
            if self._clear(body):
                self._added = self._stage.add(body)
                return
        raise FaultError(f"{self._fault.name}: the robot is too near to every doorway")

    def end(self) -> None:
        """Remove the crate."""
        if self._added is not None:
            self._stage.remove(self._added)
            self._added = None

    def _crate(self, gap: Gap) -> Body:
        free = opening(self._stage, gap)
        size = (DEPTH, free.width - SLIT, HEIGHT)
        pose = Pose2D(*free.middle, free.across - math.pi / 2).transform()
        return Body("blocking_crate", "crate", pose, furniture("crate", size))

    def _clear(self, crate: Body) -> bool:
        prism = body_prism(crate, crate.map_from_body)
        assert prism is not None
        stage = self._stage
        return prism.clear_of(stage.robot_prisms(), ASIDE) and prism.clear_of(stage.prisms(), 0.0)
