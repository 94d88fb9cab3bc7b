"""Files of poses, poses between samples, and the offset between two clocks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.poses import Poses, angles, rotations_of
from momantu_skills.calibration.trajectory.pairing import paired
from momantu_skills.calibration.trajectory.reading import TrajectoryError, read_trajectory
from momantu_skills.calibration.trajectory.time_offset import time_offset
from momantu_skills.calibration.trajectory.trajectory import Trajectory

from tests.skills.scenery.eyes import motion, rows, write

QUARTER = (0.7071067811865476, 0.0, 0.0, 0.7071067811865476)
"""A quarter turn about z, w first."""


def read(path: Path, text: str) -> Trajectory:
    path.write_text(text, encoding="utf-8")
    return read_trajectory(path)


@pytest.mark.parametrize(
    "text",
    [
        "1.5, 1, 2, 3, 0, 0, 0.70710678, 0.70710678\n",
        "# a comment\n\n1.5\t1\t2\t3\t0\t0\t0.70710678\t0.70710678\n",
        "#timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 0 0 0.70710678 0.70710678\n",
        "t,x,y,z,qw,qx,qy,qz\n1.5,1,2,3,0.70710678,0,0,0.70710678\n",
        "qw;qx;qy;qz;px;py;pz;Time [s]\n0.70710678;0;0;0.70710678;1;2;3;1.5\n",
        '"time","frame","pose.position.x","pose.position.y","pose.position.z",'
        '"pose.orientation.x","pose.orientation.y","pose.orientation.z","pose.orientation.w"\n'
        "1.5,base,1,2,3,0,0,0.70710678,0.70710678\n",
        "\ufeff1.5, 1, 2, 3, 0, 0, 0.708, 0.707\r\n",
        "t;x;y;z;qx;qy;qz;qw\n1,5;1,0;2;3;0;0;0,70710678;0,70710678\n",
        '"1.5","1","2","3","0","0","0.70710678","0.70710678",\n',
        "t,x,y,z,qx,qy,qz,qw,note\n1.5,1,2,3,0,0,0.70710678,0.70710678,\n",
    ],
    ids=[
        *("csv", "tabs", "tum", "w first", "other order", "ros", "not quite unit"),
        *("decimal commas", "quotes and a comma at the end", "an empty last column"),
    ],
)
def test_files_are_read(tmp_path: Path, text: str) -> None:
    found = read(tmp_path / "a.csv", text)
    assert found.times == pytest.approx([1.5])
    assert found.positions[0] == pytest.approx([1, 2, 3])
    assert found.quaternions[0] == pytest.approx(QUARTER, abs=1e-3)
    assert np.linalg.norm(found.quaternions[0]) == pytest.approx(1.0)


GOOD = "0, 0, 0, 0, 0, 0, 0, 1\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has no poses; expected rows t, x, y, z, qx, qy, qz, qw"),
        ("# nothing\n", "has no poses"),
        (GOOD + "1, 0, nan, 0, 0, 0, 0, 1\n", ":2:7: error: y is 'nan'; expected a finite number"),
        (GOOD + "1, 0, 0, 0, 0, 0, 0, one\n", ":2:22: error: qw is 'one'"),
        (GOOD + "1, 0, 0, 0, 30, 0, 90, 1\n", ":2:13: error: the quaternion has length 94.9"),
        ("1, 0, 0, 0, 0, 0, 1.57\n", ":1:1: error: the row has 7 columns; expected t, x, y, z"),
        ("time,x,y,z,roll,pitch,yaw,w\n" + GOOD, "the header does not name the columns"),
        ("1, 0, 0, 0, 0, 0, 0, 1\n" + GOOD, ":2:1: error: t goes back by 1 s, from 1 in line 1"),
        (GOOD + "0, 1, 0, 0, 0, 0, 0, 1\n", ":2:1: error: another pose at the same time as in"),
        (GOOD + "1, 0, , 0, 0, 0, 0, 1\n", ":2:7: error: y is ''; expected a finite number"),
        ("0, 0, 0, 0, 0, 0, 0, 1, 9\n", "the row has 9 columns; expected t, x, y, z"),
        ("t,x,y,z,roll,pitch,yaw\n" + GOOD, "angles are not read; write quaternions"),
    ],
    ids=[
        *("empty", "comments", "nan", "word", "degrees", "columns", "header", "back", "two frames"),
        *("empty column", "more columns", "names of angles"),
    ],
)
def test_wrong_files_are_refused_with_the_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(TrajectoryError) as error:
        read(tmp_path / "a.csv", text)
    assert message in str(error.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(TrajectoryError, match=r"no\.csv cannot be read: No such file"):
        read_trajectory(tmp_path / "no.csv")
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe1")
    with pytest.raises(TrajectoryError, match="not UTF-8"):
        read_trajectory(tmp_path / "a.csv")


def test_the_same_sample_twice_is_one(tmp_path: Path) -> None:
    found = read(tmp_path / "a.csv", GOOD + GOOD + "1, 0, 0, 0, 0, 0, 0, 1\n")
    assert list(found.lines) == [1, 3]


def trajectory(name: str, times: np.ndarray, poses: Poses, tmp_path: Path) -> Trajectory:
    return read_trajectory(write(tmp_path / name, rows(times, poses)))


def test_between_samples_a_pose_moves_and_turns_evenly(tmp_path: Path) -> None:
    turns = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3.0]])
    poses = Poses(rotations_of(turns), np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 0.0]]))
    record = trajectory("a.csv", np.array([10.0, 10.4]), poses, tmp_path)
    found, known = record.at(np.array([9.9, 10.0, 10.1, 10.4, 10.5]), 0.5)
    assert list(known) == [False, True, True, True, False]
    assert found.positions[2] == pytest.approx([0.25, 0.5, 0.0])
    assert angles(found.rotations[2]) == pytest.approx(0.75, abs=1e-6)
    found, known = record.at(np.array([10.0, 10.1, 10.4]), 0.3)
    assert list(known) == [True, False, True]
    assert found.positions[2] == pytest.approx([1.0, 2.0, 0.0])


def test_a_single_sample_is_known_at_its_time(tmp_path: Path) -> None:
    record = trajectory("a.csv", np.array([3.0]), motion(np.array([3.0]), 0), tmp_path)
    _, known = record.at(np.array([2.0, 3.0, 4.0]), 0.5)
    assert list(known) == [False, True, False]
    assert record.step == 0.0


@pytest.mark.parametrize("offset", [0.137, -2.5, 1e6])
def test_the_offset_between_clocks_is_found(tmp_path: Path, offset: float) -> None:
    fast, slow = np.arange(0.0, 20.0, 0.02), np.arange(3.0, 16.0, 0.066)
    hand = trajectory("a.csv", fast, motion(fast, 1), tmp_path)
    turned = motion(slow, 1).rotations @ rotations_of(np.array([1.0, 2.0, 0.5]))
    other = Poses(turned, np.zeros((len(slow), 3)))
    camera = trajectory("b.csv", slow - offset, other, tmp_path)
    assert time_offset(hand, camera) == pytest.approx(offset, abs=0.01)


def test_motions_of_two_recordings_do_not_correlate(tmp_path: Path) -> None:
    times = np.arange(0.0, 60.0, 0.05)
    hand = trajectory("a.csv", times, motion(times, 1), tmp_path)
    camera = trajectory("b.csv", times, motion(times, 2), tmp_path)
    with pytest.raises(CalibrationError, match=r"do not correlate \(at best 0\.[0-4]"):
        time_offset(hand, camera)


def test_the_offset_needs_motions(tmp_path: Path) -> None:
    times = np.arange(0.0, 60.0, 2.0)
    hand = trajectory("a.csv", times, motion(times, 1), tmp_path)
    with pytest.raises(CalibrationError, match="a pose every 2 s; --align-time needs motions"):
        time_offset(hand, hand)


@pytest.mark.parametrize("stamps", [100.0, 1.6e9])
def test_records_without_common_time(tmp_path: Path, stamps: float) -> None:
    times = np.arange(1.0, 3.0, 0.1)
    hand = trajectory("a.csv", times, motion(times, 1), tmp_path)
    camera = trajectory("b.csv", times + stamps, motion(times, 1), tmp_path)
    with pytest.raises(CalibrationError, match="no overlap in time: .*--align-time finds"):
        paired(hand, camera, 0.0, 0.5)


def test_stamps_in_nanoseconds_are_named(tmp_path: Path) -> None:
    times = 1.6e9 + np.arange(1.0, 3.0, 0.1)
    hand = trajectory("a.csv", times * 1e9, motion(times, 1), tmp_path)
    camera = trajectory("b.csv", times, motion(times, 1), tmp_path)
    for first, second in ((hand, camera), (camera, hand)):
        with pytest.raises(CalibrationError, match=r"Stamps of .*a\.csv look like nanoseconds"):
            paired(first, second, 0.0, 0.5)


def test_a_hand_that_is_recorded_too_rarely(tmp_path: Path) -> None:
    times = np.arange(0.0, 30.0, 3.0)
    hand = trajectory("a.csv", times, motion(times, 1), tmp_path)
    camera = trajectory("b.csv", times + 1.0, motion(times, 1), tmp_path)
    with pytest.raises(CalibrationError, match=r"come every 3 s\); --gap sets that time"):
        paired(hand, camera, 0.0, 0.5)
    assert len(paired(hand, camera, 0.0, 3.5)[0]) == 9
