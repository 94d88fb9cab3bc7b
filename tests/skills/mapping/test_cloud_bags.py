"""Bags with point clouds and an IMU: the turns that were recorded, and the map; or a sentence."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest
from momantu_skills.mapping.logs.clouds import reading as clouds
from momantu_skills.mapping.logs.log import LogError
from momantu_skills.mapping.logs.reading import read_clouds
from momantu_skills.mapping.three_d import logged

from momantu_bt.cli import main
from momantu_bt.errors import ExitCode
from momantu_bt.geometry import Transform
from momantu_bt.messages import ImuReading, PointCloud
from tests.skills.mapping import cloud_writing as writing
from tests.skills.mapping.bag_writing import FIRST, Message, ros1, ros2, ros2_mcap, scan
from tests.skills.mapping.cloud_writing import Written, cloud, imu, moved, sorted_by_time
from tests.skills.mapping.halls import MOUNT, RING, driven, moments
from tests.skills.mapping.walls import ROUND
from tests.skills.mapping.walls import driven as driven_flat
from tests.skills.mapping.walls import logged as scans_of

WAY = list(moments(driven([(1.5, 1.5), (3.5, 1.5), (3.5, 2.0)]), RING))
SHORT = WAY[:4]
MOUNTS = [writing.mount("lidar", MOUNT), writing.mount("imu", Transform())]
TRUE = [WAY[0].truth.inverse() @ each.truth for each in WAY]


def messages(
    way=WAY, how=writing.USUAL, *, wheels=True, inertial=True, mounts=True, topic="/points"
) -> list[Message]:
    """A recorded drive; how: its clouds are written."""
    found = list(MOUNTS) if mounts else []
    for moment in way:
        found += moved(moment) if wheels else []
        if inertial:
            found += itertools.chain(*(imu(each) for *_, each in moment.odometry))
        found.append(cloud(moment.turn, how, topic))
    return sorted_by_time(found)


def ended(path: Path) -> tuple[logged.Surveyed, float]:
    """The survey of a bag, and how far off its end is in the plane, m."""
    found = logged.surveyed(read_clouds(path), lambda done, loops: False)
    assert found is not None
    poses = [pose for _, pose in found.survey.mapper.trajectory()]
    off = (poses[0].inverse() @ poses[-1]).position - TRUE[-1].position
    return found, float(np.linalg.norm(off))


# what is read


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("layout", sorted(writing.LAYOUTS))
def test_the_points_and_their_times_come_back(layout, big, tmp_path) -> None:
    how = Written(layout, big=big, gap=7, nothing=40)
    path = ros1(tmp_path / "way.bag", messages(SHORT, how, inertial=False))
    log = read_clouds(path)
    turns = list(log.turns())
    assert log.count == len(turns) == len(SHORT)
    for turn, moment in zip(turns, SHORT, strict=True):
        true = moment.turn
        assert turn.stamp == pytest.approx(FIRST + true.stamp, abs=1e-6)
        assert np.array_equal(turn.points, true.points)
        if layout == "bare":
            assert turn.times is None
        else:
            allowed = 2e-6 if layout != "rings" else 2e-3
            assert np.abs(turn.times - true.times).max() < allowed


@pytest.mark.parametrize("write", [ros2, ros2_mcap])
def test_bags_of_ros_2_are_the_same(write, tmp_path) -> None:
    path = write(tmp_path / "way", messages(SHORT))
    turns = list(read_clouds(path).turns())
    for turn, moment in zip(turns, SHORT, strict=True):
        assert np.array_equal(turn.points, moment.turn.points)


def test_rows_of_an_organised_cloud_are_rings(tmp_path) -> None:
    how = Written("bare", rows=True)
    turns = list(read_clouds(ros1(tmp_path / "way.bag", messages(SHORT, how))).turns())
    for turn, moment in zip(turns, SHORT, strict=True):
        order = np.lexsort(moment.turn.points.T)
        mine = np.lexsort(turn.points.T)
        assert np.array_equal(turn.points[mine], moment.turn.points[order])
        assert np.abs(turn.times[mine] - moment.turn.times[order]).max() < 2e-3


def test_what_does_not_turn_has_no_times_of_points(tmp_path) -> None:
    ahead = []
    for moment in SHORT:
        points = moment.turn.points
        seen = np.abs(np.arctan2(points[:, 1], points[:, 0])) < 1.0
        turn = PointCloud(moment.stamp, "lidar", points[seen], moment.turn.times[seen])
        ahead.append(cloud(turn, Written("rings")))
    log = read_clouds(ros1(tmp_path / "way.bag", [*MOUNTS, *ahead]))
    assert all(turn.times is None for turn in log.turns())
    assert any("measured at once" in note for note in log.notes)


def test_times_of_another_clock_begin_at_the_stamp(tmp_path, monkeypatch) -> None:
    written = messages(SHORT, Written("hesai"))
    for topic, _, _, content in written:
        if topic == "/points":
            content["header"][1]["stamp"] += 1000.0
    log = read_clouds(ros1(tmp_path / "way.bag", written), imu="none")
    assert any("of another clock" in note for note in log.notes)
    for turn, moment in zip(log.turns(), SHORT, strict=True):
        assert turn.stamp == pytest.approx(FIRST + 1000.0 + moment.stamp, abs=1e-5)
        assert np.abs(turn.times - moment.turn.times).max() < 2e-6


def test_of_too_many_points_every_second_one_is_used(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(clouds, "MOST", 3000)
    turn = next(read_clouds(ros1(tmp_path / "way.bag", messages(SHORT))).turns())
    assert np.array_equal(turn.points, SHORT[0].turn.points[::2])


# the map


@pytest.mark.parametrize(
    ("told", "off", "said"),
    [
        ({}, 0.02, ""),
        ({"inertial": False}, 0.02, ""),
        ({"wheels": False}, 0.03, "there is no odometry"),
        ({"wheels": False, "inertial": False}, 0.05, "told by the clouds alone"),
    ],
)
def test_a_drive_ends_where_it_truly_ends(told, off, said, tmp_path) -> None:
    path = ros1(tmp_path / "way.bag", messages(**told))
    found, apart = ended(path)
    assert apart < off
    assert found.survey.mapper.doubtful == 0
    assert found.lidar_height == pytest.approx(0.4, abs=0.02)
    assert found.stood.note == ""
    notes = read_clouds(path).notes
    assert said in " ".join(notes) if said else not notes


def test_without_frames_the_floor_tells_how_high_the_lidar_is(tmp_path) -> None:
    told = {"wheels": False, "inertial": False, "mounts": False}
    found, _ = ended(ros1(tmp_path / "way.bag", messages(WAY[:30], **told)))
    assert found.lidar_height == pytest.approx(0.4, abs=0.02)
    assert "the floor lies 0.40 m below 'lidar'" in found.stood.note


@pytest.mark.parametrize("pitch", [0.08, 0.5])
def test_a_lidar_that_leans_is_levelled_by_gravity_and_the_floor(pitch, tmp_path) -> None:
    """Its IMU leans with it; nothing tells the frames."""
    lean = Transform.from_rpy((0.0, 0.0, 0.0), (0.0, pitch, 0.0))
    back = lean.inverse()
    written: list[Message] = []
    for moment in WAY[:30]:
        for *_, told in moment.odometry:
            leant = ImuReading(
                told.stamp, "", told.times, back.apply(told.rates), back.apply(told.forces)
            )
            written += imu(leant)
        points = back.apply(moment.turn.points.astype(np.float64)).astype(np.float32)
        written.append(cloud(PointCloud(moment.stamp, "", points, moment.turn.times)))
    path = ros1(tmp_path / "way.bag", sorted_by_time(written))
    found = logged.surveyed(read_clouds(path), lambda done, loops: False)
    assert found is not None
    up = found.survey.base_from_lidar.rotation.T @ (0.0, 0.0, 1.0)
    assert up == pytest.approx(back.rotation @ (0.0, 0.0, 1.0), abs=0.01)
    assert found.lidar_height == pytest.approx(0.4, abs=0.03)
    if pitch < 0.1:
        said = re.search(r"tilted by ([0-9.]+) degrees", found.stood.note)
        assert said is not None
        assert float(said[1]) == pytest.approx(math.degrees(pitch), abs=0.2)


def test_where_no_floor_is_seen_it_is_told(tmp_path) -> None:
    written = []
    for moment in WAY[:3]:
        above = moment.turn.points[:, 2] > -0.1
        turn = PointCloud(moment.stamp, "", moment.turn.points[above], moment.turn.times[above])
        written.append(cloud(turn))
    found = logged.surveyed(read_clouds(ros1(tmp_path / "a.bag", written)), lambda *_: False)
    assert found is not None
    assert not found.stood.seen
    assert "no floor was found below 'lidar'" in found.stood.note


def test_an_imu_that_hangs_upside_down_is_told_and_turned(tmp_path) -> None:
    over = np.diag([1.0, -1.0, -1.0])
    written = []
    for moment in WAY[:10]:
        for *_, told in moment.odometry:
            turned = ImuReading(told.stamp, "", told.times, told.rates @ over, told.forces @ over)
            written += imu(turned)
        written.append(cloud(moment.turn))
    log = read_clouds(ros1(tmp_path / "way.bag", sorted_by_time(written)))
    assert any("taken to have up as its z" in note for note in log.notes)
    assert log.imu is not None
    felt = log.imu.base_from_imu.rotation @ log.imu.forces[0]
    assert felt == pytest.approx([0.0, 0.0, 9.81], abs=1e-6)


def test_forces_in_g_are_told_and_scaled(tmp_path) -> None:
    written = []
    for moment in SHORT:
        for *_, told in moment.odometry:
            written += imu(
                ImuReading(told.stamp, "", told.times, told.rates, told.forces / 9.80665)
            )
        written.append(cloud(moment.turn))
    log = read_clouds(ros1(tmp_path / "way.bag", [*MOUNTS, *sorted_by_time(written)]))
    assert any("in g" in note for note in log.notes)
    assert log.imu is not None
    assert np.linalg.norm(log.imu.forces, axis=1) == pytest.approx(9.81, rel=1e-3)


# what is wrong


def _without(names: str) -> list[Message]:
    """Clouds whose fields lack some names."""
    found = messages(SHORT)
    for topic, _, _, content in found:
        if topic == "/points":
            content["fields"] = [f for f in content["fields"] if f[1]["name"] not in names]
    return found


def _stamped(topic: str, *, jump: float | None = None) -> list[Message]:
    """Messages of a topic without stamps, or with a clock that is set back on the way."""
    found = messages(SHORT)
    mine = [content for name, _, _, content in found if name == topic]
    for number, content in enumerate(mine):
        head = content["header"][1]
        if jump is None:
            head["stamp"] = 0.0
        elif number >= len(mine) // 2:
            head["stamp"] -= jump
    return found


def _cut() -> list[Message]:
    found = messages(SHORT)
    for topic, _, _, content in found:
        if topic == "/points":
            content["data"] = content["data"][:1000]
    return found


def _later_imu() -> list[Message]:
    found = messages(SHORT)
    for topic, _, _, content in found:
        if topic == "/imu":
            content["header"][1]["stamp"] += 500.0
    return found


def _plane() -> list[Message]:
    flat = []
    for moment in SHORT:
        points = moment.turn.points * (1.0, 1.0, 0.0)
        flat.append(cloud(PointCloud(moment.stamp, "", points.astype("f4"), moment.turn.times)))
    return flat


def _whole_numbers() -> list[Message]:
    found = messages(SHORT)
    for topic, _, _, content in found:
        if topic == "/points":
            for _, told in content["fields"]:
                told["datatype"] = 5
    return found


@pytest.mark.parametrize(
    ("written", "said"),
    [
        (lambda: [*MOUNTS, *imu(SHORT[0].odometry[-1][2])], "no sensor_msgs/PointCloud2; it holds"),
        (lambda: _without("z"), "its points have no z, but x, y, intensity, ring, time"),
        (lambda: _without("xyz"), "no x and no y and no z"),
        (_whole_numbers, "whole numbers; expected float32 or float64"),
        (_cut, r"it says that it has 1 x \d+ points of 22 bytes, and holds 1000 bytes"),
        (lambda: _stamped("/imu"), r"/imu have no times: all are stamped 0 s.* --imu none"),
        (lambda: _stamped("/points"), "/points have no times: all are stamped 0 s"),
        (lambda: _stamped("/points", jump=50.0), "/points: the clock runs backwards"),
        (lambda: _stamped("/imu", jump=50.0), "/imu: the clock runs backwards"),
        (_later_imu, "the IMU and of the clouds do not overlap"),
        (_plane, "lie in one plane"),
        (
            lambda: [*messages(SHORT), *messages(SHORT, topic="/rear")],
            "clouds of several sensors: choose one by --cloud: /points, /rear",
        ),
    ],
)
def test_what_cannot_be_mapped_is_told(written, said, tmp_path) -> None:
    with pytest.raises(LogError, match=said):
        read_clouds(ros1(tmp_path / "way.bag", sorted_by_time(written())))


def test_topics_are_chosen_by_name(tmp_path) -> None:
    second = [each for *_, told in SHORT[0].odometry for each in imu(told, "/other")]
    both = [*messages(SHORT), *messages(SHORT[:2], topic="/rear", mounts=False), *second]
    path = ros1(tmp_path / "way.bag", sorted_by_time(both))
    assert read_clouds(path, "rear", "imu").count == 2
    assert read_clouds(path, "/points", "none").imu is None
    with pytest.raises(LogError, match="several IMUs: choose one by --imu: /imu, /other"):
        read_clouds(path, "rear")
    with pytest.raises(LogError, match=r"no clouds on '/front'; it has /points, /rear"):
        read_clouds(path, "/front")


def test_single_clouds_that_are_broken_are_left_out(tmp_path) -> None:
    found = messages(SHORT)
    last = [content for topic, _, _, content in found if topic == "/points"][2]
    last["data"] = last["data"][:500]
    log = read_clouds(ros1(tmp_path / "way.bag", found))
    assert len(list(log.turns())) == len(SHORT) - 1
    assert log.left_out.note.startswith("left out 1 cloud, the first because it says that it has")


@pytest.mark.parametrize(("write", "name"), [(ros1, "way.bag"), (ros2, "way"), (ros2_mcap, "way")])
def test_a_bag_that_was_cut_off_is_told(write, name, tmp_path) -> None:
    path = write(tmp_path / name, messages(SHORT))
    file = path if path.is_file() else next(p for p in path.iterdir() if p.suffix != ".yaml")
    data = file.read_bytes()
    file.write_bytes(data[: len(data) // 3])
    with pytest.raises(LogError, match="cannot be read"):
        list(read_clouds(path).turns())


# the verb


def test_the_verb_makes_a_map_in_three_dimensions_of_a_bag(tmp_path, capsys) -> None:
    path = ros2(tmp_path / "way", messages(WAY[:40]))
    for out in (tmp_path / "map", tmp_path / "again"):
        told = ["map", "--log", str(path), "-o", str(out), "--dimensions", "3"]
        assert main(told) == ExitCode.SUCCESS
    assert "points; " in capsys.readouterr().out
    names = {"map.yaml", "map.pgm", "map.png", "trajectory.tum", "report.json", "site.yaml"}
    names |= {"cloud.pcd", "overhang.yaml", "overhang.pgm"}
    assert {each.name for each in (tmp_path / "map").iterdir()} == names
    for each in (tmp_path / "map").iterdir():
        assert each.read_bytes() == (tmp_path / "again" / each.name).read_bytes()


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--dimensions", "3", "--scan", "/scan"], "--cloud chooses a lidar"),
        (["--dimensions", "3", "--extend", "."], "--extend goes on with a map in two dimensions"),
        (["--cloud", "/points"], "for maps in three dimensions: --dimensions 3"),
        (["--imu", "none"], "for maps in three dimensions: --dimensions 3"),
    ],
)
def test_options_that_do_not_fit_together_are_told(more, said, tmp_path, capsys) -> None:
    told = ["map", "--log", "way.bag", "-o", str(tmp_path / "map"), *more]
    assert main(told) == ExitCode.WRONG_INPUT
    assert said in capsys.readouterr().err


def test_a_lidar_that_stands_makes_no_map(tmp_path, capsys) -> None:
    path = ros1(tmp_path / "way.bag", messages(SHORT))
    out = tmp_path / "map"
    assert main(["map", "--log", str(path), "-o", str(out), "--dimensions", "3"]) == 2
    assert "the lidar must have moved" in capsys.readouterr().err
    assert not out.exists()


def test_other_logs_are_told_what_is_mapped(tmp_path) -> None:
    (tmp_path / "way.log").write_text("FLASER 1 2.0 0 0 0 0 0 0 1.0 host 1.0\n")
    with pytest.raises(LogError, match="only bags with sensor_msgs/PointCloud2 are mapped"):
        read_clouds(tmp_path / "way.log")
    flat = [scan(each) for each in scans_of(driven_flat(ROUND[:2], 0.5), 3)[:3]]
    with pytest.raises(LogError, match="leave out --dimensions 3 to map its scans in the plane"):
        read_clouds(ros1(tmp_path / "flat.bag", flat))
