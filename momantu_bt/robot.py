"""What a robot's driver offers: a description, its state, its sensors and its actuators."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal, Protocol, TypeAlias, TypeVar

from pydantic import BaseModel, ConfigDict, Field

from momantu_bt.frames import KinematicTree
from momantu_bt.messages import (
    ActuatorGoal,
    CameraImage,
    LaserScan,
    RobotState,
    WrenchReading,
)

SensorReading: TypeAlias = CameraImage | LaserScan | WrenchReading

CAMERA_CARRIER = "camera_carrier"
"""In a skill's `uses`: whichever actuator carries the camera (a head, or the arm)."""

REQUIRED_POSES = ("home", "ready", "carry", "look_around")
"""Named poses that every robot has."""

WATCHDOG = 0.25
"""Seconds after the last command at which a driver stops its actuator by itself."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ActuatorKind(StrEnum):
    """What goals an actuator takes: BaseVelocity, joint goals, or GripperCommand."""

    BASE = "base"
    JOINTS = "joints"
    GRIPPER = "gripper"


class Actuator(_Part):
    """A thing that can be commanded. joints: in the order of its trajectories."""

    kind: ActuatorKind
    joints: tuple[str, ...] = ()


class JointLimit(_Part):
    """Limits of one joint: rad or m, per second, per second squared. None: turns for ever."""

    lower: float | None = None
    upper: float | None = None
    velocity: float
    acceleration: float


class CameraSensor(_Part):
    """An RGB-D camera. carrier: the actuator that moves it. Fields in px, rad and m."""

    kind: Literal["camera"] = "camera"
    frame: str
    carrier: str
    width: int = 640
    height: int = 480
    horizontal_fov: float
    min_depth: float
    max_depth: float


class LaserSensor(_Part):
    """A planar laser scanner. Fields in rad, m and counts."""

    kind: Literal["laser"] = "laser"
    frame: str
    angle_min: float
    angle_max: float
    beams: int
    range_min: float
    range_max: float


class WristWrench(_Part):
    """A force-torque sensor at the wrist, or an estimate from joint efforts."""

    kind: Literal["wrench"] = "wrench"
    frame: str


Sensor: TypeAlias = Annotated[CameraSensor | LaserSensor | WristWrench, Field(discriminator="kind")]


class PlanningGroup(_Part):
    """Joints that are planned together, from the base outwards, and the link they carry."""

    joints: tuple[str, ...]
    tip: str


class EndEffector(_Part):
    """The gripper.

    In its grasp frame x points out along the fingers, y is the closing direction, and the origin
    lies between the pads.

    frame: link the grasp frame is fixed to; grasp_offset: distance of the grasp frame's origin
    along that link's x, m. pad_length: the pads' length along x, pad_height along z, m.
    hand_clearance: how deep an object may reach behind the grasp frame's origin, m.
    touch_links: links that may touch what is grasped.
    """

    actuator: str = "gripper"
    frame: str
    grasp_offset: float = 0.0
    max_width: float
    max_force: float
    pad_length: float
    pad_height: float
    hand_clearance: float
    touch_links: tuple[str, ...]


class BaseLimits(_Part):
    """m/s, rad/s, m/s2, rad/s2."""

    linear: float
    angular: float
    linear_acceleration: float
    angular_acceleration: float


class RobotDescription(_Part):
    """All that skills may know of a robot; nothing in them mentions a robot by name.

    urdf: absolute path; mesh_directories: where `package://` addresses are looked up.
    footprint: (x, y) corners of the base in its frame, counter-clockwise, m.
    ignored_collisions: pairs of links that never matter to a collision check.
    """

    name: str
    urdf: Path
    mesh_directories: tuple[Path, ...] = ()
    base_frame: str = "base_link"
    footprint: tuple[tuple[float, float], ...]
    base: BaseLimits
    actuators: dict[str, Actuator]
    joint_limits: dict[str, JointLimit]
    sensors: dict[str, Sensor]
    groups: dict[str, PlanningGroup]
    end_effector: EndEffector
    named_poses: dict[str, dict[str, float]]
    ignored_collisions: tuple[tuple[str, str], ...] = ()

    def kinematics(self) -> KinematicTree:
        """Forward kinematics below the base frame, read from the URDF."""
        return KinematicTree.from_urdf(self.urdf, self.base_frame)

    def camera(self, name: str | None = None) -> tuple[str, CameraSensor]:
        """Name and description of a camera: the named one, or the first.

        Raises:
            KeyError: there is none, with the cameras there are.
        """
        cameras = {k: s for k, s in self.sensors.items() if isinstance(s, CameraSensor)}
        return _pick("camera", cameras, name)

    def laser(self, name: str | None = None) -> tuple[str, LaserSensor]:
        """Name and description of a laser: the named one, or the first; KeyError if none."""
        lasers = {k: s for k, s in self.sensors.items() if isinstance(s, LaserSensor)}
        return _pick("laser", lasers, name)

    def resolve_use(self, use: str) -> str:
        """The actuator that an entry of a skill's `uses` means on this robot.

        Raises:
            KeyError: the robot has no such actuator, with those it has.
        """
        actuator = self.camera()[1].carrier if use == CAMERA_CARRIER else use
        return _pick("actuator", self.actuators, actuator)[0]


_T = TypeVar("_T")


def _pick(what: str, having: dict[str, _T], name: str | None) -> tuple[str, _T]:
    found = next(iter(having), None) if name is None else name
    if found is None or found not in having:
        names = ", ".join(having) or "none"
        raise KeyError(f"the robot has no {what} {found or ''}; it has: {names}")
    return found, having[found]


class Robot(Protocol):
    """A robot's driver: flat, never blocking, the same in simulation and on hardware."""

    @property
    def description(self) -> RobotDescription:
        """What the robot is."""
        ...

    def state(self) -> RobotState:
        """Joints and odometry of now."""
        ...

    def read(self, sensor: str) -> SensorReading:
        """The newest reading; two reads of one instant give the same one.

        Raises:
            KeyError: no sensor of that name.
            Failure: SENSOR_DEAD, when the sensor does not answer.
        """
        ...

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal, to be given again within 0.25 s or it stops.

        Raises:
            KeyError: no actuator of that name.
            ValueError: a goal it cannot take (wrong kind, wrong joints, outside its limits).
        """
        ...

    def stop(self, actuator: str) -> None:
        """Brake at the limits; an arm stops along its path, a gripper keeps its last force."""
        ...


def read_camera(robot: Robot, name: str | None = None) -> CameraImage:
    """A picture of the named camera, or of the robot's first one."""
    reading = robot.read(robot.description.camera(name)[0])
    if not isinstance(reading, CameraImage):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not a picture")
    return reading


def read_laser(robot: Robot, name: str | None = None) -> LaserScan:
    """A scan of the named laser, or of the robot's first one."""
    reading = robot.read(robot.description.laser(name)[0])
    if not isinstance(reading, LaserScan):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not a scan")
    return reading
