"""Names that were taught move with the map when a loop is closed afterwards."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from momantu_skills.mapping import pose_graph
from momantu_skills.mapping.anchors import Anchors
from momantu_skills.mapping.loops import Loop
from momantu_skills.mapping.pose_graph import Match
from momantu_skills.mapping.survey import Survey
from momantu_skills.navigation.matching.config import MatchingConfig

from momantu_bt.geometry import Pose2D
from momantu_bt.testing import scripted_site
from momantu_bt.world import Surface
from tests.skills.mapping.walls import ROUND, driven, logged

TABLE = Surface(Pose2D(0.0, 0.0), (1.0, 0.5), 0.7, (0.0,))
BESIDE = Pose2D(0.8, -0.6, 0.5)
"""base_from_surface where it is taught."""


@pytest.fixture
def site():
    return scripted_site().of_a_run().uncharted()


def off(found: Pose2D, true: Pose2D) -> tuple[float, float]:
    turn = math.remainder(found.yaw - true.yaw, math.tau)
    return found.distance_to(true), abs(turn)


@pytest.mark.parametrize("seed", [1, 2])
def test_the_saved_names_lie_where_the_saved_scans_do(site, seed):
    way = driven(ROUND, 0.5)
    survey, anchors = Survey(way[0]), Anchors(site)
    far = max(range(len(way)), key=lambda n: way[n].distance_to(way[0]))
    said: Pose2D | None = None
    for number, scan in enumerate(logged(way, seed)):
        anchors.note(survey.mapper.poses)
        revision = survey.mapper.revision
        survey.add(scan)
        if survey.mapper.revision != revision:
            anchors.move(survey.mapper.poses)
        if number == far:
            said = survey.mapper.poses[-1]
            site.places.teach("far", said)
            site.surfaces.teach("table", replace(TABLE, map_from_surface=said @ BESIDE))
    assert said is not None
    ended = survey.finished().mapper
    assert ended.loops
    anchors.note(survey.mapper.poses)
    names = anchors.names(ended.poses)
    place, table = Pose2D(*names.places["far"]), Pose2D(*names.surfaces["table"].centre)
    assert off(place, way[far])[0] < max(0.02, off(said, way[far])[0])
    assert off(table, place @ BESIDE) < (1e-9, 1e-9)
    assert names.start == pytest.approx((way[0].x, way[0].y, way[0].yaw), abs=0.01)


def test_a_bent_way_that_a_loop_closes_moves_the_name(site):
    true, bent = [Pose2D(0.0, 0.0)], [Pose2D(0.0, 0.0)]
    for _ in range(39):
        true.append(true[-1] @ Pose2D(1.0, 0.0, math.tau / 40))
        bent.append(bent[-1] @ Pose2D(1.0, 0.0, math.tau / 40 + 0.01))
    anchors = Anchors(site)
    anchors.note(bent[:30])
    site.places.teach("half_way", bent[29])
    anchors.note(bent[:30])
    motions = [a.inverse() @ b for a, b in itertools.pairwise(bent)]
    matches = [
        Match(k, n, bent[k].inverse() @ bent[n], np.diag([0.02**2, 0.02**2, 0.01**2]))
        for k in range(40)
        for n in (k, k + 1)
        if n < 40
    ]
    loops = [Loop(k, 39 - j, true[k].inverse() @ true[39 - j]) for k in (0, 1) for j in (0, 1)]
    closed, _ = pose_graph.optimise(bent, bent, motions, matches, loops, MatchingConfig())
    assert off(site.places["half_way"], true[29])[0] > 1.0
    anchors.move(closed)
    assert off(site.places["half_way"], closed[29]) < (1e-9, 1e-9)
    assert off(site.places["half_way"], true[29])[0] < 0.6


def test_the_run_is_told_where_its_names_are_now(site):
    anchors = Anchors(site)
    poses = [Pose2D(0.0, 0.0), Pose2D(1.0, 0.0), Pose2D(2.0, 0.0)]
    anchors.note(poses[:2])
    site.places.teach("here", Pose2D(1.2, 0.1, 0.3))
    site.surfaces.teach("table", replace(TABLE, map_from_surface=Pose2D(1.0, 1.0)))
    anchors.note(poses[:2])
    anchors.note(poses)
    bent = [poses[0], Pose2D(1.0, 0.5, math.pi / 2), Pose2D(1.0, 1.5, math.pi / 2)]
    anchors.move(bent)
    assert off(site.places["here"], Pose2D(0.9, 0.7, math.pi / 2 + 0.3)) < (1e-9, 1e-9)
    assert off(site.surfaces["table"].map_from_surface, Pose2D(0.0, 0.5, math.pi / 2)) < (
        1e-9,
        1e-9,
    )
    anchors.move(poses)
    assert off(site.places["here"], Pose2D(1.2, 0.1, 0.3)) < (1e-9, 1e-9)


def test_a_name_that_is_taught_anew_lies_there(site):
    anchors = Anchors(site)
    poses = [Pose2D(0.0, 0.0), Pose2D(1.0, 0.0)]
    site.places.teach("here", Pose2D(0.5, 0.0))
    anchors.note([])
    anchors.note(poses[:1])
    site.places.teach("here", Pose2D(1.0, 0.0))
    anchors.note(poses)
    anchors.move([poses[0], Pose2D(1.0, 3.0)])
    assert site.places["here"] == Pose2D(1.0, 3.0)


def test_what_the_site_told_does_not_move():
    site = scripted_site()
    told = replace(site, places={"door": Pose2D(3.0, 0.0)}).of_a_run()
    anchors = Anchors(told)
    anchors.note([Pose2D(0.0, 0.0)])
    anchors.move([Pose2D(0.0, 2.0)])
    assert told.places["door"] == Pose2D(3.0, 0.0)


def test_names_that_were_read_are_held_by_the_nearest_scan(site):
    site.places.teach("door", Pose2D(4.0, 1.0))
    anchors = Anchors(site)
    anchors.hold_all([Pose2D(0.0, 0.0), Pose2D(4.0, 0.0), Pose2D(9.0, 0.0)])
    anchors.move([Pose2D(0.0, 0.0), Pose2D(4.0, 0.5), Pose2D(9.0, 3.0)])
    assert site.places["door"] == Pose2D(4.0, 1.5)
