"""Bags of ROS 1 and 2: the same scans as were recorded, or a sentence."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from momantu_skills.mapping.logs.log import LogError, LoggedScan
from momantu_skills.mapping.logs.reading import read_log

from momantu_bt.cli import main
from momantu_bt.errors import ExitCode
from momantu_bt.geometry import Pose2D
from tests.skills.mapping.bag_writing import (
    FIRST,
    Message,
    frame,
    odometry,
    ros1,
    ros2,
    ros2_mcap,
    scan,
)
from tests.skills.mapping.walls import ROUND, driven, logged

MOUNT = Pose2D(0.2, 0.0)
WAY = logged(driven(ROUND[:2], 0.5), 3)
Write = Callable[[Path, Sequence[Message]], Path]
KINDS: list[tuple[Write, str]] = [(ros1, "way.bag"), (ros2, "way"), (ros2_mcap, "way")]


def by_tf(scans: Sequence[LoggedScan] = WAY) -> list[Message]:
    """What a robot publishes that tells its motion by /tf alone."""
    messages = [frame("base_link", "laser", FIRST, MOUNT, "/tf_static")]
    for each in scans:
        messages.append(frame("odom", "base_link", FIRST + each.stamp, each.odom_from_base))
        messages.append(scan(each))
    return messages


def by_odometry(scans: Sequence[LoggedScan] = WAY, *, mounted: bool = True) -> list[Message]:
    """The same by messages of odometry."""
    mount = [frame("base_link", "laser", FIRST, MOUNT, "/tf_static")] if mounted else []
    return [*mount, *(each(one) for one in scans for each in (odometry, scan))]


@pytest.mark.parametrize(("write", "name"), KINDS)
@pytest.mark.parametrize("told", [by_tf, by_odometry])
def test_a_bag_gives_back_what_was_recorded(write, name, told, tmp_path) -> None:
    found = read_log(write(tmp_path / name, told()))
    assert found.notes == ()
    assert len(found.scans) == len(WAY)
    for read, true in zip(found.scans, WAY, strict=True):
        assert read.odom_from_base.distance_to(true.odom_from_base) < 1e-6
        assert abs((read.odom_from_base.inverse() @ true.odom_from_base).yaw) < 1e-6
        assert np.array_equal(read.rays.hit, true.rays.hit)
        assert np.abs(read.rays.points() - true.rays.points()).max() < 1e-5


@pytest.mark.parametrize("plugin", [ros2, ros2_mcap])
def test_one_file_of_a_ros2_bag_is_a_log_too(plugin, tmp_path) -> None:
    folder = plugin(tmp_path / "way", by_tf())
    (file,) = [path for path in folder.iterdir() if path.name != "metadata.yaml"]
    assert len(read_log(file).scans) == len(WAY)


def test_odometry_is_taken_between_two_messages(tmp_path) -> None:
    """Scans come 0.1 s after odometry, as they do on robots."""
    late = [LoggedScan(each.stamp + 0.1, each.odom_from_base, each.rays) for each in WAY]
    messages = [frame("base_link", "laser", FIRST, MOUNT, "/tf_static")]
    messages += [frame("odom", "base_link", FIRST + e.stamp, e.odom_from_base) for e in WAY]
    messages += [scan(each) for each in late]
    found = read_log(ros1(tmp_path / "way.bag", sorted(messages, key=lambda m: m[2])))
    assert len(found.scans) == len(WAY) - 1
    assert "at whose time no odometry is told" in found.notes[0]
    step = WAY[1].odom_from_base.distance_to(WAY[0].odom_from_base)
    gone = found.scans[0].odom_from_base.distance_to(WAY[0].odom_from_base)
    assert gone == pytest.approx(0.2 * step, rel=1e-3)


def test_a_laser_that_hangs_upside_down_sees_left_on_its_left(tmp_path) -> None:
    messages = by_tf()
    topic, kind, stamp, content = messages[0]
    transform = content["transforms"][0][1]["transform"][1]
    transform["rotation"] = (
        "geometry_msgs/msg/Quaternion",
        {"x": 1.0, "y": 0.0, "z": 0.0, "w": 0.0},
    )
    messages[0] = (topic, kind, stamp, content)
    read = read_log(ros2(tmp_path / "way", messages)).scans[0].rays
    there = WAY[0].rays.points() * (1.0, -1.0)
    assert np.abs(read.points() - there).max() < 1e-5


@pytest.mark.parametrize("messages", [by_odometry(mounted=False), by_tf()[1:]])
def test_without_a_mount_the_laser_is_taken_to_be_in_the_middle(messages, tmp_path) -> None:
    found = read_log(ros2(tmp_path / "way", messages))
    assert len(found.scans) == len(WAY)
    assert "nothing tells where 'laser' sits on 'base_link'" in found.notes[0]
    assert np.array_equal(found.scans[0].rays.origin, [0.0, 0.0])


def test_one_of_several_lasers_is_chosen_by_its_topic(tmp_path) -> None:
    messages = [*by_tf(), *(scan(each, "/back/scan") for each in WAY)]
    path = ros2(tmp_path / "way", messages)
    with pytest.raises(LogError, match=r"several lasers: choose one by --scan: /back/scan, /scan"):
        read_log(path)
    assert len(read_log(path, "back/scan").scans) == len(WAY)
    with pytest.raises(LogError, match=r"no scans on 'front'; it has /back/scan, /scan"):
        read_log(path, "front")


def _backwards() -> list[Message]:
    """The clock of the stamps is set back on the way; that of the recorder is not."""
    later = [LoggedScan(each.stamp + 100.0, each.odom_from_base, each.rays) for each in WAY]
    messages = [*by_tf(later), *by_tf(WAY)]
    return [(topic, kind, FIRST + n, told) for n, (topic, kind, _, told) in enumerate(messages)]


def _unlike() -> list[LoggedScan]:
    """Scans that have nothing in common."""
    noise = np.random.default_rng(0)
    return [
        replace(each, rays=replace(each.rays, ranges=noise.uniform(1.0, 9.0, each.rays.hit.size)))
        for each in WAY[:25]
    ]


def test_without_odometry_the_scans_tell_how_the_base_moved(tmp_path) -> None:
    mount = frame("base_link", "laser", FIRST, MOUNT, "/tf_static")
    way = logged(driven(ROUND[:2], 0.1), 3)
    laid = []
    bag = ros2(tmp_path / "way", [mount, *(scan(each) for each in way)])
    found = read_log(bag, laid=lambda *told: laid.append(told))
    assert laid == [(n, len(way)) for n in range(1, len(way) + 1)]
    assert "nothing tells how the base moved, so the scans do" in found.notes[0]
    assert len(found.scans) == len(way)
    assert np.allclose(found.scans[0].rays.origin, [0.2, 0.0])
    end = found.scans[-1].odom_from_base
    assert (end.x, end.y) == pytest.approx((12.4, 0.0), abs=0.3)


@pytest.mark.parametrize(
    ("messages", "said"),
    [
        (lambda: [odometry(each) for each in WAY], "holds no sensor_msgs/LaserScan; it holds nav_"),
        (
            lambda: [scan(each) for each in _unlike()],
            r"nothing tells how the base moved: \d+ of 25 scans do not fit those before",
        ),
        (_backwards, "the clock runs backwards"),
        (
            lambda: [
                frame("base_link", "laser", FIRST, MOUNT, "/tf_static", tilted=True),
                *by_tf()[1:],
            ],
            "the laser 'laser' is not level on 'base_link'",
        ),
        (
            lambda: [
                *by_tf()[:1],
                *(frame("odom", "base_link", FIRST - 99.0 + n, MOUNT) for n in range(3)),
                *(scan(each) for each in WAY),
            ],
            "do not overlap",
        ),
    ],
)
def test_what_is_no_log_is_told(messages, said, tmp_path) -> None:
    with pytest.raises(LogError, match=said):
        read_log(ros1(tmp_path / "way.bag", messages()))


def _edited(messages: list[Message], kind: str, **changes: Any) -> list[Message]:
    """The messages with other content in those of a kind."""
    return [
        (topic, each, stamp, {**told, **changes} if each.endswith(kind) else told)
        for topic, each, stamp, told in messages
    ]


def _lost(x: float, w: float) -> dict[str, Any]:
    """The pose of odometry that is none."""
    where = {
        "position": ("geometry_msgs/msg/Point", {"x": x, "y": 0.0, "z": 0.0}),
        "orientation": ("geometry_msgs/msg/Quaternion", {"x": 0.0, "y": 0.0, "z": 0.0, "w": w}),
    }
    pose = {"pose": ("geometry_msgs/msg/Pose", where), "covariance": np.zeros(36)}
    return {"pose": ("geometry_msgs/msg/PoseWithCovariance", pose)}


def _by_odometry() -> list[Message]:
    pairs = ((odometry(each), scan(each)) for each in WAY)
    return [frame("base_link", "laser", FIRST, MOUNT), *itertools.chain(*pairs)]


@pytest.mark.parametrize(("x", "w"), [(np.nan, 1.0), (1e300, 1.0), (0.0, 0.0)])
def test_poses_that_are_none_are_left_out(x, w, tmp_path) -> None:
    messages = _by_odometry()
    at = next(n for n, each in enumerate(messages) if each[0] == "/odom") + 6
    messages[at : at + 1] = _edited(messages[at : at + 1], "Odometry", **_lost(x, w))
    log = read_log(ros2(tmp_path / "one", messages))
    assert len(log.scans) == len(WAY)
    assert all(abs(each.odom_from_base.x) < 100.0 for each in log.scans)
    assert log.notes == ("left out 1 pose whose numbers are not finite, or no pose's",)
    lost = _edited(messages, "Odometry", **_lost(x, w))
    without = read_log(ros2(tmp_path / "all", lost))
    assert f"left out {len(WAY)} poses" in without.notes[0]
    assert "so the scans do" in without.notes[-1]


@pytest.mark.parametrize("increment", [np.nan, 0.0, 1.0])
def test_scans_whose_beams_point_nowhere_are_told(increment, tmp_path) -> None:
    messages = _edited(_by_odometry(), "LaserScan", angle_increment=increment)
    with pytest.raises(LogError, match="expected beams over at most a turn"):
        read_log(ros2(tmp_path / "way", messages))


@pytest.mark.parametrize(("write", "name"), KINDS)
def test_a_bag_that_was_cut_off_is_told(write, name, tmp_path) -> None:
    path = write(tmp_path / name, by_tf())
    file = path if path.is_file() else next(p for p in path.iterdir() if p.suffix != ".yaml")
    data = file.read_bytes()
    file.write_bytes(data[: len(data) // 3])
    with pytest.raises(LogError, match="cannot be read"):
        read_log(path)


@pytest.mark.parametrize("content", [b"", b"#ROSBAG V2.0\n", b"nothing of the kind"])
def test_a_file_that_only_calls_itself_a_bag_is_told(content, tmp_path) -> None:
    path = tmp_path / "way.bag"
    path.write_bytes(content)
    with pytest.raises(LogError, match="cannot be read"):
        read_log(path)


def test_a_bag_that_was_not_fetched_is_told(tmp_path) -> None:
    pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 5\n"
    (tmp_path / "way.bag").write_bytes(pointer)
    with pytest.raises(LogError, match=r"way.bag is a pointer of Git LFS.*`git lfs pull`"):
        read_log(tmp_path / "way.bag")
    bag = ros2(tmp_path / "way", by_tf())
    file = next(bag.glob("*.db3"))
    file.write_bytes(pointer)
    with pytest.raises(LogError, match=r"\.db3 is a pointer of Git LFS"):
        read_log(bag)
    file.unlink()
    with pytest.raises(LogError, match=r"files are missing: .*metadata.yaml names them"):
        read_log(bag)


def test_a_folder_without_a_log_is_told(tmp_path) -> None:
    with pytest.raises(LogError, match="folder without a log; expected metadata.yaml"):
        read_log(tmp_path)


def test_without_the_package_it_is_told_what_to_install(tmp_path, monkeypatch) -> None:
    path = ros1(tmp_path / "way.bag", by_tf())
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(LogError, match=r"pip install 'momantu-bt\[bags\]'"):
        read_log(path)


def test_the_verb_makes_a_map_of_a_bag(tmp_path, capsys) -> None:
    path = ros2(tmp_path / "way", by_tf())
    out = tmp_path / "map"
    assert main(["map", "--log", str(path), "-o", str(out)]) == ExitCode.SUCCESS
    assert (out / "map.yaml").exists()
    assert "a map of" in capsys.readouterr().out
