"""What a robot's driver offers: a description, its state, its sensors and its actuators."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Protocol, Self, TypeAlias, TypeVar

from pydantic import Field, model_validator

from momantu_bt.descriptions.quantities import Length, Size
from momantu_bt.frames import KinematicTree
from momantu_bt.messages import (
    ActuatorGoal,
    CameraImage,
    ImuReading,
    LaserScan,
    PointCloud,
    RobotState,
    WrenchReading,
)
from momantu_bt.robot_parts import (
    Actuator,
    ActuatorKind,
    BaseKind,
    BaseLimits,
    CameraSensor,
    EndEffector,
    ImuSensor,
    JointLimit,
    LaserSensor,
    LidarSensor,
    Part,
    PlanningGroup,
    Sensor,
    WheelCorrection,
    Working,
    WristWrench,
)
from momantu_bt.robot_simulation import (
    BaseJoints,
    Cuts,
    JointGains,
    Linkage,
    PlanarDrive,
    SimulationModel,
)

__all__ = [
    "ARM",
    "CAMERA_CARRIER",
    "MESH_ENDINGS",
    "REQUIRED_POSES",
    "WATCHDOG",
    "Actuator",
    "ActuatorKind",
    "BaseJoints",
    "BaseKind",
    "BaseLimits",
    "CameraSensor",
    "Cuts",
    "EndEffector",
    "ImuSensor",
    "JointGains",
    "JointLimit",
    "LaserSensor",
    "LidarSensor",
    "Linkage",
    "PlanarDrive",
    "PlanningGroup",
    "Robot",
    "RobotDescription",
    "Sensor",
    "SensorReading",
    "SimulationModel",
    "WheelCorrection",
    "Working",
    "WristWrench",
    "laser_band",
    "read_camera",
    "read_imu",
    "read_laser",
    "read_lidar",
]

SensorReading: TypeAlias = CameraImage | ImuReading | LaserScan | PointCloud | WrenchReading

CAMERA_CARRIER = "camera_carrier"
"""For a skill's `uses`: the actuator that carries the camera, a head or the arm."""

ARM = "arm"
"""Name of the actuator that carries the hand, and of the planning group of its joints."""

REQUIRED_POSES = ("home", "ready", "carry", "look_around")
"""Named poses that every robot with an arm has."""

MESH_ENDINGS = (".glb", ".gltf", ".dae", ".obj", ".stl", ".ply")
"""Extensions of mesh files, in lower case."""

WATCHDOG = 0.25
"""Seconds after the last command at which a driver stops its actuator by itself."""


class RobotDescription(Part):
    """Everything that skills know about a robot; they never test for a robot's name."""

    name: str
    source: Path | None = None
    """The robot file that it was read from."""
    files: dict[str, Path] = {}
    """Every file of the description, by a name that is the same on all machines."""
    urdf: Path
    """One URDF of the whole robot; absolute."""
    mesh_directories: tuple[Path, ...] = ()
    """Folders in which `package://` addresses are looked up."""
    base_frame: str = "base_link"
    """On the floor, x forward."""
    footprint: Annotated[tuple[tuple[Length, Length], ...], Field(min_length=3)]
    """(x, y) corners of the base in its frame, counter-clockwise."""
    height: Size
    """Height in the tallest working posture; anything that hangs lower is an obstacle."""
    working: Working
    base: BaseLimits
    actuators: dict[str, Actuator]
    joint_limits: dict[str, JointLimit]
    sensors: dict[str, Sensor]
    groups: dict[str, PlanningGroup] = {}
    """Chains that are planned together. Without the group `arm` the robot has no arm."""
    end_effector: EndEffector | None = None
    """None: the robot has no hand."""
    named_poses: dict[str, dict[str, float]] = {}
    """Joint positions by name, rad or m. A robot with an arm has REQUIRED_POSES."""
    ignored_collisions: tuple[tuple[str, str], ...] = ()
    """Pairs of links that collision checks ignore."""
    wheels: WheelCorrection | None = None
    """What a calibration found of the base's wheels; None: they are as its driver believes."""
    simulation: SimulationModel | None = None
    """None: the robot cannot be simulated."""

    @model_validator(mode="after")
    def _usual_opening(self) -> Self:
        """Without a finger table, each finger moves by an equal share of the opening."""
        hand = self.end_effector
        gripper = None if hand is None else self.actuators.get(hand.actuator)
        if hand is None or hand.opening or gripper is None or not gripper.joints:
            return self
        row = (hand.max_width, hand.max_width / len(gripper.joints))
        opening = dict.fromkeys(gripper.joints, ((0.0, 0.0), row))
        object.__setattr__(self, "end_effector", hand.model_copy(update={"opening": opening}))
        return self

    def texts(self) -> Mapping[str, str]:
        """Texts of the robot's files by file name, without meshes."""
        return {
            name: path.read_text(encoding="utf-8", errors="replace")
            for name, path in self.files.items()
            if path.suffix.lower() not in MESH_ENDINGS
        }

    def kinematics(self) -> KinematicTree:
        """Forward kinematics below the base frame, read from the URDF."""
        return KinematicTree.from_urdf(self.urdf, self.base_frame)

    def camera(self, name: str | None = None) -> tuple[str, CameraSensor]:
        """Name and description of a camera: the named one, or the first.

        Raises:
            KeyError: there is no such camera; the message lists those that exist.
        """
        cameras = {k: s for k, s in self.sensors.items() if isinstance(s, CameraSensor)}
        return _pick("camera", cameras, name)

    @property
    def hand(self) -> EndEffector:
        """The end effector, for code that works only with one.

        Raises:
            LookupError: the robot has no hand.
        """
        if self.end_effector is None:
            raise LookupError(f"the robot {self.name} has no end effector")
        return self.end_effector

    @property
    def has_arm(self) -> bool:
        """Whether motions can be planned for an arm."""
        return ARM in self.groups and ARM in self.actuators

    @property
    def eye_in_hand(self) -> bool:
        """Whether the arm carries the first camera, so that looking around moves the arm."""
        cameras = (s for s in self.sensors.values() if isinstance(s, CameraSensor))
        return next((camera.carrier == ARM for camera in cameras), False)

    def laser(self, name: str | None = None) -> tuple[str, LaserSensor]:
        """Name and description of a laser: the named one, or the first; KeyError if none."""
        lasers = {k: s for k, s in self.sensors.items() if isinstance(s, LaserSensor)}
        return _pick("laser", lasers, name)

    def lidar(self, name: str | None = None) -> tuple[str, LidarSensor]:
        """Name and description of a lidar: the named one, or the first; KeyError if none."""
        lidars = {k: s for k, s in self.sensors.items() if isinstance(s, LidarSensor)}
        return _pick("lidar", lidars, name)

    def imu(self, name: str | None = None) -> tuple[str, ImuSensor]:
        """Name and description of an IMU: the named one, or the first; KeyError if none."""
        imus = {k: s for k, s in self.sensors.items() if isinstance(s, ImuSensor)}
        return _pick("imu", imus, name)

    def resolve_use(self, use: str) -> str | None:
        """The actuator that an entry of a skill's `uses` stands for on this robot.

        Returns None for CAMERA_CARRIER when no actuator moves the camera, or there is none.

        Raises:
            KeyError: the robot has no such actuator; the message lists those it has.
        """
        actuator = self._camera_carrier() if use == CAMERA_CARRIER else use
        return None if actuator is None else _pick("actuator", self.actuators, actuator)[0]

    def _camera_carrier(self) -> str | None:
        cameras = (s for s in self.sensors.values() if isinstance(s, CameraSensor))
        return next((camera.carrier for camera in cameras), None)


