"""What a skill's end claims about the world, in words that ground truth can judge.

A skill that succeeds says "I hold it", "it stands there". `Skill.claim` gives that sentence as a
value; a world that knows the truth judges it at the instant at which the skill ended. Neither the
skill nor the tree ever learns the answer: it is counted for people.

Poses in odom are what the robot believes. A judge converts them to the world with the base's true
pose and the odometry of the same instant, so drift of odometry does not make a claim false.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeAlias, runtime_checkable

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import ObjectClass
from momantu_bt.tags import USUAL_FAMILY


@dataclass(frozen=True, slots=True)
class ObjectAt:
    """An object of this class stands with its box's centre within `tolerance` m of the pose.

    Where the pose's z axis is more level than upright, the object lies along it. asked: its
    category, and the sizes that were asked for.
    """

    asked: ObjectClass
    odom_from_object: Transform
    tolerance: float


@dataclass(frozen=True, slots=True)
class ObjectOn:
    """An object of this class stands on the named surface of the site (None: on any)."""

    asked: ObjectClass
    surface: str | None = None


@dataclass(frozen=True, slots=True)
class TagAt:
    """The AprilTag of that id is at `odom_from_tag`, its z out of the tag, within m and rad."""

    tag_id: int
    odom_from_tag: Transform
    tolerance: float
    turn_tolerance: float
    family: str = USUAL_FAMILY


@dataclass(frozen=True, slots=True)
class TagOn:
    """The AprilTag with this id lies uncovered on the named surface of the site (None: on any)."""

    tag_id: int
    surface: str | None = None
    family: str = USUAL_FAMILY


@dataclass(frozen=True, slots=True)
class PlaneAt:
    """There is a horizontal top at the origin of `odom_from_plane`, within `tolerance` m."""

    odom_from_plane: Transform
    tolerance: float


@dataclass(frozen=True, slots=True)
class RoomAt:
    """A round base of `radius` m has room on a top at the point (x, y, z) in odom.

    The whole base would stand on the top and touch nothing that stands there. within: greatest
    distance of the room from the point, along the floor, m. tolerance: of the top's height, m.
    """

    odom_point: tuple[float, float, float]
    radius: float
    tolerance: float
    within: float = 0.0


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
class CameraOn:
    """The camera of that optical frame looks at the point (x, y, z) in odom, within rad."""

    frame: str
    odom_point: tuple[float, float, float]
    turn_tolerance: float


@dataclass(frozen=True, slots=True)
class CameraAt:
    """The camera of that optical frame is at the pose in the map, within m and rad."""

    frame: str
    map_from_camera: Transform
    tolerance: float
    turn_tolerance: float


@dataclass(frozen=True, slots=True)
class Holding:
    """Something that can be brought is between the fingers, off every surface; or nothing is."""

    something: bool


@dataclass(frozen=True, slots=True)
class GripperOpen:
    """The gripper's pads are at least `width` m apart."""

    width: float


@dataclass(frozen=True, slots=True)
class SetDown:
    """A loose object stands upright there, or lies as the pose does, and not between the fingers.

    odom_from_object: the centre of its box, within `tolerance` m; its z axis is the object's.
    """

    odom_from_object: Transform
    tolerance: float


@dataclass(frozen=True, slots=True)
class JointsAt:
    """The named joints are at these positions (rad, m), within `tolerance`.

    Joints that turn for ever are compared modulo whole turns.
    """

    names: tuple[str, ...]
    positions: tuple[float, ...]
    tolerance: float


Sentence: TypeAlias = (
    ObjectAt
    | ObjectOn
    | TagAt
    | TagOn
    | PlaneAt
    | RoomAt
    | BaseAt
    | BaseNear
    | CameraOn
    | CameraAt
    | Holding
    | GripperOpen
    | SetDown
    | JointsAt
)
"""One thing that is true or not."""

Claim: TypeAlias = Sentence | tuple[Sentence, ...]
"""One sentence, or several that are all true if the claim is."""


@runtime_checkable
class Judge(Protocol):
    """A world that can judge whether a claim is true."""

    def judge(self, sentence: Sentence, odom_from_base: Transform) -> bool | None:
        """Whether the claim is true at this moment; None when this world cannot judge it.

        odom_from_base: the robot's odometry of this instant, as skills see it.
        """
        ...
