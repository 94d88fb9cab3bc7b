"""Records in MCAP with messages for viewers: LaserScan and FrameTransforms of Foxglove, as JSON.

`momantu-bt run --record` writes such records; their messages are described at
https://docs.foxglove.dev/docs/visualization/message-schemas/introduction.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader

from momantu_bt.messages import LaserScan, frozen
from momantu_skills.mapping.logs.log import Log, LogError
from momantu_skills.mapping.logs.placed import Published, placed, pose_of

SCAN, TF = "foxglove.LaserScan", "foxglove.FrameTransforms"


def read_record(
    path: Path, topic: str | None = None, laid: Callable[[int, int], None] | None = None
) -> Log:
    """The scans of a record, of a cut-off one as far as it goes.

    topic: of the laser, if the record has several; its name without a slash will do. laid: see
    `placed`.

    Raises:
        LogError: the file cannot be read, or holds no scans with odometry.
    """
    told, scans = Published(), dict[str, list[LaserScan]]()
    notes = []
    try:
        for channel, kind, message in _messages(path):
            if kind == SCAN:
                scans.setdefault(channel, []).append(_scan(message))
            else:
                _frames(message, told)
    except (OSError, McapError) as error:
        if not scans:
            raise LogError(f"the record {path} cannot be read: {_reason(error)}") from None
        notes.append("the record is cut off; it is read as far as it goes")
    except (KeyError, TypeError, ValueError) as error:
        raise LogError(f"the record {path} is damaged: {error!r}") from None
    told.scans = _limited(scans[_chosen(path, list(scans), topic)])
    found = placed(path, told, laid)
    return Log(found.scans, (*notes, *found.notes))


def _chosen(path: Path, topics: list[str], topic: str | None) -> str:
    """The topic that is asked for, or the only one."""
    if not topics:
        raise LogError(
            f"{path} holds no scans; expected messages foxglove.LaserScan, as `momantu-bt run "
            "--record` writes them of a robot with a laser"
        )
    names = ", ".join(sorted(topics))
    if topic is None:
        if len(topics) > 1:
            raise LogError(f"{path} holds scans of several lasers: choose one by --scan: {names}")
        return topics[0]
    for each in topics:
        if each.strip("/") == topic.strip("/"):
            return each
    raise LogError(f"{path} has no scans on {topic!r}; it has {names}")


def _messages(path: Path) -> Iterator[tuple[str, str, Any]]:
    """Topic, name of the schema, and value of each message of interest, as they were written."""
    with path.open("rb") as file:
        reader = NonSeekingReader(file)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            if (
                schema is not None
                and schema.name in (SCAN, TF)
                and (channel.message_encoding == "json")
            ):
                yield channel.topic, schema.name, json.loads(message.data)


def _limited(scans: list[LaserScan]) -> list[LaserScan]:
    """The scans with the greatest range of their laser.

    The messages do not tell it, and beams that hit nothing have it, so it comes back exactly.
    """
    ranges = np.concatenate([scan.ranges for scan in scans])
    most = float(ranges.max(initial=0.0))
    if np.count_nonzero(ranges == most) < 2:
        return scans
    return [replace(scan, range_max=most) for scan in scans]


def _scan(message: Any) -> LaserScan:
    ranges = np.asarray(message["ranges"], dtype=np.float64)
    start, end = float(message["start_angle"]), float(message["end_angle"])
    step = (end - start) / max(1, ranges.size - 1)
    stamp = _stamp(message["timestamp"])
    return LaserScan(stamp, message["frame_id"], start, step, 1e-3, math.inf, frozen(ranges))


def _frames(message: Any, told: Published) -> None:
    for each in message["transforms"]:
        at, turned = each["translation"], each["rotation"]
        pose = pose_of(
            (at["x"], at["y"], at["z"]), (turned["w"], turned["x"], turned["y"], turned["z"])
        )
        told.frame(each["parent_frame_id"], each["child_frame_id"], _stamp(each["timestamp"]), pose)


def _stamp(told: Any) -> float:
    return float(told["sec"] + 1e-9 * told["nsec"])


def _reason(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or str(error) or "it ends too early")
