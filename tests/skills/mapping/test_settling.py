"""A map whose first scan disagrees with the rest is moved to where that scan was told to be."""

from __future__ import annotations

import math

import pytest
from momantu_skills.mapping.config import MappingConfig
from momantu_skills.mapping.settling import settled
from momantu_skills.mapping.survey import Survey

from momantu_bt.geometry import Pose2D
from tests.skills.mapping.walls import ROUND, driven, logged

MATCHING = MappingConfig().matching


@pytest.fixture(scope="module")
def way():
    return driven(ROUND, 0.5)


@pytest.fixture(scope="module")
def scans(way):
    return logged(way, 2)


@pytest.mark.parametrize("turn", [-0.02, 0.01, 0.03])
def test_a_map_that_is_turned_against_its_first_scan_is_turned_back(way, scans, turn):
    start = Pose2D(3.0, -2.0, 0.7)
    map_from_way = start @ way[0].inverse()
    right = [map_from_way @ pose for pose in way]
    wrong = [start @ Pose2D(0.0, 0.0, turn) @ start.inverse() @ pose for pose in right]
    change = settled([start, *wrong[1:]], scans, start, MATCHING)
    assert change.yaw == pytest.approx(-turn, abs=0.003)
    for before, true in zip(wrong[1::40], right[1::40], strict=True):
        assert (change @ before).distance_to(true) < 0.03


def test_a_map_that_is_right_stays(way, scans):
    change = settled(way, scans, way[0], MATCHING)
    assert abs(change.yaw) < 0.002
    assert (change @ way[-1]).distance_to(way[-1]) < 0.02


def test_a_map_of_which_nothing_is_seen_again_stays(way, scans):
    few = 8
    assert settled(way[:few], scans[:few], way[0], MATCHING) == Pose2D(0.0, 0.0)
    far = [Pose2D(pose.x + 30.0, pose.y) for pose in way[1:]]
    assert settled([way[0], *far], scans, way[0], MATCHING) == Pose2D(0.0, 0.0)


def test_a_finished_survey_lies_where_its_start_was_told(scans):
    start = Pose2D(1.0, 2.0, math.pi / 3)
    survey = Survey(start)
    for scan in scans:
        survey.add(scan)
    poses = survey.finished().mapper.poses
    assert poses[0].distance_to(start) < 0.03
    assert settled(poses, survey.used, start, MATCHING).yaw == pytest.approx(0.0, abs=0.002)
