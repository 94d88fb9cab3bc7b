"""Columns: what maps know is as tall as a wall, but for surfaces and what pictures see free."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from momantu_skills.manipulation.config import SceneConfig
from momantu_skills.manipulation.scene.columns import WALL, Columns
from momantu_skills.manipulation.scene.scene import Scene
from momantu_skills.manipulation.scene.surroundings import SeenSpace
from momantu_worlds.robots import fetch

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import CameraImage
from momantu_bt.world import Site, Surface
from tests.skills.scenery.flat import Box, write_map
from tests.skills.scenery.table import Tabletop

SPAN = (-1.0, -1.0, 3.0, 3.0)
WALLS: tuple[Box, ...] = ((2.0, -1.0, 2.15, 3.0), (-1.0, 2.0, 3.0, 2.15))
DESK: Box = (1.2, 1.0, 2.0, 2.0)
"""In the corner, against both walls."""
CHAIR: Box = (0.0, 0.5, 0.4, 0.9)


def site(folder: Path, *, desk: bool = True) -> Site:
    x0, y0, x1, y1 = DESK
    place = Pose2D((x0 + x1) / 2, (y0 + y1) / 2)
    surface = Surface(place, (x1 - x0, y1 - y0), 0.7, (0.0,))
    plan = write_map(folder, (*WALLS, DESK, CHAIR), SPAN)
    return Site("corner", map_file=plan, surfaces={"desk": surface} if desk else {})


def inside(points: np.ndarray, box: Box, margin: float = 0.0) -> np.ndarray:
    x0, y0, x1, y1 = box
    x, y = points[:, 0], points[:, 1]
    return (x > x0 - margin) & (x < x1 + margin) & (y > y0 - margin) & (y < y1 + margin)


def test_walls_and_furniture_are_columns_and_surfaces_are_not(tmp_path: Path) -> None:
    found = Columns(site(tmp_path)).near(1.0, 1.0, 3.0)
    assert not inside(found, DESK, -0.001).any()
    assert inside(found, CHAIR).sum() > 50
    beside_the_desk = [inside(found, (2.0, 1.0, 2.05, 2.0)), inside(found, (1.2, 2.0, 2.0, 2.05))]
    assert [int(each.sum()) for each in beside_the_desk] == [20, 16]
    assert inside(Columns(site(tmp_path, desk=False)).near(1.0, 1.0, 3.0), DESK, -0.001).any()


def test_only_what_is_near_counts_and_without_a_map_nothing(tmp_path: Path) -> None:
    columns = Columns(site(tmp_path))
    assert (np.linalg.norm(columns.near(0.2, 0.7, 0.5) - (0.2, 0.7), axis=1) < 0.5).all()
    assert not len(columns.near(-0.9, -0.9, 0.2))
    assert not len(Columns(Site("nowhere")).near(0.0, 0.0, 9.0))


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3.1, 3.1))
def test_as_obstacles_they_stand_where_the_map_has_them(
    tmp_path: Path, x: float, y: float, yaw: float
) -> None:
    columns = Columns(site(tmp_path))
    odom_from_map, map_from_base = Pose2D(x, y, yaw).transform(), Pose2D(1.2, 0.5, 2.0).transform()
    odom_from_base = odom_from_map @ map_from_base
    cells = columns.cells(odom_from_base, odom_from_map, SeenSpace(), 1.4, 0.04)
    assert cells is not None
    assert (cells.edge, cells.doubt) == (pytest.approx(0.05), 0.04)
    assert cells.centres / cells.edge % 1.0 == pytest.approx(0.5)
    there = (map_from_base @ cells.base_from_cells).apply(cells.centres)
    own = np.unique(np.round(there[:, :2], 6), axis=0)
    assert own == pytest.approx(np.unique(np.round(columns.near(1.2, 0.5, 1.4), 6), axis=0))
    assert there[:, 2].min() == pytest.approx(0.025)
    assert there[:, 2].max() == pytest.approx(WALL - 0.025)


def test_what_the_base_keeps_clear_of_reaches_as_far_as_the_map_draws_it(tmp_path: Path) -> None:
    scene = Scene(fetch(), SceneConfig())
    scene.columns, scene.odom_from_map = Columns(site(tmp_path)), Pose2D(2.0, 1.0, 0.3).transform()
    map_from_base = Pose2D(1.2, 0.5, 2.0).transform()
    here = replace(Tabletop().state(), odom_from_base=scene.odom_from_map @ map_from_base)
    found = scene.solids(here, np.empty((0, 2)), 1.4)
    there = map_from_base.apply(np.column_stack([found[:, :2], np.zeros(len(found))]))[:, :2]
    solid = found[:, 4] > 0.0
    assert there[solid] == pytest.approx(scene.columns.near(1.2, 0.5, 1.4))
    assert found[solid, 4] == pytest.approx(scene.columns.edge / 2)


def looks_over(depth: float) -> SeenSpace:
    """A camera 1.2 m above the floor at the map's origin that looks along x, over the chair."""
    k = np.array([[300.0, 0, 160], [0, 300.0, 120], [0, 0, 1]])
    image = CameraImage(
        0.0, "camera", np.zeros((240, 320, 3), np.uint8), np.full((240, 320), depth, np.float32), k
    )
    ahead = np.array([[0, 0, 1.0, 0], [-1.0, 0, 0, 0.7], [0, -1.0, 0, 1.2], [0, 0, 0, 1.0]])
    seen = SeenSpace()
    seen.add(image, Transform.from_matrix(ahead), 0.1)
    return seen


