"""Logs of CARMEN: each message is read, and each thing that is wrong has its sentence."""

from __future__ import annotations

import gzip
import math

import numpy as np
import pytest
from momantu_skills.mapping.logs.carmen import read_carmen
from momantu_skills.mapping.logs.log import LogError

from momantu_bt.geometry import Pose2D


def flaser(stamp, x=0.0, beams=5, laser=None, ranges=None):
    values = ranges or [2.0 + 0.1 * k for k in range(beams)]
    at = laser or (x, 0, 0)
    words = ["FLASER", len(values), *values, *at, x, 0, 0, stamp, "host", stamp]
    return " ".join(map(str, words))


def robotlaser(stamp, x=0.0, start=-1.0, step=0.5, ranges=(1.0, 2.0, 3.0, 4.0, 9.9)):
    head = ["ROBOTLASER1", 0, start, 2.0, step, 9.9, 0.01, 0, len(ranges), *ranges, 0]
    return " ".join(map(str, [*head, x + 0.3, 0, 0.1, x, 0, 0, 0, 0, 0, 0, 0, stamp, "h", stamp]))


def rawlaser(stamp):
    head = ["RAWLASER1", 0, -1.0, 2.0, 0.5, 9.9, 0.01, 0, 5, 1, 2, 3, 4, 5, 2, 7, 8]
    return " ".join(map(str, [*head, stamp, "h", stamp]))


def odom(stamp, x, yaw=0.0):
    return f"ODOM {x} 0 {yaw} 0 0 0 {stamp} host {stamp}"


@pytest.fixture
def log(tmp_path):
    def make(*lines):
        path = tmp_path / "log.txt"
        path.write_text("# comment\nPARAM robot_length 1\n" + "\n".join(lines) + "\n")
        return path

    return make


def test_flaser_has_its_odometry_and_half_a_turn_of_beams(log):
    read = read_carmen(log(flaser(1.0), flaser(2.0, 0.5)))
    first, second = read.scans
    assert (first.stamp, second.stamp) == (1.0, 2.0)
    assert second.odom_from_base == Pose2D(0.5, 0.0)
    assert first.rays.directions[0] == pytest.approx([0.0, -1.0], abs=1e-12)
    assert first.rays.directions[-1] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert not read.notes


@pytest.mark.parametrize(("beams", "last"), [(180, 89.0), (181, 90.0), (360, 89.5), (361, 90.0)])
def test_the_last_beam_is_where_the_sick_has_it(log, beams, last):
    rays = read_carmen(log(flaser(1.0, beams=beams))).scans[0].rays
    assert math.degrees(math.atan2(*rays.directions[-1][::-1])) == pytest.approx(last)


def test_robotlaser_has_angles_mount_and_greatest_range(log):
    rays = read_carmen(log(robotlaser(1.0), robotlaser(2.0, 0.5))).scans[1].rays
    assert rays.origin == pytest.approx([0.3, 0.0])
    assert math.atan2(*rays.directions[0][::-1]) == pytest.approx(-1.0 + 0.1)
    assert list(rays.hit) == [True] * 4 + [False]


def test_rawlaser_takes_odometry_between_two_lines(log):
    read = read_carmen(log(odom(1.0, 0.0), rawlaser(1.5), odom(2.0, 1.0)))
    assert read.scans[0].odom_from_base.x == pytest.approx(0.5)
    with pytest.raises(LogError, match="without odometry"):
        read_carmen(log(rawlaser(1.5)))


def test_a_corrected_log_does_not_tell_the_mount(log):
    lines = [flaser(float(k), 0.1 * k, laser=(0.1 * k + 0.05 * k, 0.2 * k, 0)) for k in range(9)]
    assert read_carmen(log(*lines)).scans[3].rays.origin == pytest.approx([0.0, 0.0])


