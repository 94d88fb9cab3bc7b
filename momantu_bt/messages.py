"""What sensors, actuators and skills exchange: immutable values in SI units.

Their arrays are read-only. Optical frames follow OpenCV: x right, y down, z forward; pixel centres
have integer coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Pose, Pose2D, Transform


def frozen(array: NDArray[Any]) -> NDArray[Any]:
    """Mark an array read-only and return it."""
    array.setflags(write=False)
    return array


ENCODED_IF_SET = {"encoded_if_set": True}
"""Metadata of a field that only some robots have: a run's fingerprint leaves out its default."""
GRAVITY = 9.81
"""Of every world, m/s2, downwards."""

# What a robot reports.


@dataclass(frozen=True, slots=True)
class RobotState:
    """Measured joints and odometry at one time.

    names: joint names in a fixed order, without the gripper's fingers.
    positions, velocities, efforts: (n,) in rad or m, rad/s or m/s, Nm or N.
    odom_from_base: the base's pose from wheel odometry; it drifts.
    linear, angular: the base's measured velocity, m/s along x and rad/s about z.
    gripper_width: opening between the finger pads, m. gripper_effort: closing force, N.
    lateral: the measured velocity of an omnidirectional base along y, m/s; of others 0.
    """

    stamp: float
    names: tuple[str, ...]
    positions: Array
    velocities: Array
    efforts: Array
    odom_from_base: Transform
    linear: float
    angular: float
    gripper_width: float
    gripper_effort: float
    lateral: float = field(default=0.0, metadata=ENCODED_IF_SET)

    def position(self, joint: str) -> float:
        """Position of one joint; an unknown name raises a KeyError that lists the known ones."""
        try:
            return float(self.positions[self.names.index(joint)])
        except ValueError:
            raise KeyError(f"no joint {joint!r}; joints: {', '.join(self.names)}") from None

    def joints(self) -> dict[str, float]:
        """All joint positions by name."""
        return dict(zip(self.names, (float(p) for p in self.positions), strict=True))


@dataclass(frozen=True, slots=True)
class CameraImage:
    """One RGB-D picture.

    frame: name of the optical frame. color: (h, w, 3) uint8 RGB. depth: (h, w) float32, metres
    along the optical axis, 0 where nothing was measured. intrinsics: (3, 3) pinhole matrix.
    """

    stamp: float
    frame: str
    color: NDArray[np.uint8]
    depth: NDArray[np.float32]
    intrinsics: Array


@dataclass(frozen=True, slots=True)
class LaserScan:
    """One planar scan: beam i has the angle `angle_min + i * angle_increment` rad in `frame`.

    ranges: (n,) float64 in metres; a beam that hit nothing has `range_max` or more.
    """

    stamp: float
    frame: str
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    ranges: Array


@dataclass(frozen=True, slots=True)
class PointCloud:
    """The points of one turn of a lidar: (n, 3) float32, m, in `frame`; only beams that hit.

    times: (n,) float32, when each was measured, s after `stamp`, so never positive; each point lies
    as seen from where the frame was then. None: all were measured at the stamp.
    """

    stamp: float
    frame: str
    points: NDArray[np.float32]
    times: NDArray[np.float32] | None = field(default=None, metadata=ENCODED_IF_SET)


@dataclass(frozen=True, slots=True)
class ImuReading:
    """The newest samples of an IMU, oldest first, in `frame`; the last one is of `stamp`.

    times: (k,) s, rising. rates: (k, 3) angular velocities, rad/s. forces: (k, 3) specific forces,
    m/s2: acceleration less gravity, so GRAVITY upwards at rest.
    """

    stamp: float
    frame: str
    times: Array
    rates: Array
    forces: Array


@dataclass(frozen=True, slots=True)
class WrenchReading:
    """Force (3,) in N and torque (3,) in Nm that act on the wrist from the hand, in `frame`."""

    stamp: float
    frame: str
    force: Array
    torque: Array


# Goals of actuators.


@dataclass(frozen=True, slots=True)
class BaseVelocity:
    """Goal of a base: m/s along x, rad/s about z, and m/s along y if it is omnidirectional."""

    linear: float
    angular: float
    lateral: float = field(default=0.0, metadata=ENCODED_IF_SET)


@dataclass(frozen=True, slots=True, eq=False)
class JointTrajectory:
    """Goal of an arm or head: joint positions over time, beginning at the current ones.

    names: the joints. times: (k,) seconds since the first command, increasing, times[0] = 0.
    positions, velocities: (k, n). Command the same object again to continue the motion: the driver
    stops along the path 0.25 s after the last command.
    """

    names: tuple[str, ...]
    times: Array
    positions: Array
    velocities: Array

    @property
    def duration(self) -> float:
        """Seconds from start to end."""
        return float(self.times[-1])


