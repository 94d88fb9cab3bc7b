"""Turns become a map in three dimensions: registration, floor, pose graph, cloud and plans."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.mapping.three_d import finishing, graph, pcd, registration
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.floor import floor_plane
from momantu_skills.mapping.three_d.graph import Edge, Level
from momantu_skills.mapping.three_d.loops import closed
from momantu_skills.mapping.three_d.raster import cloud_of, overhang_of
from momantu_skills.mapping.three_d.registration import Surface, laid_on
from momantu_skills.mapping.three_d.surveying import CloudSurvey

from momantu_bt.formats.maps import OCCUPIED, UNKNOWN
from momantu_bt.geometry import Pose2D, Transform, quaternion_from_rpy
from momantu_bt.motion import Motion
from tests.skills.mapping.halls import MOUNT, RING, ROUND, driven, moments, turn_of, walls

CONFIG = CloudConfig()
BAND = (0.1, 0.6)


def seen_from(pose, boxes=RING, seed=0):
    """A turn of a base at rest, in base."""
    turn = turn_of(Motion.of([0.0], [pose]), 0.0, boxes, seed, 0.01)
    return MOUNT.apply(turn.points.astype(np.float64))


def surface(points):
    return Surface.of(points, CONFIG.voxel, CONFIG.neighbours)


def surveyed(poses, boxes, **told):
    """A survey of a drive, and where the base truly was at its end."""
    survey = CloudSurvey(Transform(), poses[0].transform())
    for moment in moments(poses, boxes, **told):
        for stamp, odometry, imu in moment.odometry:
            survey.move(stamp, odometry, imu)
        survey.add(moment.turn, MOUNT)
    return survey, moment.truth


@pytest.fixture(scope="module")
def around():
    """A way around a block, mapped."""
    survey, truth = surveyed(driven(ROUND), RING)
    return survey, finishing.built_of(survey, 0.05, BAND, 1.3, 0.3), truth


# registration


@pytest.mark.parametrize("off", [(0.15, -0.1, 0.02), (-0.2, 0.1, -0.05), (0.0, 0.25, 0.06)])
def test_a_room_is_laid_on_itself_from_a_near_guess(off):
    first, second = Transform((1.5, 1.5, 0.0)), Pose2D(2.0, 1.8, 0.3).transform()
    target = surface(seen_from(first))
    truth = first.inverse() @ second
    guess = truth @ Pose2D(*off).transform()
    found = laid_on(target, surface(seen_from(second, seed=1)), guess, 0.4)
    assert found is not None
    assert np.linalg.norm(found.pose.position - truth.position) < 0.02
    assert found.pose.angle_to(truth) < 0.005
    assert found.share > 0.8


def test_too_few_points_are_not_matched():
    few = surface(np.random.default_rng(0).uniform(-1, 1, (40, 3)))
    assert laid_on(few, few, Transform(), 0.5) is None


def test_another_room_is_no_loop():
    here = surface(seen_from(Transform((1.5, 1.5, 0.0))))
    other = walls(0, 0, 5, 4)
    there = surface(seen_from(Transform((2.0, 2.0, 0.0)), other))
    assert closed(here, there, Transform(), 0.5, CONFIG) is None
    same = surface(seen_from(Transform((1.7, 1.5, 0.0)), seed=2))
    pose = closed(here, same, Transform((0.4, 0.1, 0.0)), 0.5, CONFIG)
    assert pose is not None
    assert pose.position == pytest.approx([0.2, 0.0, 0.0], abs=0.02)


def test_a_missing_library_is_told_with_what_to_do(monkeypatch):
    class Missing:
        def __getattr__(self, name):
            raise ModuleNotFoundError("No module named 'small_gicp'")

    monkeypatch.setattr(registration, "small_gicp", Missing())
    with pytest.raises(registration.RegistrationMissingError, match=r"momantu-bt\[mapping3d\]"):
        registration.check_installed()


# the floor


def test_the_floor_is_found_at_its_height_and_tilt():
    tilted = Transform((0.0, 0.0, 0.0), quaternion_from_rpy(0.01, -0.02, 0.0))
    points = tilted.inverse().apply(seen_from(Transform((1.5, 1.5, 0.0))))
    plane = floor_plane(points + np.array([0.0, 0.0, 0.03]), CONFIG)
    assert plane is not None
    assert plane[:3] == pytest.approx(tilted.rotation.T[:, 2], abs=1.5e-3)
    assert -plane[3] == pytest.approx(0.03, abs=5e-3)


def test_no_floor_where_none_is_seen():
    points = seen_from(Transform((1.5, 1.5, 0.0)))
    assert floor_plane(points[points[:, 2] > 0.2], CONFIG) is None
    ahead = points[(points[:, 2] < 0.05) & (np.abs(points[:, 1]) < 0.05)]
    assert floor_plane(np.tile(ahead, (50, 1)), CONFIG) is None


# the pose graph


def drifting(steps=40):
    """A straight way whose steps climb: edges, first estimates and true poses."""
    true = [Transform((0.5 * i, 0.0, 0.0)) for i in range(steps)]
    step = Transform((0.5, 0.0, 0.003), quaternion_from_rpy(0.0, 0.001, 0.0))
    edges = [Edge(i, i + 1, step, graph.MATCHED) for i in range(steps - 1)]
    poses = [true[0]]
    for edge in edges:
        poses.append(poses[-1] @ edge.pose)
    return edges, poses, true


def test_the_floor_holds_what_drifts_up():
    edges, poses, true = drifting()
    assert abs(poses[-1].position[2]) > 0.2
    level = [Level(np.array([0.0, 0.0, 1.0, 0.0]), None)] * len(true)
    found = graph.optimise(poses, edges, [], level)
    assert max(abs(pose.position[2]) for pose in found) < 0.01
    assert found[-1].position[0] == pytest.approx(true[-1].position[0], abs=0.02)


def test_gravity_holds_the_tilt_where_no_floor_is_seen():
    edges, poses, true = drifting()
    level = [Level(None, np.array([0.0, 0.0, 1.0]))] * len(true)
    found = graph.optimise(poses, edges, [], level)
    tilts = [math.acos(min(1.0, pose.rotation[2, 2])) for pose in found]
    assert max(tilts) < 0.5 * math.acos(poses[-1].rotation[2, 2])


def test_a_floor_that_is_none_and_a_wrong_loop_lose_their_influence():
    edges, poses, true = drifting()
    level = [Level(np.array([0.0, 0.0, 1.0, 0.0]), None)] * len(true)
    level[20] = Level(np.array([0.0, 0.0, 1.0, -0.5]), None)
    wrong = Edge(0, 39, Transform((3.0, 2.0, 0.0)), graph.CLOSED)
    right = [Edge(i, 39 - i, Transform((0.5 * (39 - 2 * i), 0, 0)), graph.CLOSED) for i in (2, 5)]
    found = graph.optimise(poses, edges, [wrong, *right], level)
    assert abs(found[20].position[2]) < 0.02
    assert np.linalg.norm(found[39].position - true[39].position) < 0.05


def test_the_pose_above_a_floor_sees_it_so():
    pose = Transform((1.0, 2.0, 0.3), quaternion_from_rpy(0.03, -0.05, 0.8))
    normal = pose.rotation.T @ (0.0, 0.0, 1.0)
    found = graph.above_floor(np.append(normal, 0.3), pose)
    assert found.position == pytest.approx(pose.position)
    assert found.angle_to(pose) < 1e-6


# the whole way


def test_a_way_around_a_block_ends_where_it_truly_ends(around):
    survey, _, truth = around
    mapper = survey.mapper
    assert len(mapper.closed) >= 1
    assert mapper.doubtful == 0
    off = mapper.map_from_base.position - truth.position
    assert np.linalg.norm(off) < 0.003 * mapper.way
    assert abs(off[2]) < 0.01


def test_the_points_lie_on_the_surfaces(around):
    points = cloud_of(around[0].mapper)
    best = np.abs(points[:, 2])
    for box in np.array(RING):
        outside = np.maximum(np.maximum(box[:3] - points, points - box[3:]), 0.0)
        inside = np.minimum(points - box[:3], box[3:] - points).min(axis=1)
        best = np.minimum(
            best, np.maximum(np.linalg.norm(outside, axis=1), np.maximum(inside, 0.0))
        )
    assert len(points) > 10_000
    assert best.mean() < 0.02


def test_the_plan_has_the_walls_and_the_overhang_what_the_band_misses(around):
    built = around[1]
    cells, plan = built.plan.cells(), built.plan
    assert (cells == OCCUPIED).sum() > 300
    inside = np.floor((np.array([[1.5, 5.0], [7.0, 5.0]]) - plan.origin) / plan.resolution)
    free, block = (cells[int(row), int(column)] for column, row in inside)
    assert free not in (OCCUPIED, UNKNOWN)
    assert block == UNKNOWN
    assert built.spatial.overhang.levels.shape == plan.levels.shape
    assert built.report["points"] > 10_000


def test_a_table_top_overhangs_and_its_free_floor_does_not(around):
    plan = around[1].plan
    top = np.array([[1.5 + 0.02 * i, 5.0 + 0.02 * j, 0.75] for i in range(20) for j in range(20)])
    floor, ceiling = top - (0, 0, 0.75), top + np.array([2.0, 0, 1.5])
    cells = overhang_of(np.vstack([top, floor, ceiling]), plan, BAND, 1.3).cells()
    rows, columns = np.nonzero(cells == OCCUPIED)
    x = plan.origin[0] + (columns + 0.5) * plan.resolution
    assert 40 < len(rows) < 120
    assert x.min() > 1.4
    assert x.max() < 2.0


def test_the_same_turns_give_the_same_map_bit_for_bit():
    poses = driven([(1.5, 1.5), (4.0, 1.5)])
    first, second = (surveyed(poses, RING)[0] for _ in range(2))
    built = [finishing.built_of(each, 0.05, BAND, 1.3) for each in (first, second)]
    assert built[0].spatial.cloud == built[1].spatial.cloud
    assert built[0].poses == built[1].poses


def test_where_nothing_can_be_matched_wheels_and_gyroscopes_count():
    survey, truth = surveyed(driven([(1.5, 1.5), (4.0, 1.5)]), [(100, 100, 0, 101, 101, 1)])
    mapper = survey.mapper
    assert np.linalg.norm(mapper.map_from_base.position - truth.position) < 0.5


# PCD


def test_a_pcd_has_the_header_that_pcl_reads_and_its_points():
    points = np.array([[1.0, -2.5, 0.25], [0.0, 3.0, 1e-3]])
    header, _, data = pcd.pcd(points).partition(b"DATA binary\n")
    lines = header.decode("ascii").splitlines()
    assert lines == [
        "# .PCD v0.7 - Point Cloud Data file format",
        "VERSION 0.7",
        "FIELDS x y z",
        "SIZE 4 4 4",
        "TYPE F F F",
        "COUNT 1 1 1",
        "WIDTH 2",
        "HEIGHT 1",
        "VIEWPOINT 0 0 0 1 0 0 0",
        "POINTS 2",
    ]
    assert np.frombuffer(data, "<f4").reshape(-1, 3) == pytest.approx(points)
    assert len(data) == 24
