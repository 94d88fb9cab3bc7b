"""The scans of a bag of ROS 1 or ROS 2: LaserScan, TF and Odometry."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.messages import LaserScan, frozen
from momantu_skills.mapping.logs import ros
from momantu_skills.mapping.logs.log import Log, LogError
from momantu_skills.mapping.logs.placed import Published, placed

SCAN, CLOUD = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2"


def read_bag(
    path: Path, topic: str | None = None, laid: Callable[[int, int], None] | None = None
) -> Log:
    """The scans of a bag: a `.bag`, the folder of a ROS 2 bag, or one `.mcap` or `.db3` of it.

    topic: of the laser, if the bag has several; its name without a slash will do. laid: see
    `placed`.

    Raises:
        LogError: the package `rosbags` is missing, the bag cannot be read, or it holds no scans
            with odometry.
    """
    with ros.opened(path) as reader:
        scans = _scan_topic(path, reader, topic)
        asked = [c for c in reader.connections if c.msgtype in ros.MOVING or c is scans]
        decode, told = ros.decoder(path), Published()
        for connection, _, data in reader.messages(connections=asked):
            message = decode(data, connection.msgtype)
            if connection.msgtype == SCAN:
                told.scans.append(_scan(message))
            else:
                ros.enter(message, connection.msgtype, told)
    if not told.scans:
        raise LogError(f"{path}: the topic {scans.topic} holds no scan")
    return placed(path, told, laid)


def _scan_topic(path: Path, reader: Any, topic: str | None) -> Any:
    """The connection with the scans that are asked for."""
    found = [each for each in reader.connections if each.msgtype == SCAN]
    if not found:
        clouds = any(each.msgtype == CLOUD for each in reader.connections)
        hint = "; --dimensions 3 maps its point clouds" if clouds else ""
        raise LogError(f"{path} holds no sensor_msgs/LaserScan; it holds {ros.kinds(reader)}{hint}")
    return ros.chosen(path, found, topic, "scans of several lasers", "--scan")


def _scan(message: Any) -> LaserScan:
    return LaserScan(
        ros.stamp_of(message),
        message.header.frame_id,
        float(message.angle_min),
        float(message.angle_increment),
        float(message.range_min),
        float(message.range_max),
        frozen(np.asarray(message.ranges, dtype=np.float64)),
    )
