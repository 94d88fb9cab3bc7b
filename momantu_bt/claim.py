"""What a skill's end claims about the world, in words that ground truth can judge.

A skill that succeeds says "I hold it", "it stands there". `Skill.claim` gives that sentence as a
value; a world that knows the truth judges it after the skill has ended. Neither the skill nor the
tree ever learns the answer: it is counted for people.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeAlias, runtime_checkable

from momantu_bt.geometry import Pose2D, Transform


@dataclass(frozen=True, slots=True)
class ObjectAt:
    """An object of the category is at `odom_from_object`, within `tolerance` m, standing."""

    category: str
    odom_from_object: Transform
    tolerance: float


@dataclass(frozen=True, slots=True)
class ObjectOn:
    """An object of the category stands on the site's surface of that name (None: on any)."""

    category: str
    surface: str | None = None


@dataclass(frozen=True, slots=True)
class TagAt:
    """The AprilTag of that id is at `odom_from_tag`, within m and rad."""

    tag_id: int
    odom_from_tag: Transform
    tolerance: float
    turn_tolerance: float


@dataclass(frozen=True, slots=True)
class TagSeen:
    """The AprilTag of that id lies whole and uncovered somewhere in the world."""

    tag_id: int


@dataclass(frozen=True, slots=True)
class PlaneAt:
    """There is a horizontal top at the origin of `odom_from_plane`, within `tolerance` m."""

    odom_from_plane: Transform
    tolerance: float


@dataclass(frozen=True, slots=True)
class BaseAt:
    """The base is at the pose in the map, within m and rad."""

    map_from_base: Pose2D
    tolerance: float
    turn_tolerance: float


@dataclass(frozen=True, slots=True)
class BaseNear:
    """The base is within `distance` m of the point (x, y) in odom, along the floor."""

    odom_point: tuple[float, float]
    distance: float


@dataclass(frozen=True, slots=True)
class Holding:
    """Something that can be brought is between the fingers, off every surface; or nothing is."""

    something: bool


@dataclass(frozen=True, slots=True)
class SetDown:
    """What was held stands upright on a surface, and the hand does not touch it."""


@dataclass(frozen=True, slots=True)
class JointsAt:
    """The named joints are at these positions (rad, m), within `tolerance`."""

    names: tuple[str, ...]
    positions: tuple[float, ...]
    tolerance: float


Claim: TypeAlias = (
    ObjectAt
    | ObjectOn
    | TagAt
    | TagSeen
    | PlaneAt
    | BaseAt
    | BaseNear
    | Holding
    | SetDown
    | JointsAt
)


@runtime_checkable
class Judge(Protocol):
    """A world that can tell whether a claim is true."""

    def judge(self, claim: Claim) -> bool | None:
        """Whether it is true of this instant; None when this world cannot tell."""
        ...
