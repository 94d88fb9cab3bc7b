"""Bags of ROS 1 and 2 with the scans of a drive, for tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from momantu_skills.mapping.logs.log import LoggedScan
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from momantu_bt.geometry import Pose2D, Transform
from tests.skills.mapping.walls import ANGLES, REACH

STORE1, STORE2 = get_typestore(Stores.ROS1_NOETIC), get_typestore(Stores.ROS2_HUMBLE)
STORE1.register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)
FIRST = 1_600_000_000.0
"""Stamp of a log's first message, s."""
Message = tuple[str, str, float, dict[str, Any]]
"""Topic, type, stamp, and content."""


def header(frame: str, stamp: float) -> tuple[str, dict[str, Any]]:
    """A header, as `built` takes it."""
    return "std_msgs/msg/Header", {"stamp": stamp, "frame_id": frame}


def scan(logged: LoggedScan, topic: str = "/scan", frame: str = "laser") -> Message:
    """A scan; beams that hit nothing are infinite."""
    stamp = FIRST + logged.stamp
    ranges = np.where(logged.rays.hit, logged.rays.ranges, np.inf).astype(np.float32)
    content = {
        "header": header(frame, stamp),
        "angle_min": float(ANGLES[0]),
        "angle_max": float(ANGLES[-1]),
        "angle_increment": float(ANGLES[1] - ANGLES[0]),
        "time_increment": 0.0,
        "scan_time": 0.1,
        "range_min": 0.05,
        "range_max": REACH,
        "ranges": ranges,
        "intensities": np.zeros(0, np.float32),
    }
    return topic, "sensor_msgs/msg/LaserScan", stamp, content


def _vector(kind: str, x: float, y: float, z: float) -> tuple[str, dict[str, Any]]:
    return f"geometry_msgs/msg/{kind}", {"x": x, "y": y, "z": z}


def _turn(yaw: float) -> tuple[str, dict[str, Any]]:
    half = yaw / 2
    content = {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}
    return "geometry_msgs/msg/Quaternion", content


def frame(
    parent: str,
    child: str,
    stamp: float,
    pose: Pose2D | Transform,
    topic: str = "/tf",
    *,
    tilted: bool = False,
) -> Message:
    """A transform, 0.2 m high if it is one in the plane; tilted: by 60 degrees about y."""
    there = pose if isinstance(pose, Transform) else pose.transform(0.2)
    if tilted:
        there = Transform(there.position, (math.sqrt(0.75), 0.0, 0.5, 0.0))
    x, y, z = (float(value) for value in there.position)
    turn = dict(zip("wxyz", (float(value) for value in there.quaternion), strict=True))
    transform = {
        "translation": _vector("Vector3", x, y, z),
        "rotation": ("geometry_msgs/msg/Quaternion", turn),
    }
    stamped = {
        "header": header(parent, stamp),
        "child_frame_id": child,
        "transform": ("geometry_msgs/msg/Transform", transform),
    }
    content = {"transforms": [("geometry_msgs/msg/TransformStamped", stamped)]}
    return topic, "tf2_msgs/msg/TFMessage", stamp, content


def odometry(logged: LoggedScan, child: str = "base_link") -> Message:
    """What wheels tell at the time of a scan."""
    stamp, pose = FIRST + logged.stamp, logged.odom_from_base
    where = {"position": _vector("Point", pose.x, pose.y, 0.0), "orientation": _turn(pose.yaw)}
    zero = {"linear": _vector("Vector3", 0.0, 0.0, 0.0), "angular": _vector("Vector3", 0, 0, 0.0)}
    content = {
        "header": header("odom", stamp),
        "child_frame_id": child,
        "pose": (
            "geometry_msgs/msg/PoseWithCovariance",
            {"pose": ("geometry_msgs/msg/Pose", where), "covariance": np.zeros(36)},
        ),
        "twist": (
            "geometry_msgs/msg/TwistWithCovariance",
            {"twist": ("geometry_msgs/msg/Twist", zero), "covariance": np.zeros(36)},
        ),
    }
    return "/odom", "nav_msgs/msg/Odometry", stamp, content


def built(store: Any, kind: str, content: dict[str, Any]) -> Any:
    """A message of a store's types."""
    parts: dict[str, Any] = {}
    for name, value in content.items():
        if name == "stamp":
            value = store.types["builtin_interfaces/msg/Time"](
                sec=int(value), nanosec=round((value % 1.0) * 1e9)
            )
        elif isinstance(value, tuple):
            value = built(store, *value)
        elif isinstance(value, list):
            value = [built(store, *each) for each in value]
        parts[name] = value
    if kind == "std_msgs/msg/Header" and store is STORE1:
        parts["seq"] = 0
    return store.types[kind](**parts)


def ros1(path: Path, messages: Sequence[Message]) -> Path:
    """A `.bag`."""
    _write(rosbag1.Writer(path), STORE1, STORE1.serialize_ros1, messages)
    return path


def ros2(path: Path, messages: Sequence[Message]) -> Path:
    """A folder with a `.db3`."""
    _write(rosbag2.Writer(path, version=9), STORE2, STORE2.serialize_cdr, messages)
    return path


def ros2_mcap(path: Path, messages: Sequence[Message]) -> Path:
    """A folder with an `.mcap`."""
    writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
    _write(writer, STORE2, STORE2.serialize_cdr, messages)
    return path


def _write(
    writer: Any, store: Any, encode: Callable[[Any, str], Any], messages: Sequence[Message]
) -> None:
    connections: dict[str, Any] = {}
    with writer as bag:
        for topic, kind, stamp, content in messages:
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=store)
            data = encode(built(store, kind, content), kind)
            bag.write(connections[topic], round(stamp * 1e9), data)
