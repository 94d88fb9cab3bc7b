"""The sections of a robot file, as checked values. The docstrings are what editors show."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Angle, Force, JointPosition, Length, Mass, Size
from momantu_bt.robot_parts import (
    Actuator,
    BaseLimits,
    EndEffector,
    JointLimit,
    Part,
    PlanningGroup,
    Sensor,
    WheelCorrection,
    Working,
)
from momantu_bt.robot_simulation import BaseJoints, Contacts, JointGains, Strength

Name: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Namespace: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Point: TypeAlias = tuple[Length, Length, Length]
Turns: TypeAlias = tuple[Angle, Angle, Angle]


class PackageFile(Part):
    """A file inside an installed Python package, which is not imported."""

    package: Annotated[str, Field(pattern=r"^[A-Za-z_]\w*$")]
    """The package's import name."""
    file: str
    """The file's path inside it."""


class BoxInertial(Part):
    """The mass of a link, spread evenly in a box."""

    mass: Mass
    """kg."""
    box: tuple[Size, Size, Size]
    """The box's edges along the link's x, y and z."""
    xyz: Point = (0.0, 0.0, 0.0)
    """The box's middle in the link's frame."""


class PartSource(Part):
    """One URDF of the robot. Exactly one of `urdf` and `xacro` is given."""

    urdf: str | PackageFile | None = None
    """A URDF file: a path relative to the robot file, or a file of an installed package."""
    xacro: str | PackageFile | None = None
    """A xacro file that gives the URDF; written like `urdf`."""
    args: dict[str, str | bool | int | float] = {}
    """Arguments for the xacro file."""
    namespace: Namespace | None = None
    """Put before the name of every link, joint and material, with an underscore."""
    inertials: dict[str, BoxInertial] = {}
    """Masses and inertias in the place of the file's own, by link name without the namespace."""
    meshes: str | None = None
    """A folder with meshes that are used instead of the part's own geometry, by link name."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.urdf is None) == (self.xacro is None):
            raise ValueError("a part needs either `urdf: FILE` or `xacro: FILE`, and not both")
        if self.urdf is not None and self.args:
            raise ValueError("`args` are for xacro files; a urdf takes none")
        return self


class Attachment(Part):
    """A mounting pose in the frame of a link."""

    on: str
    """The link that it is fixed to, by its name in the whole robot."""
    xyz: Point = (0.0, 0.0, 0.0)
    """Position in that link's frame."""
    rpy: Turns = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw about that link's fixed axes, as in a URDF."""


class Mount(Attachment):
    """Where a part is fixed to the rest of the robot."""

    link: str | None = None
    """Which of the part's links lies there; not given: its root."""


class Drive(Part):
    """The drive of the base in a simulator."""

    kind: Literal["planar"] = "planar"
    """planar: on virtual joints x, y and yaw, driven by velocity."""
    force: Force
    """The most that the wheels push with, N."""
    torque: Strength
    """The most that they turn with, Nm."""
    joints: BaseJoints | None = None
    """The virtual joints that the URDF has; not given: they are added above the base."""


class Base(BaseLimits):
    """The base's limits, and how a simulator drives it."""

    drive: Drive | None = None
    """Not given: the robot cannot be simulated."""


class CameraCorrection(Part):
    """Where a camera really is, in the frame that the description gives it."""

    xyz: Point = (0.0, 0.0, 0.0)
    """Position in the described optical frame: right, down, ahead."""
    rpy: Turns = (0.0, 0.0, 0.0)
    """Roll, pitch and yaw about that frame's fixed axes, as in a URDF."""


class Calibration(Part):
    """What `calibrate robot` found. Skills use it; a simulator builds the robot without it."""

    joints: dict[str, JointPosition] = {}
    """What is added to the position that a joint reports."""
    cameras: dict[str, CameraCorrection] = {}
    """How far each camera is off, by the sensor's name."""
    wheels: WheelCorrection | None = None
    """How the base's wheels differ from what its driver believes."""


class RobotFile(Part):
    """A whole robot file. Lengths in m, angles in rad, or with a unit: `5 cm`, `30 deg`."""

    momantu_robot: Literal[1]
    """The format's version."""
    name: Name
    """What the robot is called."""
    parts: Annotated[dict[Name, PartSource], Field(min_length=1)]
    """The robot's URDF files; the first carries the base frame."""
    packages: tuple[str, ...] = ()
    """Folders in which ROS packages are looked for, relative to the robot file."""
    mounts: dict[str, Mount] = {}
    """Where each part but the first is fixed; the first may be put on a base frame of its own."""
    frames: dict[str, Attachment] = {}
    """More frames, fixed to links: where sensors sit, where the hand grasps."""
    base_frame: str = "base_link"
    """The link that stands on the floor, x forward."""
    footprint: Annotated[tuple[tuple[Length, Length], ...], Field(min_length=3)]
    """Corners (x, y) of the base's outline in the base frame, counter-clockwise."""
    height: Size
    """Of the robot in its tallest working posture."""
    working: Working
    """Distances at which it works."""
    base: Base
    """How fast it drives."""
    actuators: dict[Name, Actuator]
    """What can be commanded, by the names that skills use."""
    joint_limits: dict[str, JointLimit] = {}
    """Limits of every joint of an actuator."""
    sensors: dict[Name, Sensor] = {}
    """What can be read."""
    groups: dict[Name, PlanningGroup] = {}
    """Chains of joints that are planned together; none: the robot has no arm."""
    end_effector: EndEffector | None = None
    """The gripper; if not given, the robot has no hand."""
    named_poses: dict[Name, dict[str, JointPosition]] = {}
    """Postures by name; with an arm home, ready, carry and look_around at least."""
    ignored_collisions: tuple[tuple[str, str], ...] = ()
    """Pairs of links that never matter to a collision check."""
    drives: dict[str, JointGains] = {}
    """Gains for simulation, by actuator or joint; a joint's own win."""
    simulation: Contacts | None = None
    """What touches what in a simulator. Not given: the robot cannot be simulated."""
    calibration: Calibration = Calibration()
    """How this robot differs from its description."""

    def as_written(self) -> dict[str, Any]:
        """Plain data for a YAML file that reads as this: SI units, nothing that is usual."""
        data = self.model_dump(mode="json", exclude_defaults=True)
        for name, sensor in self.sensors.items():
            data["sensors"][name] = {"kind": sensor.kind, **data["sensors"][name]}
        return data
