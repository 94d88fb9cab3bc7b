"""The referee: judges an episode from ground truth alone, and touches nothing."""

from __future__ import annotations

import math
from collections.abc import Iterable
from types import MappingProxyType
from typing import Protocol

import numpy as np

from momantu_bt.geometry import Transform
from momantu_bt.world import Verdict
from momantu_worlds.scenes.bodies import Body, Box, Cylinder, Episode, Goal, Hull, Part, Picture

STILL_SPEED = 0.005
"""m/s; a resting body's speed in the solver stays below a tenth of it."""
STILL_TURN = 0.05
"""rad/s."""
GRIPPER_LINK = "gripper"
"""Robot links whose names hold this word are the gripper's."""


class TouchingForce(Protocol):
    """Two things that touched; the robot's links come first. force: N, averaged over the tick."""

    @property
    def first(self) -> str:
        """Name of a robot's link, or of a body."""
        ...

    @property
    def second(self) -> str:
        """Name of a body."""
        ...

    @property
    def force(self) -> float:
        """N."""
        ...


class GroundTruth(Protocol):
    """What a simulator must tell a referee."""

    @property
    def robot_links(self) -> frozenset[str]:
        """Names of the robot's links."""
        ...

    def pose(self, body: str) -> Transform:
        """`map_from_body`."""
        ...

    def speed(self, body: str) -> tuple[float, float]:
        """m/s and rad/s."""
        ...

    def link(self, name: str) -> Transform:
        """`map_from_link`."""
        ...

    def watch_contacts(self) -> None:
        """Collect contacts from the next tick on."""
        ...

    def contacts(self) -> Iterable[TouchingForce]:
        """What touched during the last tick."""
        ...


def tilt_of(pose: Transform) -> float:
    """Angle between a body's z axis and the vertical, rad."""
    return math.acos(max(-1.0, min(1.0, float(pose.rotation[2, 2]))))
