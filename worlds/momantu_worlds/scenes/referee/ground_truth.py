"""Ground truth: what a referee reads from a simulator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from momantu_bt.geometry import Array, Transform


class TouchingForce(Protocol):
    """Bodies or links in contact; the robot's links come first. force: N, mean over the tick."""

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
    """Speed of a joint. linear: the joint slides, so the speed is in m/s, not rad/s."""

    @property
    def speed(self) -> float:
        """Never negative."""
        ...

    @property
    def linear(self) -> bool:
        """Whether it is in m/s."""
        ...


class GroundTruth(Protocol):
    """True poses, contacts, and the robot's speeds."""

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
        """Start collecting contacts at the next tick."""
        ...

    def contacts(self) -> Iterable[TouchingForce]:
        """Contacts during the last tick."""
        ...

    def height_below(self, body: str, points: Array, /) -> tuple[float, str]:
        """Height of the lowest of points (n, 3) above what is under them, m, and its name."""
        ...

    def base_speed(self) -> tuple[float, float]:
        """Current speed of the base, m/s and rad/s."""
        ...

    def joint_speeds(self) -> Mapping[str, JointSpeed]:
        """Speeds of the joints of arm, head and gripper during the last tick, by name."""
        ...
