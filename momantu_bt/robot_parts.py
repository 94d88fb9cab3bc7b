"""The parts of a robot's description, as checked values. Quantities may carry their unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, GetJsonSchemaHandler, model_validator

from momantu_bt.descriptions.field_docs import field_docs
from momantu_bt.descriptions.quantities import (
    Angle,
    AngularAcceleration,
    AngularSpeed,
    Force,
    JointAcceleration,
    JointPosition,
    JointSpeed,
    Length,
    LinearAcceleration,
    LinearSpeed,
    Rate,
    Size,
    Time,
)
from momantu_bt.geometry import Pose2D

Count: TypeAlias = Annotated[int, Field(gt=0, le=100_000)]
Range: TypeAlias = Annotated[Length, Field(ge=0)]
Correction: TypeAlias = Annotated[float, Field(ge=-0.5, le=0.5)]


class Part(BaseModel):
    """Immutable, without unknown keys; attribute docstrings describe its fields."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: Any, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The schema with the fields' docstrings; they are read now, as few programs ask."""
        made = handler(core_schema)
        fields = handler.resolve_ref_schema(made).get("properties", {})
        for name, text in field_docs(cls).items():
            if name in fields:
                fields[name].setdefault("description", text)
        return made


class ActuatorKind(StrEnum):
    """The goals that an actuator takes: BaseVelocity, joint goals, or GripperCommand."""

    BASE = "base"
    JOINTS = "joints"
    GRIPPER = "gripper"


class Actuator(Part):
    """A thing that can be commanded."""

    kind: ActuatorKind
    """What it takes: base (speeds), joints (trajectories) or gripper (an opening)."""
    joints: tuple[str, ...] = ()
    """Its joints, in the order of its trajectories."""


class JointLimit(Part):
    """Limits of one joint: rad or m, per second, per second squared."""

    lower: JointPosition | None = None
    """Least position; if not given, the joint turns without end."""
    upper: JointPosition | None = None
    """Greatest position; if not given, the joint turns without end."""
    velocity: JointSpeed
    """Greatest speed."""
    acceleration: JointAcceleration
    """Greatest acceleration."""


class Exposure(Part):
    """How a camera's colour sensor takes light: longer in the dark, then with more gain."""

    usual: Annotated[Time, Field(gt=0)] = 0.008
    """Exposure in good light: white paper under a light of 1 is just white."""
    longest: Annotated[Time, Field(gt=0)] = 0.033
    """Longest exposure: the time of one picture."""
    most_gain: Annotated[float, Field(ge=1)] = 16.0
    """Greatest gain, used where the longest exposure does not suffice; it amplifies noise too."""
    full_well: Annotated[float, Field(gt=0)] = 8000.0
    """Electrons of a white pixel at gain 1. Fewer give more shot noise."""
    read_noise: Annotated[float, Field(ge=0)] = 4.0
    """Electrons; sigma of the noise that each reading of a pixel adds."""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.longest < self.usual:
            raise ValueError(
                f"the longest exposure, {self.longest:g} s, is shorter than the usual one,"
                f" {self.usual:g} s"
            )
        return self

    @property
    def most(self) -> float:
        """How many times brighter than usual a picture can become: by time and gain together."""
        return self.longest / self.usual * self.most_gain


class CameraSensor(Part):
    """An RGB-D camera."""

    kind: Literal["camera"] = "camera"
    frame: str
    """Its optical frame: z forward, x right, y down."""
    carrier: str | None = None
    """The actuator that moves it; if not given, it is fixed to the base."""
    width: Count = 640
    """Columns of its picture."""
    height: Count = 480
    """Rows of its picture."""
    horizontal_fov: Annotated[Angle, Field(gt=0, lt=3.1)]
    """Angle between its picture's left and right border."""
    min_depth: Size
    """Nearest depth that it measures."""
    max_depth: Size
    """Farthest depth that it measures."""
    depth_noise: Annotated[float, Field(ge=0)] | None = None
    """1/m; sigma of depth z is this times z squared. Not given: usual for such cameras."""
    exposure: Exposure = Exposure()
    """How its colours take light; the defaults are those of a usual small camera."""


