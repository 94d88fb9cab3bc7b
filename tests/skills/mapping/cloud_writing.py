"""Messages of lidars and IMUs for `bag_writing`, as the drivers of several makers write them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from momantu_skills.mapping.logs.clouds.fields import NUMBERS
from numpy.typing import DTypeLike, NDArray

from momantu_bt.geometry import Transform
from momantu_bt.messages import ImuReading, PointCloud
from tests.skills.mapping.bag_writing import FIRST, Message, frame, header
from tests.skills.mapping.halls import RINGS, Moment

CLOUD, IMU = "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/Imu"
LAYOUTS: dict[str, list[tuple[str, DTypeLike]]] = {
    "velodyne": [
        ("x", "f4"),
        ("y", "f4"),
        ("z", "f4"),
        ("intensity", "f4"),
        ("ring", "u2"),
        ("time", "f4"),
    ],
    "ouster": [("x", "f4"), ("y", "f4"), ("z", "f4"), ("gap", "V4"), ("t", "u4"), ("ring", "u1")],
    "hesai": [("x", "f4"), ("y", "f4"), ("z", "f4"), ("timestamp", "f8"), ("ring", "u2")],
    "doubles": [("x", "f8"), ("y", "f8"), ("z", "f8"), ("t", "u4")],
    "rings": [("x", "f4"), ("y", "f4"), ("z", "f4"), ("ring", "u2")],
    "bare": [("x", "f4"), ("y", "f4"), ("z", "f4")],
}
"""Fields of points. Velodyne and "rings" stamp a turn's end, the others its beginning."""


@dataclass(frozen=True)
class Written:
    """How clouds are written. big: big-endian; gap: bytes after each row; rows: organised."""

    layout: str = "velodyne"
    big: bool = False
    gap: int = 0
    rows: bool = False
    nothing: int = 0
    """Points without an echo that are mixed in."""


USUAL = Written()


def cloud(turn: PointCloud, how: Written = USUAL, topic: str = "/points") -> Message:
    """A turn of `halls` as a message."""
    table, stamp = _table(turn, how)
    height = len(RINGS) if how.rows else 1
    width = len(table) // height
    step = table.dtype.itemsize
    data = np.zeros((height, width * step + how.gap), np.uint8)
    data[:, : width * step] = table.view(np.uint8).reshape(height, -1)
    content = {
        "header": header("lidar", stamp),
        "height": height,
        "width": width,
        "fields": [
            ("sensor_msgs/msg/PointField", each) for each in _fields(LAYOUTS[how.layout], table)
        ],
        "is_bigendian": how.big,
        "point_step": step,
        "row_step": width * step + how.gap,
        "data": data.ravel(),
        "is_dense": False,
    }
    return topic, CLOUD, stamp, content


def _table(turn: PointCloud, how: Written) -> tuple[NDArray[np.void], float]:
    """The points as records, and the stamp of their header."""
    order = ">" if how.big else "<"
    kind = np.dtype([(name, order + str(each)) for name, each in LAYOUTS[how.layout]])
    points, times = turn.points, turn.times
    rise = np.arctan2(points[:, 2], np.hypot(points[:, 0], points[:, 1]))
    rings = np.abs(rise[:, None] - RINGS).argmin(axis=1)
    if how.rows:
        points, times, rings = _organised(points, times, rings)
    if how.nothing:
        at = np.arange(0, len(points), max(1, len(points) // how.nothing))
        points = np.insert(points, at, np.array([[np.nan] * 3]), axis=0)
        points[(at + np.arange(len(at)))[::2]] = 0.0
        times, rings = np.insert(times, at, times[at]), np.insert(rings, at, rings[at])
    begin = FIRST + turn.stamp + float(np.nanmin(times))
    ends = how.layout in ("velodyne", "rings", "bare")
    stamp = FIRST + turn.stamp if ends else begin
    table = np.zeros(len(points), kind)
    for name, column in zip("xyz", points.T, strict=True):
        table[name] = column
    names = table.dtype.names or ()
    if "ring" in names:
        table["ring"] = rings
    if "time" in names:
        table["time"] = times
    if "timestamp" in names:
        table["timestamp"] = FIRST + turn.stamp + times.astype(np.float64)
    if "t" in names:
        table["t"] = np.round((times - np.nanmin(times)).astype(np.float64) * 1e9)
    return table, stamp


def _organised(points, times, rings):
    """Points in rows by their ring, in columns by their time; holes are NaN."""
    column = np.unique(times, return_inverse=True)[1]
    shape = (len(RINGS), int(column.max()) + 1)
    grid = np.full((*shape, 3), np.nan, np.float32)
    grid[rings, column] = points
    when = np.broadcast_to(np.unique(times), shape)
    rows = np.repeat(np.arange(shape[0]), shape[1])
    return grid.reshape(-1, 3), when.ravel().copy(), rows


def _fields(layout: list[tuple[str, DTypeLike]], table: NDArray[np.void]) -> Iterator[dict]:
    numbers = {kind: number for number, kind in NUMBERS.items()}
    for name, kind in layout:
        if kind in numbers:
            offset = table.dtype.fields[name][1]
            yield {"name": name, "offset": offset, "datatype": numbers[kind], "count": 1}


def imu(reading: ImuReading, topic: str = "/imu", frame_id: str = "imu") -> list[Message]:
    """The samples of a reading, a message each."""
    found = []
    for time, rate, force in zip(reading.times, reading.rates, reading.forces, strict=True):
        stamp = FIRST + float(time)
        content = {
            "header": header(frame_id, stamp),
            "orientation": (
                "geometry_msgs/msg/Quaternion",
                {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            ),
            "orientation_covariance": np.full(9, -1.0),
            "angular_velocity": _vector(rate),
            "angular_velocity_covariance": np.zeros(9),
            "linear_acceleration": _vector(force),
            "linear_acceleration_covariance": np.zeros(9),
        }
        found.append((topic, IMU, stamp, content))
    return found


def _vector(values):
    x, y, z = (float(value) for value in values)
    return "geometry_msgs/msg/Vector3", {"x": x, "y": y, "z": z}


def mount(child: str, pose: Transform, parent: str = "base_link") -> Message:
    """Where a sensor sits, on /tf_static."""
    topic, kind, stamp, content = frame(parent, child, FIRST, pose, "/tf_static")
    return topic, kind, stamp, content


def moved(moment: Moment) -> list[Message]:
    """Odometry on /tf."""
    return [frame("odom", "base_link", FIRST + stamp, pose) for stamp, pose, _ in moment.odometry]


def sorted_by_time(messages: Sequence[Message]) -> list[Message]:
    """Messages in the order in which a recorder writes them."""
    return sorted(messages, key=lambda message: message[2])
