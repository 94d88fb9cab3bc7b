"""Bags of ROS 1 and ROS 2, opened by `rosbags`: topics, and messages of frames and odometry."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from momantu_bt.geometry import Transform
from momantu_bt.lazy import lazily
from momantu_skills.mapping.logs.log import LogError
from momantu_skills.mapping.logs.placed import Published, pose_of

with lazily():
    import apsw
    from rosbags import rosbag1, rosbag2, serde
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

ODOMETRY = "nav_msgs/msg/Odometry"
TF = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
"""Today's type, and the older one of ROS 1."""
MOVING = (*TF, ODOMETRY)
"""Types of messages that tell where frames are."""
_TF = "geometry_msgs/TransformStamped[] transforms"


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """The bag, open; what the library raises becomes a sentence.

    Raises:
        LogError: the package `rosbags` is missing, or the bag cannot be read.
    """
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
        cure = "a bag that was cut off is mended by `rosbag reindex` (ROS 1) or `ros2 bag reindex`"
        if "files are missing" in str(error):
            cure = "metadata.yaml names them: put them beside it"
        raise LogError(f"the bag {path} cannot be read: {error}; {cure}") from None


def _first_of_ros(path: Path) -> bool:
    return path.suffix == ".bag"


def decoder(path: Path) -> Callable[[bytes, str], Any]:
    """What makes a message of its bytes; types of others in the bag do not matter."""
    if _first_of_ros(path):
        store = get_typestore(Stores.ROS1_NOETIC)
        for kind in TF:
            store.register(get_types_from_msg(_TF, kind))
        return store.deserialize_ros1
    return get_typestore(Stores.ROS2_HUMBLE).deserialize_cdr


def chosen(path: Path, found: list[Any], topic: str | None, what: str, option: str) -> Any:
    """The connection that is asked for, of those found; there is one at least.

    topic: its name, without a slash if one likes; None: the only one. what: is on these topics, as
    in "scans of several lasers"; option: that chooses one.

    Raises:
        LogError: there are several, or none has that name.
    """
    names = ", ".join(sorted({each.topic for each in found}))
    if topic is None:
        if len({each.topic for each in found}) > 1:
            raise LogError(f"{path} holds {what}: choose one by {option}: {names}")
        return found[0]
    for each in found:
        if each.topic.strip("/") == topic.strip("/"):
            return each
    raise LogError(f"{path} has no {what.split()[0]} on {topic!r}; it has {names}")


def kinds(reader: Any) -> str:
    """The types of messages that a bag holds, in words."""
    return ", ".join(sorted({each.msgtype for each in reader.connections})) or "nothing"


def enter(message: Any, kind: str, told: Published) -> None:
    """Enter what a message of one of the types `MOVING` tells."""
    if kind == ODOMETRY:
        pose = message.pose.pose
        there = _transform(pose.position, pose.orientation)
        told.moved(message.header.frame_id, message.child_frame_id, stamp_of(message), there)
        return
    for each in message.transforms:
        there = _transform(each.transform.translation, each.transform.rotation)
        told.frame(each.header.frame_id, each.child_frame_id, stamp_of(each), there)


def stamp_of(message: Any) -> float:
    """The time in a message's header, s."""
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


def _transform(position: Any, rotation: Any) -> Transform | None:
    return pose_of(
        (position.x, position.y, position.z), (rotation.w, rotation.x, rotation.y, rotation.z)
    )
