"""Bags of ROS 1 and ROS 2, read by `rosbags`: LaserScan, TF and Odometry."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.geometry import Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import LaserScan, frozen
from momantu_skills.mapping.logs.log import Log, LogError
from momantu_skills.mapping.logs.placed import Published, placed, pose_of

with lazily():
    import apsw
    from rosbags import rosbag1, rosbag2, serde
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

SCAN, ODOMETRY = "sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry"
TF = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
"""Today's type, and the older one of ROS 1."""
_TF = "geometry_msgs/TransformStamped[] transforms"


def read_bag(path: Path, topic: str | None = None) -> Log:
    """The scans of a bag: a `.bag`, the folder of a ROS 2 bag, or one `.mcap` or `.db3` of it.

    topic: of the laser, if the bag has several; its name without a slash will do.

    Raises:
        LogError: the package `rosbags` is missing, the bag cannot be read, or it holds no scans
            with odometry.
    """
    with _opened(path) as reader:
        scans = _scan_topic(path, reader, topic)
        asked = [c for c in reader.connections if c.msgtype in (*TF, ODOMETRY) or c is scans]
        decode, told = _decoder(path), Published()
        for connection, _, data in reader.messages(connections=asked):
            message = decode(data, connection.msgtype)
            if connection.msgtype == SCAN:
                told.scans.append(_scan(message))
            elif connection.msgtype == ODOMETRY:
                told.moved(*_odometry(message))
            else:
                _frames(message, told)
    if not told.scans:
        raise LogError(f"{path}: the topic {scans.topic} holds no scan")
    return placed(path, told)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The bag, open; what the library raises becomes a sentence."""
    try:
        import_module("rosbags")
    except ModuleNotFoundError:
        raise LogError(
            f"{path} is a bag of ROS, and the package that reads bags is missing; `pip install "
            "'momantu-bt[bags]'`, in a checkout `make setup`"
        ) from None
    broken = (rosbag1.ReaderError, rosbag2.ReaderError, serde.SerdeError, apsw.Error)
    damaged = (OSError, sqlite3.Error, ValueError, KeyError, IndexError, struct.error)
    try:
        with rosbag1.Reader(path) if _first_of_ros(path) else rosbag2.Reader(path) as reader:
            yield reader
    except (*broken, *damaged) as error:
        raise LogError(
            f"the bag {path} cannot be read: {error}; a bag that was cut off is mended by "
            "`rosbag reindex` (ROS 1) or `ros2 bag reindex`"
        ) from None


def _first_of_ros(path: Path) -> bool:
    return path.suffix == ".bag"


def _scan_topic(path: Path, reader: Any, topic: str | None) -> Any:
    """The connection with the scans that are asked for."""
    found = [each for each in reader.connections if each.msgtype == SCAN]
    names = ", ".join(sorted(each.topic for each in found))
    if not found:
        kinds = ", ".join(sorted({each.msgtype for each in reader.connections})) or "nothing"
        raise LogError(f"{path} holds no sensor_msgs/LaserScan; it holds {kinds}")
    if topic is None:
        if len(found) > 1:
            raise LogError(f"{path} holds scans of several lasers: choose one by --scan: {names}")
        return found[0]
    chosen = [each for each in found if each.topic.strip("/") == topic.strip("/")]
    if not chosen:
        raise LogError(f"{path} has no scans on {topic!r}; it has {names}")
    return chosen[0]


def _decoder(path: Path) -> Callable[[bytes, str], Any]:
    """What makes a message of its bytes; types of others in the bag do not matter."""
    if _first_of_ros(path):
        store = get_typestore(Stores.ROS1_NOETIC)
        for kind in TF:
            store.register(get_types_from_msg(_TF, kind))
        return store.deserialize_ros1
    return get_typestore(Stores.ROS2_HUMBLE).deserialize_cdr


def _scan(message: Any) -> LaserScan:
    return LaserScan(
        _stamp(message),
        message.header.frame_id,
        float(message.angle_min),
        float(message.angle_increment),
        float(message.range_min),
        float(message.range_max),
        frozen(np.asarray(message.ranges, dtype=np.float64)),
    )


def _odometry(message: Any) -> tuple[str, str, float, Transform | None]:
    pose = message.pose.pose
    there = _transform(pose.position, pose.orientation)
    return message.header.frame_id, message.child_frame_id, _stamp(message), there


def _frames(message: Any, told: Published) -> None:
    for each in message.transforms:
        pose = _transform(each.transform.translation, each.transform.rotation)
        told.frame(each.header.frame_id, each.child_frame_id, _stamp(each), pose)


def _transform(position: Any, rotation: Any) -> Transform | None:
    return pose_of(
        (position.x, position.y, position.z), (rotation.w, rotation.x, rotation.y, rotation.z)
    )


def _stamp(message: Any) -> float:
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)