def test_what_a_picture_sees_free_is_no_obstacle(tmp_path: Path) -> None:
    columns = Columns(site(tmp_path))
    chair = columns.near(0.2, 0.7, 0.3)
    all_of_it, _ = columns.unseen(chair, SeenSpace(), Transform())
    left, _ = columns.unseen(chair, looks_over(2.0), Transform())
    assert len(left) < len(all_of_it)
    gone = {tuple(row) for row in np.round(all_of_it, 6)} - {tuple(r) for r in np.round(left, 6)}
    assert all(abs(z - 1.2) <= 0.4 * x + 0.01 for x, _, z in gone)
    nearer, _ = columns.unseen(chair, looks_over(0.15), Transform())
    behind = nearer[nearer[:, 0] > 0.16]
    assert len(behind) == (all_of_it[:, 0] > 0.16).sum(), "what hides behind something is not seen"


def test_views_from_far_away_are_forgotten() -> None:
    seen = looks_over(2.0)
    before = np.array([[1.0, 0.7, 1.2]])
    assert seen.free(before, 0.05, 0.03)
    image = CameraImage(
        1.0,
        "camera",
        np.zeros((240, 320, 3), np.uint8),
        np.full((240, 320), 1.0, np.float32),
        np.array([[300.0, 0, 160], [0, 300.0, 120], [0, 0, 1]]),
    )
    seen.add(image, Transform((9.0, 0.0, 1.2)), 0.1)
    assert not seen.free(before, 0.05, 0.03)


@pytest.mark.parametrize(
    ("way", "turns", "kept"),
    [(3.0, 0.5, True), (0.0, 3.0, True), (2.0, 6.0, False), (8.0, 0.0, False)],
)
def test_views_are_forgotten_when_odometry_has_drifted(
    way: float, turns: float, kept: bool
) -> None:
    """There and back: how far the base is from where the picture was taken says nothing."""
    seen = looks_over(2.0)
    point = np.array([[1.0, 0.7, 1.2]])
    assert seen.free(point, 0.04)[0]
    for share in np.concatenate([np.linspace(0, 0.5, 50), np.linspace(0.5, 0, 50)]):
        seen.moved(Transform.from_rpy((way * share, 0.0, 0.0), (0.0, 0.0, turns * share)))
    assert bool(seen.free(point, 0.04)[0]) is kept
