"""Ground truth: what a simulator tells a referee."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from momantu_bt.geometry import Array, Transform


class TouchingForce(Protocol):
    """Two things that touched; the robot's links come first. force: N, averaged over the tick."""

    @property
    def first(self) -> str:
        """Name of a robot's link, or of a body."""
        ...

    @property
    def second(self) -> str:
        """Name of a body or of a link."""
        ...

    @property
    def force(self) -> float:
        """N."""
        ...


class JointSpeed(Protocol):
    """How fast a joint moves. linear: whether it slides, so that the speed is in m/s, not rad/s."""

    @property
    def speed(self) -> float:
        """Never negative."""
        ...

    @property
    def linear(self) -> bool:
        """Whether it is in m/s."""
        ...


class GroundTruth(Protocol):
    """Where everything really is, what touches what, and how fast the robot moves."""

    @property
    def robot_links(self) -> frozenset[str]:
        """Names of the robot's links."""
        ...

    def pose(self, body: str, /) -> Transform:
        """`map_from_body`."""
        ...

    def link(self, name: str, /) -> Transform:
        """`map_from_link`."""
        ...

    def watch_contacts(self) -> None:
        """Collect contacts from the next tick on."""
        ...

    def contacts(self) -> Iterable[TouchingForce]:
        """What touched during the last tick."""
        ...

    def height_below(self, body: str, points: Array, /) -> tuple[float, str]:
        """Height of the lowest of points (n, 3) above what lies under them, m, and its name."""
        ...

    def base_speed(self) -> tuple[float, float]:
        """Of the base now, m/s and rad/s."""
        ...

    def joint_speeds(self) -> Mapping[str, JointSpeed]:
        """Of the joints of arm, head and gripper now, by name."""
        ...
