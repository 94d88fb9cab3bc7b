"""The table where the item goes: occupied spots, a covered tag, a tag of another number."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.faults.box_row import FINGERS
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tag import marker_picture
from momantu_worlds.sapien.faults.tops import table_top, things_on
from momantu_worlds.sapien.sensors.camera import Camera
from momantu_worlds.scenes.arrange.spots import SetDown, free_spots
from momantu_worlds.scenes.catalogue.tags import tag_cells
from momantu_worlds.scenes.geometry.support import UprightCylinder

from momantu_bt.geometry import Pose2D
from momantu_bt.robot import read_camera

SEEDS = (0, 3, 6)


def spots(stage: Stage) -> list[tuple[float, float]]:
    """Free spots by the rule of how episodes are drawn, those on the marker left out."""
    top, item = table_top(stage, stage.goal.support), UprightCylinder(stage.item)
    marker = top.map_from_top.inverse() @ stage.simulator.truth.pose(stage.goal.marker)
    wanted = SetDown(item.radius, item.height, stage.goal.max_distance, top.side)
    found = free_spots(wanted, top.placed, things_on(stage, top), Pose2D.from_transform(marker))
    half = np.array(marker_picture(stage).size) / 2 + item.radius
    own = [marker.inverse().apply((x, y, 0.0)) for x, y in found]
    return [s for s, o in zip(found, own, strict=True) if np.any(np.abs(o[:2]) > half)]


@pytest.mark.parametrize("seed", SEEDS)
def test_boxes_leave_no_spot_beside_the_marker(blind, happening, step, seed):
    stage = blind(seed)
    assert spots(stage)
    with happening(stage, "place.occupied", free=0):
        step(stage, 10)
        assert spots(stage) == []


@pytest.mark.parametrize("free", [1, 2])
@pytest.mark.parametrize("seed", SEEDS)
def test_boxes_leave_as_many_spots_as_wanted(blind, happening, seed, free):
    stage = blind(seed)
    with happening(stage, "place.occupied", free=free):
        left = spots(stage)
        assert len(left) >= free
        # what is left lies together: about the spots that were kept
        groups: list[tuple[float, float]] = []
        for spot in left:
            if all(math.dist(spot, other) > 0.2 for other in groups):
                groups.append(spot)
        assert len(groups) <= 2 * free


def test_boxes_are_things_that_the_referee_watches(blind, happening, step):
    stage = blind(3)
    with happening(stage, "place.occupied", free=1):
        box = stage.simulator.added[0]
        pose = box.map_from_body
        stage.simulator.put(box.name, pose @ type(pose)((0.0, 0.0, 0.3)))
        step(stage, 1)
        assert any("occupying_box was moved" in s for s in stage.referee.verdict().unmet)
    assert FINGERS > 0.0


@pytest.fixture(scope="module")
def looking(seeing, stand_before) -> Stage:
    """The robot looks at the tag."""
    stand_before(seeing, "table_b", "tag")
    return seeing


def cells(stage: Stage) -> np.ndarray:
    """Brightness (8, 8) of the marker's cells in a picture of now."""
    stage.simulator.step()
    image = read_camera(stage.simulator.robot)
    camera = stage.simulator.robot.sensors[fetch().camera()[0]]
    assert isinstance(camera, Camera)
    link = stage.simulator.truth.link(image.frame) @ camera.link_from_camera
    marker = stage.simulator.truth.pose(stage.goal.marker)
    edge, count = marker_picture(stage).size[0], tag_cells(0).shape[0]
    at = (np.arange(count) + 0.5) / count * edge - edge / 2
    grid = [[(x, -y, 0.0) for x in at] for y in at]
    rays = link.inverse().apply(marker.apply(np.array(grid))) @ image.intrinsics.T
    pixels = np.round(rays[..., :2] / rays[..., 2:]).astype(int)
    return image.color[pixels[..., 1], pixels[..., 0]].mean(axis=-1)


def reads_as(stage: Stage, tag_id: int) -> bool:
    brightness = cells(stage)
    light = brightness > brightness.mean()
    return bool(np.array_equal(light, tag_cells(tag_id)))


def test_the_tag_reads_as_another_number_while_it_lasts(looking, happening):
    assert reads_as(looking, 1)
    with happening(looking, "tag.wrong_id", id=7):
        assert reads_as(looking, 7)
        assert not reads_as(looking, 1)
    assert reads_as(looking, 1)


def test_a_covered_tag_is_dark_all_over_until_it_is_uncovered(looking, happening):
    with happening(looking, "tag.covered"):
        assert np.ptp(cells(looking)) < 40
        assert not reads_as(looking, 1)
    assert reads_as(looking, 1)


def test_boxes_leave_the_tag_in_sight(looking, happening):
    with happening(looking, "place.occupied", free=1):
        assert reads_as(looking, 1)
