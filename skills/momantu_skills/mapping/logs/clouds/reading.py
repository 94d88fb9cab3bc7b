"""A bag as a log for a map in three dimensions: PointCloud2, Imu, TF and Odometry."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import PointCloud, frozen
from momantu_skills.mapping.logs import ros
from momantu_skills.mapping.logs.cleaning import backwards
from momantu_skills.mapping.logs.clouds import times
from momantu_skills.mapping.logs.clouds.fields import CloudError, Points, points_of
from momantu_skills.mapping.logs.clouds.imu import ImuMessages
from momantu_skills.mapping.logs.clouds.log import CloudLog, LeftOut
from momantu_skills.mapping.logs.log import LogError
from momantu_skills.mapping.logs.placed import Published, broken_poses, moving
from momantu_skills.mapping.logs.transforms import Transforms, plain

CLOUD, IMU = "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/Imu"
PACKETS = ("VelodyneScan", "PacketMsg", "CustomMsg", "PandarScan", "RawPacket")
"""Messages of drivers from which their own programs make point clouds."""
NO_IMU = "none"
MOST = 60_000
"""Points of a turn that are used at most; of more, every second one, every third one, and so on."""
FLAT = 0.02
"""Deviation of the elevations of points, rad, below which a lidar sees one plane."""
_HOW = {
    times.TOLD: "",
    times.OTHER_CLOCK: "the points' times are of another clock than the headers' stamps, which are "
    "taken to be those of each turn's beginning",
    times.TURNED: "the points have no times: they are taken to have been measured evenly as the "
    "lidar turned, and a turn to end at its stamp",
    times.AT_ONCE: "the points have no times, and their order tells none: a turn's points are "
    "taken to have been measured at once, so that motion bends them",
}


@dataclass(slots=True)
class _Told:
    """What the first reading finds."""

    imu: ImuMessages | None
    published: Published = field(default_factory=Published)
    stamps: list[float] = field(default_factory=list)
    frame: str = ""
    first: Points | None = None
    broken: str = ""


def read_clouds(path: Path, topic: str | None = None, imu: str | None = None) -> CloudLog:
    """The turns, the IMU and the motion in a bag; the turns are read when they are asked for.

    topic: of the lidar, imu: of the IMU, if the bag has several; `none`: the IMU is not used.

    Raises:
        LogError: the package `rosbags` is missing, the bag cannot be read, or it holds no clouds
            that can be mapped.
    """
    told, lidar = _first_reading(path, topic, imu)
    if told.first is None:
        raise LogError(f"{path}: no cloud on {lidar} can be used: {told.broken or 'all are empty'}")
    notes = _check_stamps(path, lidar, told)
    base, wheels, assumed = _base(told)
    notes += assumed
    frames, begun = told.published.transforms, told.stamps[0]
    if told.published.broken:
        notes.append(broken_poses(told.published))
    samples = None
    if told.imu is not None:
        samples, more = told.imu.samples(path, frames, base, begun)
        notes += more
    if samples is not None and (
        samples.times[-1] < told.stamps[0] or samples.times[0] > told.stamps[-1]
    ):
        raise LogError(
            f"{path}: the stamps of the IMU and of the clouds do not overlap: their clocks differ. "
            "--imu none maps without the IMU"
        )
    period = _period(told.stamps)
    how = _HOW[times.measured(told.first, begun, period).how]
    left_out = LeftOut()
    return CloudLog(
        count=len(told.stamps),
        turns=lambda: _turns(path, lidar, period, left_out),
        base=base,
        base_from_lidar=frames.mounted(base, told.frame, begun),
        imu=samples,
        wheels=wheels,
        notes=(*notes, *([how] if how else ())),
        left_out=left_out,
    )


def _first_reading(path: Path, topic: str | None, imu: str | None) -> tuple[_Told, str]:
    """All but the points, and the lidar's topic."""
    with ros.opened(path) as reader:
        lidar = _lidar(path, reader, topic)
        inertial = _imu(path, reader, imu)
        told = _Told(None if inertial is None else ImuMessages(inertial.topic))
        used = {lidar.topic, *(() if inertial is None else (inertial.topic,))}
        asked = [c for c in reader.connections if c.msgtype in ros.MOVING or c.topic in used]
        decode = ros.decoder(path)
        for connection, _, data in reader.messages(connections=asked):
            message = decode(data, connection.msgtype)
            if connection.msgtype == CLOUD:
                _cloud(message, told)
            elif connection.msgtype == IMU:
                if told.imu is not None:
                    told.imu.add(message)
            else:
                ros.enter(message, connection.msgtype, told.published)
    return told, str(lidar.topic)