@dataclass(frozen=True, slots=True)
class JointPositions:
    """Goal of a head or another small joint group: the driver moves there within its limits."""

    names: tuple[str, ...]
    positions: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class GripperCommand:
    """Goal of a gripper: opening between the pads in m, and the highest force in N."""

    width: float
    max_force: float


ActuatorGoal: TypeAlias = BaseVelocity | JointTrajectory | JointPositions | GripperCommand


# What skills exchange over the blackboard.


_SIZE: Mapping[str, Any] = {"unit": "m", "least": 0.001, "most": 2.0}
"""A size of an object that can stand on a surface."""


@dataclass(frozen=True, slots=True)
class ObjectClass:
    """A kind of object to look for. Sizes in metres; None means unknown."""

    category: str = field(metadata={"names": "category"})
    diameter: float | None = field(default=None, metadata=_SIZE)
    height: float | None = field(default=None, metadata=_SIZE)
    width: float | None = field(default=None, metadata=_SIZE)
    depth: float | None = field(default=None, metadata=_SIZE)


@dataclass(frozen=True, slots=True)
class DetectedObject:
    """An object that was seen on a surface.

    pose: `odom_from_object`; origin at the centre of the object's bounding box, z up along its
    axis. size: extent (3,) along its own x, y, z, m. shape: "cylinder" or "box".
    score: 0..1, how well it matches the requested object. support_height: height of the surface
    that it stands on, z in the pose's frame, m.
    """

    category: str
    pose: Pose
    size: tuple[float, float, float]
    shape: str
    score: float
    support_height: float


@dataclass(frozen=True, slots=True)
class DetectedTag:
    """An AprilTag, or a bundle of them, that was seen, as apriltag_ros tells it.

    name: of what the site knows, else empty. ids: of the tags that were seen and count. edges:
    theirs, m. pose: of the tag's centre or the bundle's frame, z out of the print. covariance:
    (6, 6), row by row: x, y, z in m, then rotations about the fixed axes of the pose's frame, rad.
    """

    name: str
    family: str
    ids: tuple[int, ...]
    edges: tuple[float, ...]
    pose: Pose
    covariance: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class SupportPlane:
    """A horizontal surface. pose: `odom_from_plane`, z up, origin on the surface.

    outline: (k, 2) convex polygon in the plane's x, y, m, counter-clockwise.
    obstacles: objects that stand on it, as (x, y, radius, height) in the plane's frame, m.
    """

    pose: Pose
    outline: tuple[tuple[float, float], ...]
    obstacles: tuple[tuple[float, float, float, float], ...] = ()


@dataclass(frozen=True, slots=True)
class TrackingFeedback:
    """How the base follows a path, as Nav2's message has it; poses are in the map.

    position_tracking_error: m, positive to the left of the path. heading_tracking_error: rad,
    positive when the base is turned to the right of the path. distance_to_goal: m, straight.
    speed: m/s. remaining_path_length: m.
    """

    position_tracking_error: float = field(metadata={"unit": "m"})
    heading_tracking_error: float = field(metadata={"unit": "rad"})
    current_path_index: int
    robot_pose: Pose2D
    distance_to_goal: float = field(metadata={"unit": "m"})
    speed: float = field(metadata={"unit": "m/s"})
    remaining_path_length: float = field(metadata={"unit": "m"})


@dataclass(frozen=True, slots=True)
class WaypointStatus:
    """What became of one goal of a list, as Nav2's message has it.

    waypoint_status: 0 pending, 1 completed, 2 skipped, 3 failed. waypoint_pose: a pose of the map,
    or a place's name.
    """

    waypoint_status: int
    waypoint_index: int
    waypoint_pose: Pose2D | str
    error_code: int = 0
    error_msg: str = ""


VALUE_TYPES: dict[str, type] = {
    "any": object,
    "text": str,
    "int": int,
    "number": float,
    "bool": bool,
    "pose": Pose,
    "pose2d": Pose2D,
    "object_class": ObjectClass,
    "detected_object": DetectedObject,
    "detected_tag": DetectedTag,
    "plane": SupportPlane,
    "tracking_feedback": TrackingFeedback,
    "waypoint_status": WaypointStatus,
}
"""Names that tree files use for the types of inputs and outputs; `list of X` is a tuple of X.

A plug-in adds its own with `register_value_type`.
"""


def register_value_type(name: str, python_type: type) -> None:
    """Add a type name for tree files; ValueError when another type already has the name."""
    taken = VALUE_TYPES.get(name)
    if taken is not None and taken is not python_type:
        raise ValueError(f"the value type {name!r} is already {taken.__qualname__}")
    VALUE_TYPES[name] = python_type


def plain(value: Any) -> Any:
    """A value as JSON data: dataclasses become mappings, arrays lists, tuples lists."""
    if isinstance(value, Transform):
        return {"position": value.position.tolist(), "quaternion": value.quaternion.tolist()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__}
    return value
