"""Reading a log by what it is: CARMEN's text, a bag of ROS, or a record of a run."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.lazy import lazily
from momantu_skills.mapping.logs import carmen
from momantu_skills.mapping.logs.log import Log, LogError

with lazily():
    from momantu_skills.mapping.logs import bags, records

RECORD = "run.mcap"
_ROS1, _MCAP, _SQLITE = b"#ROSBAG V", b"\x89MCAP0\r\n", b"SQLite format 3\0"
_ROS2_PROFILE = b"ros2"
_HEAD = 64


def read_log(path: Path, topic: str | None = None) -> Log:
    """The scans of a log.

    topic: of the laser, in a bag or a record that has several.

    Raises:
        LogError: there is no such log, it cannot be read, or it holds no scans with odometry.
    """
    if path.is_dir():
        return _folder(path, topic)
    head = _head(path)
    if head.startswith(_ROS1) or path.suffix == ".bag":
        return bags.read_bag(path, topic)
    if head.startswith(_SQLITE) or (head.startswith(_MCAP) and _ROS2_PROFILE in head):
        return bags.read_bag(path, topic)
    if head.startswith(_MCAP):
        return records.read_record(path, topic)
    if topic is not None:
        raise LogError(f"{path} has no topics; --scan is for bags and records")
    return carmen.read_carmen(path)


def _folder(path: Path, topic: str | None) -> Log:
    if (path / "metadata.yaml").exists():
        return bags.read_bag(path, topic)
    if (path / RECORD).exists():
        return records.read_record(path / RECORD, topic)
    raise LogError(
        f"{path} is a folder without a log; expected metadata.yaml (a bag of ROS 2) or {RECORD} (a "
        "record of `momantu-bt run --record`)"
    )


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(_HEAD)
    except OSError as error:
        raise LogError(f"the log {path} cannot be read: {error.strerror}") from None