def _cloud(message: Any, told: _Told) -> None:
    """Note a cloud's stamp and frame, and the points of the first one that has some."""
    told.frame = told.frame or plain(message.header.frame_id)
    told.stamps.append(ros.stamp_of(message))
    if told.first is None:
        try:
            found = points_of(message)
        except CloudError as error:
            told.broken = told.broken or str(error)
            return
        told.first = found if len(found.xyz) else None


def _lidar(path: Path, reader: Any, topic: str | None) -> Any:
    """The connection with the clouds that are asked for."""
    found = [each for each in reader.connections if each.msgtype == CLOUD]
    if found:
        return ros.chosen(path, found, topic, "clouds of several sensors", "--cloud")
    held = ros.kinds(reader)
    hint = ""
    if any(name in held for name in PACKETS):
        hint = "; the packets of a driver are made clouds by the driver's own program"
    elif "LaserScan" in held:
        hint = "; leave out --dimensions 3 to map its scans in the plane"
    raise LogError(f"{path} holds no sensor_msgs/PointCloud2; it holds {held}{hint}")


def _imu(path: Path, reader: Any, topic: str | None) -> Any:
    """The connection with the IMU that is asked for; None: there is none, or it is not wanted."""
    found = [each for each in reader.connections if each.msgtype == IMU]
    if topic == NO_IMU or (topic is None and not found):
        return None
    if not found:
        raise LogError(f"{path} holds no sensor_msgs/Imu; it holds {ros.kinds(reader)}")
    return ros.chosen(path, found, topic, "samples of several IMUs", "--imu")


def _check_stamps(path: Path, lidar: str, told: _Told) -> list[str]:
    """Refuse clouds without times, and clouds of a lidar that sees one plane; notes."""
    if len(told.stamps) > 1 and max(told.stamps) == min(told.stamps):
        raise LogError(
            f"{path}: the clouds of {lidar} have no times: all are stamped {told.stamps[0]:g} s; "
            "expected a rising stamp in each header"
        )
    notes = backwards(
        told.stamps, lambda _, said, cure: LogError(f"{path}: {lidar}: {said}\n  {cure}"), "cloud"
    )
    assert told.first is not None
    xyz = told.first.xyz
    elevations = np.arctan2(xyz[:, 2], np.hypot(xyz[:, 0], xyz[:, 1]))
    if float(elevations.std()) < FLAT:
        raise LogError(
            f"{path}: the points of {lidar} lie in one plane; a map in three dimensions needs a "
            "lidar of several rings, and a map in the plane messages sensor_msgs/LaserScan"
        )
    return notes


def _base(told: _Told) -> tuple[str, Callable[[float], Transform | None] | None, list[str]]:
    """The base's frame, its odometry if there is any, and what was assumed."""
    frames = told.published.transforms
    found = moving(told.frame, told.stamps[0], told.published)
    if found is not None:
        base = found.base
        if any(frames.moved(base, stamp) is not None for stamp in told.stamps):
            return base, lambda stamp: frames.moved(base, stamp), list(found.notes)
        late = f"the stamps of the clouds and of {found.odom!r} do not overlap; it is left out"
        return base, None, [*found.notes, late, *_alone(base)]
    base = _highest_still(frames, told.frame)
    return base, None, _alone(base)


def _alone(base: str) -> list[str]:
    return [f"there is no odometry: how {base!r} moved is told by the clouds alone"]


def _highest_still(frames: Transforms, frame: str) -> str:
    """The highest frame above a sensor's on which it does not move."""
    chain = frames.above(frame)
    number = next(
        (n for n, each in enumerate(chain[:-1]) if not frames.still(each)), len(chain) - 1
    )
    return chain[number]


def _period(stamps: list[float]) -> float:
    """The usual time between two turns, s."""
    steps = np.diff(np.sort(stamps))
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if len(steps) else 0.1


def _turns(path: Path, lidar: str, period: float, left_out: LeftOut) -> Iterator[PointCloud]:
    """The turns of a lidar, in its frame."""
    with ros.opened(path) as reader:
        decode = ros.decoder(path)
        asked = [c for c in reader.connections if c.topic == lidar and c.msgtype == CLOUD]
        for connection, _, data in reader.messages(connections=asked):
            message = decode(data, connection.msgtype)
            try:
                points = points_of(message)
            except CloudError as error:
                left_out.add(str(error))
                continue
            if not len(points.xyz):
                left_out.add("it has no points")
                continue
            found = times.measured(points, ros.stamp_of(message), period)
            yield _thinned(points.xyz, found, plain(message.header.frame_id))


def _thinned(xyz: Array, found: times.Measured, frame: str) -> PointCloud:
    every = 1 + len(xyz) // MOST
    after = None if found.times is None else frozen(found.times[::every].astype(np.float32))
    return PointCloud(found.stamp, frame, frozen(xyz[::every].astype(np.float32)), after)