class LaserSensor(Part):
    """A planar laser scanner, or a scan that is made from a lidar's points."""

    kind: Literal["laser"] = "laser"
    frame: str
    """Beams lie in its x-y plane. With a source, the frame is horizontal and fixed to the base."""
    angle_min: Angle
    """Direction of the first beam."""
    angle_max: Angle
    """Direction of the last beam."""
    beams: Annotated[int, Field(ge=2, le=100_000)]
    """Number of beams; with a source, number of sectors."""
    range_min: Range
    """Nearest distance that it measures."""
    range_max: Size
    """Farthest distance that it measures."""
    source: str | None = None
    """The lidar that the scan is made from; if not given, the laser is a scanner itself."""
    band: tuple[Length, Length] | None = None
    """With a source: lowest and highest point above the floor that counts."""

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.source is None) != (self.band is None):
            raise ValueError("a laser made from a lidar needs both `source` and `band`")
        if self.band is not None and not self.band[0] < self.band[1]:
            raise ValueError(f"the band {self.band} is empty; write [lowest, highest]")
        if not self.angle_min < self.angle_max:
            raise ValueError("angle_min must be less than angle_max")
        return self


class LidarSensor(Part):
    """A scanner of several rings that turns all around its z axis."""

    kind: Literal["lidar"] = "lidar"
    frame: str
    """z is the axis it turns about; rings count from x towards y."""
    elevations: Annotated[tuple[Angle, ...], Field(min_length=1, max_length=256)]
    """Angle of each ring above the frame's x-y plane."""
    columns: Count
    """Steps of a full turn."""
    range_min: Range
    """Nearest distance that it measures."""
    range_max: Size
    """Farthest distance that it measures."""
    turn: Annotated[Time, Field(gt=0, le=1.0)] | None = None
    """Time of a full turn, in which it moves on; if not given, all points are of one instant."""


class ImuSensor(Part):
    """An inertial measurement unit: turning speeds and specific forces about three axes."""

    kind: Literal["imu"] = "imu"
    frame: str
    """Where it sits, and the axes of what it measures."""
    rate: Annotated[Rate, Field(le=1000)] = 100.0
    """Samples per second; a simulator gives at most one for each step of its physics."""


class WristWrench(Part):
    """A force-torque sensor at the wrist, or an estimate from joint efforts."""

    kind: Literal["wrench"] = "wrench"
    frame: str
    """The link whose load is measured, and whose axes are used."""


Sensor: TypeAlias = Annotated[
    CameraSensor | ImuSensor | LaserSensor | LidarSensor | WristWrench,
    Field(discriminator="kind"),
]


class PlanningGroup(Part):
    """Joints that are planned together, and the link they carry."""

    joints: Annotated[tuple[str, ...], Field(min_length=1)]
    """From the base outwards."""
    tip: str
    """The link that they carry."""


Opening: TypeAlias = tuple[tuple[Range, JointPosition], ...]
"""Rows (width, joint position) of one finger joint: from width 0 to the widest opening."""


class EndEffector(Part):
    """The gripper.

    In its grasp frame x points out along the fingers, y is the closing direction, and the origin
    lies between the pads.
    """

    actuator: str = "gripper"
    """The actuator that opens and closes it."""
    frame: str
    """The link that the grasp frame is fixed to; it has the grasp frame's axes."""
    grasp_offset: Length = 0.0
    """Distance of the grasp frame's origin along that link's x."""
    max_width: Size
    """Widest opening between the pads."""
    max_force: Force
    """Greatest closing force."""
    pad_length: Size
    """The pads' length along x."""
    pad_height: Size
    """The pads' height along z."""
    hand_clearance: Range
    """How deep an object may reach behind the grasp frame's origin."""
    touch_links: tuple[str, ...]
    """Links that may touch what is grasped."""
    opening: dict[str, Opening] = {}
    """Position of each finger joint by width. If not given, n joints go from 0 to max_width/n."""

    @model_validator(mode="after")
    def _monotone(self) -> Self:
        for joint, rows in self.opening.items():
            widths = [width for width, _ in rows]
            steps = [b[1] - a[1] for a, b in pairwise(rows)]
            if len(rows) < 2 or widths[0] != 0.0 or abs(widths[-1] - self.max_width) > 1e-9:
                raise ValueError(
                    f"the opening of {joint} needs at least two rows [width, position], "
                    f"from width 0 to max_width ({self.max_width:g} m)"
                )
            if any(b <= a for a, b in pairwise(widths)):
                raise ValueError(f"the widths of {joint}'s opening must rise")
            if not (all(step > 0 for step in steps) or all(step < 0 for step in steps)):
                raise ValueError(f"the positions of {joint}'s opening must all rise, or all fall")
        return self

    def positions(self, width: float) -> dict[str, float]:
        """The position of each finger joint at an opening, m; extrapolated beyond the table."""
        return {
            joint: _on_line([w for w, _ in rows], [p for _, p in rows], width)
            for joint, rows in self.opening.items()
        }

    def width(self, positions: Mapping[str, float]) -> float:
        """The opening at these positions of the finger joints: the mean over the joints, m.

        Raises:
            KeyError: a finger joint is missing in `positions`.
            ValueError: the gripper has no finger joints.
        """
        if not self.opening:
            raise ValueError("`opening` needs joints, and this gripper has none")
        told = [_inverse(rows, positions[joint]) for joint, rows in self.opening.items()]
        return sum(told) / len(told)


