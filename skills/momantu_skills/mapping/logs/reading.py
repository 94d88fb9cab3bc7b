"""Reading a log by what it is: CARMEN's text, a bag of ROS, or a record of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from momantu_bt.lazy import lazily
from momantu_skills.mapping.logs import carmen
from momantu_skills.mapping.logs.log import Log, LogError

with lazily():
    from momantu_skills.mapping.logs import bags, records
    from momantu_skills.mapping.logs.clouds import reading as clouds

if TYPE_CHECKING:
    from collections.abc import Callable

    from momantu_skills.mapping.logs.clouds.log import CloudLog

RECORD = "run.mcap"
_ROS1, _MCAP, _SQLITE = b"#ROSBAG V", b"\x89MCAP0\r\n", b"SQLite format 3\0"
_ROS2_PROFILE = b"ros2"
_HEAD = 64
_POINTER = b"version https://git-lfs"
"""What Git LFS leaves in the place of a large file that was not fetched."""


def read_log(
    path: Path, topic: str | None = None, laid: Callable[[int, int], None] | None = None
) -> Log:
    """The scans of a log.

    topic: of the laser, in a bag or a record that has several. laid: told how many of how many
    scans are laid on those before, where nothing else tells how the base moved.

    Raises:
        LogError: there is no such log, it cannot be read, or it holds no scans with odometry.
    """
    _refuse_pointers(path)
    if _is_bag(path):
        return bags.read_bag(path, topic, laid)
    if path.is_dir():
        return records.read_record(path / RECORD, topic, laid)
    if _head(path).startswith(_MCAP):
        return records.read_record(path, topic, laid)
    if topic is not None:
        raise LogError(f"{path} has no topics; --scan is for bags and records")
    return carmen.read_carmen(path)


def read_clouds(path: Path, cloud: str | None = None, imu: str | None = None) -> CloudLog:
    """The turns of a lidar in a log, for a map in three dimensions.

    cloud, imu: topics, in a bag that has several; imu `none`: without it.

    Raises:
        LogError: it is no bag of ROS, it cannot be read, or it holds no clouds.
    """
    _refuse_pointers(path)
    if not _is_bag(path):
        raise LogError(
            f"{path} is no bag of ROS; in three dimensions only bags with sensor_msgs/PointCloud2 "
            "are mapped: leave out --dimensions 3 to map its scans in the plane"
        )
    return clouds.read_clouds(path, cloud, imu)


def _refuse_pointers(path: Path) -> None:
    """Raise a LogError if a log, or a file of its folder, was not fetched or cannot be read."""
    for file in [path] if not path.is_dir() else sorted(path.iterdir()):
        if file.is_file() and _head(file).startswith(_POINTER):
            raise LogError(
                f"{file} is a pointer of Git LFS, and not the log itself; `git lfs pull` in its "
                "repository fetches it"
            )


def _is_bag(path: Path) -> bool:
    """Whether a log is a bag of ROS 1 or 2.

    Raises:
        LogError: it cannot be read, or is a folder without a log.
    """
    if not path.is_dir():
        head = _head(path)
        second = head.startswith(_SQLITE) or (head.startswith(_MCAP) and _ROS2_PROFILE in head)
        return second or head.startswith(_ROS1) or path.suffix == ".bag"
    if (path / "metadata.yaml").exists():
        return True
    if not (path / RECORD).exists():
        raise LogError(
            f"{path} is a folder without a log; expected metadata.yaml (a bag of ROS 2) or "
            f"{RECORD} (a record of `momantu-bt run --record`)"
        )
    return False


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(_HEAD)
    except OSError as error:
        raise LogError(f"the log {path} cannot be read: {error.strerror}") from None