_T = TypeVar("_T")


def _pick(what: str, having: dict[str, _T], name: str | None) -> tuple[str, _T]:
    found = next(iter(having), None) if name is None else name
    if found is None or found not in having:
        names = ", ".join(having) or "none"
        missing = what if found is None else f"{what} {found!r}"
        raise KeyError(f"the robot has no {missing}; it has: {names}")
    return found, having[found]


def laser_band(description: RobotDescription) -> tuple[float, float]:
    """Lowest and highest point above the floor that the robot's laser sees, m.

    For a planar laser scanner both are the height of its plane. For a robot without a laser they
    are the floor and the robot's height: everything that it could drive into.

    Raises:
        Failure: FRAME_UNKNOWN, the robot does not have the laser's frame.
    """
    if not any(isinstance(sensor, LaserSensor) for sensor in description.sensors.values()):
        return 0.0, description.height
    _, laser = description.laser()
    if laser.band is not None:
        return laser.band
    base_from_laser = description.kinematics().base_from_frame(laser.frame, {})
    height = float(base_from_laser.position[2])
    return height, height


class Robot(Protocol):
    """A robot's driver. No call blocks; simulation and hardware share this interface."""

    @property
    def description(self) -> RobotDescription:
        """The robot's description."""
        ...

    def state(self) -> RobotState:
        """The current joints and odometry."""
        ...

    def read(self, sensor: str) -> SensorReading:
        """The newest reading; two reads at the same time return the same one.

        Raises:
            KeyError: there is no sensor of that name.
            Failure: SENSOR_DEAD, the sensor does not answer.
        """
        ...

    def command(self, actuator: str, goal: ActuatorGoal) -> None:
        """Give an actuator its goal. Repeat the command within 0.25 s, or the actuator stops.

        Raises:
            KeyError: there is no actuator of that name.
            ValueError: the goal does not fit (wrong kind, wrong joints, outside its limits).
        """
        ...

    def stop(self, actuator: str) -> None:
        """Brake at the limits. An arm stops along its path, a gripper keeps its last force."""
        ...


def read_camera(robot: Robot, name: str | None = None) -> CameraImage:
    """Read the named camera, or the robot's first one."""
    reading = robot.read(robot.description.camera(name)[0])
    if not isinstance(reading, CameraImage):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not a picture")
    return reading


def read_laser(robot: Robot, name: str | None = None) -> LaserScan:
    """Read the named laser, or the robot's first one."""
    reading = robot.read(robot.description.laser(name)[0])
    if not isinstance(reading, LaserScan):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not a scan")
    return reading


def read_lidar(robot: Robot, name: str | None = None) -> PointCloud:
    """Read the named lidar, or the robot's first one."""
    reading = robot.read(robot.description.lidar(name)[0])
    if not isinstance(reading, PointCloud):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not points")
    return reading


def read_imu(robot: Robot, name: str | None = None) -> ImuReading:
    """Read the named IMU, or the robot's first one."""
    reading = robot.read(robot.description.imu(name)[0])
    if not isinstance(reading, ImuReading):
        raise TypeError(f"sensor {name!r} gave a {type(reading).__name__}, not an IMU's samples")
    return reading
