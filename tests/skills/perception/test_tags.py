"""Tags: pictures without a tag give none, and several sightings are surer than one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from momantu_skills.perception.tags.detector import find_tags
from momantu_skills.perception.tags.single import TagSighting, average, locate

from momantu_bt.geometry import Transform, quaternion_from_rpy
from momantu_bt.messages import CameraImage
from momantu_bt.tags import UNIT_CORNERS

K = np.array([[554.0, 0.0, 319.5], [0.0, 554.0, 239.5], [0.0, 0.0, 1.0]])
EDGE = 0.15
COV = np.eye(6)
angle = st.floats(-0.9, 0.9)


def picture_of(pose: Transform, noise: float = 0.0) -> tuple[CameraImage, np.ndarray]:
    """A tag's plane filling the view in depth, and where the tag's corners lie in it, px."""
    columns, rows = np.meshgrid(np.arange(640), np.arange(480))
    rays = np.stack([(columns - K[0, 2]) / K[0, 0], (rows - K[1, 2]) / K[1, 1], 0 * rows + 1.0], 2)
    normal = pose.rotation[:, 2]
    depth = (normal @ pose.position) / (rays @ normal)
    depth = depth + noise * depth**2 * np.random.default_rng(0).standard_normal(depth.shape)
    depth = np.where((depth > 0.3) & (depth < 4.0), depth, 0.0)
    corners = pose.apply(np.column_stack([UNIT_CORNERS * EDGE, np.zeros(4)]))
    pixels = corners[:, :2] / corners[:, 2:] * 554.0 + K[:2, 2]
    color = np.zeros((480, 640, 3), dtype=np.uint8)
    return CameraImage(0.0, "camera", color, depth.astype(np.float32), K), pixels


@given(angle, angle, st.floats(-3.0, 3.0), st.floats(0.6, 2.0))
def test_corners_and_depth_give_the_pose(
    pitch: float, roll: float, yaw: float, distance: float
) -> None:
    away = quaternion_from_rpy(np.pi + pitch, roll, yaw)
    pose = Transform((0.1 * distance, -0.05 * distance, distance), away)
    image, corners = picture_of(pose)
    seen = locate(image, 1, corners, EDGE)
    assert seen is not None
    assert seen.camera_from_tag.position == pytest.approx(pose.position, abs=1e-4)
    assert seen.camera_from_tag.angle_to(pose) < 1e-3
    assert seen.misfit < 1e-4


def test_noise_in_depth_averages_out() -> None:
    pose = Transform((0.0, 0.1, 1.2), quaternion_from_rpy(np.pi + 0.9, 0.0, 0.3))
    image, corners = picture_of(pose, noise=0.0015)
    seen = locate(image, 1, corners, EDGE)
    assert seen is not None
    assert np.linalg.norm(seen.camera_from_tag.position - pose.position) < 0.001
    assert seen.camera_from_tag.angle_to(pose) < 0.02


def test_another_size_or_missing_depth_is_no_sighting() -> None:
    image, corners = picture_of(Transform((0.0, 0.0, 1.0), quaternion_from_rpy(np.pi, 0.0, 0.0)))
    assert locate(image, 1, corners, 1.3 * EDGE) is None
    dark = CameraImage(0.0, "camera", image.color, np.zeros_like(image.depth), K)
    assert locate(dark, 1, corners, EDGE) is None


def test_pictures_without_tags_have_none() -> None:
    random = np.random.default_rng(3)
    color = random.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    depth = np.ones((480, 640), dtype=np.float32)
    assert find_tags([CameraImage(0.0, "camera", color, depth, K)]) == {}


def test_noise_in_the_dark_is_no_tag_however_it_is_lifted() -> None:
    random = np.random.default_rng(4)
    for sigma in (3.0, 8.0, 15.0):
        grays = np.clip(20 + sigma * random.standard_normal((8, 480, 640, 3)), 0, 255)
        depth = np.ones((480, 640), dtype=np.float32)
        images = [CameraImage(0.0, "camera", gray.astype(np.uint8), depth, K) for gray in grays]
        assert find_tags(images[:1]) == {}
        assert find_tags(images) == {}


def test_the_average_leans_on_the_surer_and_is_surer_itself() -> None:
    sightings = [
        TagSighting(Transform((0.001 * n, 0.0, 0.0)), 0.002, float(n), COV) for n in range(4)
    ]
    together = average(sightings)
    assert together.odom_from_tag.position[0] == pytest.approx(0.0015)
    assert together.sigma < 0.002
    assert together.stamp == 3.0
    sure = average([TagSighting(Transform((1.0, 0.0, 0.0)), 0.0005, 0.0, COV), sightings[0]])
    assert sure.odom_from_tag.position[0] > 0.9


def test_turns_are_averaged_whatever_their_sign() -> None:
    turn = quaternion_from_rpy(0.0, 0.0, 3.1)
    there = TagSighting(Transform((0.0, 0.0, 0.0), turn), 0.001, 0.0, COV)
    back = TagSighting(Transform((0.0, 0.0, 0.0), -turn), 0.001, 0.1, COV)
    assert average([there, back]).odom_from_tag.angle_to(there.odom_from_tag) < 1e-6