def test_a_packed_log_is_read(tmp_path):
    path = tmp_path / "log.gz"
    path.write_bytes(gzip.compress((flaser(1.0) + "\n").encode()))
    assert len(read_carmen(path).scans) == 1
    path.write_bytes(gzip.compress((flaser(1.0) + "\n").encode())[:-12])
    with pytest.raises(LogError, match="cannot be read"):
        read_carmen(path)


def test_the_greatest_range_means_nothing_if_it_is_frequent(log):
    far = [81.9, 2.0, 2.1, 2.2, 81.8]
    hit = read_carmen(log(flaser(1.0, ranges=far), flaser(2.0, ranges=far))).scans[0].rays.hit
    assert list(hit) == [False, True, True, True, False]


def test_ranges_that_are_no_numbers_or_too_near_are_no_hits(log):
    hit = read_carmen(log(flaser(1.0, ranges=["nan", 0.0, 2.0, "inf", 3.0]))).scans[0].rays.hit
    assert list(hit) == [False, False, True, False, False]
    assert np.isfinite(
        read_carmen(log(flaser(1.0, ranges=["nan", 1.0]))).scans[0].rays.ranges
    ).all()


def test_a_log_that_is_cut_off_is_read_up_to_there(log):
    whole = [flaser(float(k), 0.1 * k) for k in range(60)]
    read = read_carmen(log(*whole, flaser(60.0)[:17]))
    assert len(read.scans) == 60
    assert read.notes == (
        "left out 1 broken line, the first is line 63: the line ends within the ranges",
    )


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ([], "holds no scans of CARMEN; expected lines that begin with FLASER"),
        ([odom(1.0, 0.0)], "holds no scans of CARMEN"),
        (["FLASER x 1 2"], "line 3: 'x' is not a number of ranges"),
        (["FLASER 5 1 2"], "line 3: the line ends within the ranges"),
        (["FLASER 1 2.0 nan 0 0 nan 0 0 1 h 1"], "the laser's pose is nan 0 0, expected finite"),
        (["FLASER 1 abc 0 0 0 0 0 0 1 h 1"], "'abc' in the ranges is not a number"),
        ([flaser(1.0), "FLASER 1", "FLASER 1", "FLASER 1"], ":4:1: error: the line ends within"),
        ([flaser(50.0), flaser(1.0)], ":4:1: error: the clock runs backwards, from 50.0 to 1.0 s"),
        (
            [flaser(50.0 - k) for k in range(9)],
            ":6:1: error: the clock runs backwards, from 50.0 to 47.0 s",
        ),
        (["FLASER 1 2.0 0 0 0 1e300 0 0 1 h 1"], "the odometry is 1e300 0 0, expected finite"),
        (["FLASER 1 2.0 0 0 0 0 0 0 nan h 1"], "the stamp is nan, expected seconds"),
        (
            [flaser(float(k), beams=5 + k) for k in range(4)],
            "the scans have 5 to 8 beams, and no number is that of most of them",
        ),
    ],
)
def test_what_is_wrong_is_said(log, lines, says):
    with pytest.raises(LogError) as error:
        read_carmen(log(*lines))
    assert says in str(error.value)


def test_an_empty_or_missing_file_is_said(tmp_path):
    (tmp_path / "empty.log").touch()
    with pytest.raises(LogError, match="is empty"):
        read_carmen(tmp_path / "empty.log")
    with pytest.raises(LogError, match="cannot be read: No such file"):
        read_carmen(tmp_path / "none.log")
    with pytest.raises(LogError, match="cannot be read: Is a directory"):
        read_carmen(tmp_path)


def test_stamps_that_jitter_are_told(log):
    read = read_carmen(log(flaser(5.0), flaser(4.6, 0.1), flaser(6.0, 0.2)))
    assert len(read.scans) == 3
    assert read.notes == ("1 scan has an earlier stamp than the one before",)


def test_scans_with_another_number_of_beams_are_told(log):
    read = read_carmen(log(flaser(1.0), flaser(2.0), flaser(3.0, beams=4)))
    assert len(read.scans) == 2
    assert read.notes == ("left out 1 scan that has not 5 beams as the others",)