def _inverse(rows: Opening, position: float) -> float:
    rising = rows if rows[0][1] < rows[-1][1] else rows[::-1]
    return _on_line([p for _, p in rising], [w for w, _ in rising], position)


def _on_line(xs: Sequence[float], ys: Sequence[float], x: float) -> float:
    """The piecewise linear function through rising `xs`, its ends extended."""
    piece = max(1, min(len(xs) - 1, sum(known <= x for known in xs)))
    slope = (ys[piece] - ys[piece - 1]) / (xs[piece] - xs[piece - 1])
    return ys[piece - 1] + slope * (x - xs[piece - 1])


class BaseKind(StrEnum):
    """How a base moves: it turns and drives along its x alone, or drives in every direction."""

    DIFFERENTIAL = "differential"
    OMNIDIRECTIONAL = "omnidirectional"


class BaseLimits(Part):
    """The kind of the base, and its limits of speed and acceleration."""

    kind: BaseKind = BaseKind.DIFFERENTIAL
    """differential: it turns and drives ahead and back. omnidirectional: it drives sideways too."""
    linear: LinearSpeed
    """Greatest speed ahead."""
    lateral: LinearSpeed | None = None
    """Greatest speed sideways of an omnidirectional base; not given: that ahead."""
    angular: AngularSpeed
    """Greatest turning speed."""
    linear_acceleration: LinearAcceleration
    """How fast it may change its speed."""
    angular_acceleration: AngularAcceleration
    """How fast it may change its turning."""

    @model_validator(mode="after")
    def _only_where_it_goes(self) -> Self:
        if self.lateral is not None and self.kind is not BaseKind.OMNIDIRECTIONAL:
            raise ValueError(
                f"a {self.kind} base does not drive sideways: leave out `lateral`, or say "
                "`kind: omnidirectional`"
            )
        return self

    @property
    def sideways(self) -> float:
        """Greatest speed sideways, m/s; 0 for a base that does not drive sideways."""
        if self.kind is not BaseKind.OMNIDIRECTIONAL:
            return 0.0
        return self.linear if self.lateral is None else self.lateral


class WheelCorrection(Part):
    """How a base's wheels differ from what its driver believes: factors minus one."""

    radius: Correction = 0.0
    """Of both wheels, the mean."""
    track: Correction = 0.0
    """Of the distance between them."""
    left_to_right: Correction = 0.0
    """How much larger the right wheel is than the left one."""
    between: Size
    """The distance between the wheels as the driver believes it."""


class Working(Part):
    """Distances at which the robot works, from the centre of its base."""

    stand_off: Size
    """Least distance to a surface's edge at which the robot stands."""
    look_off: Size
    """Distance to a surface's edge from which the robot looks at the surface."""
    reach: tuple[Size, Size, Size] | None = None
    """Nearest, best and farthest distance of an object to reach; of a robot with an arm."""
    heading: Angle = 0.0
    """Direction in which the arm reaches, from straight ahead; counter-clockwise."""
    lateral: Length = 0.0
    """How far to the left of the base's middle the line lies along which the arm reaches."""
    breadth: Range | None = None
    """How far beside that line an object may stand, m; not given: as far as stands have it."""

    @property
    def base_from_reach(self) -> Pose2D:
        """The line of reach: its x points along it, and distances count from its origin."""
        c, s = math.cos(self.heading), math.sin(self.heading)
        return Pose2D(-s * self.lateral, c * self.lateral, self.heading)

    @property
    def reached(self) -> tuple[float, float, float]:
        """`reach`, for code that works only with an arm.

        Raises:
            LookupError: the robot reaches nothing.
        """
        if self.reach is None:
            raise LookupError("the robot has no arm, so that `working` has no `reach`")
        return self.reach

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.reach is not None and not self.reach[0] <= self.reach[1] <= self.reach[2]:
            raise ValueError("reach is [nearest, best, farthest]: each at least the one before")
        return self
