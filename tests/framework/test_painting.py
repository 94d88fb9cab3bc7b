"""The painted camera: what it measures is what is there, but for the errors it was given."""

from __future__ import annotations

import numpy as np
import pytest

from momantu_bt.geometry import Transform
from momantu_bt.messages import CameraImage
from momantu_bt.testing import ScriptedRobot
from momantu_bt.testing.painting import Block, Card, Painter, Round

BLOCK = Block((0.4, 0.6, 0.5), (1.5, 0.0, 0.25), 0.3)
POST = Round((1.0, 0.15, 0.0), 0.9, 0.08)


def picture(painter: Painter) -> tuple[CameraImage, np.ndarray]:
    """The picture and its points (n, 3) in odom."""
    robot = ScriptedRobot(joints={"tilt": 0.5}, readings={"camera": painter})
    image = robot.read("camera")
    assert isinstance(image, CameraImage)
    rows, columns = np.nonzero(image.depth)
    z = image.depth[rows, columns].astype(float)
    k = image.intrinsics
    x, y = (columns - k[0, 2]) / k[0, 0] * z, (rows - k[1, 2]) / k[1, 1] * z
    camera = robot.description.kinematics().base_from_frame(image.frame, robot.joints)
    return image, camera.apply(np.column_stack([x, y, z]))


def test_every_exact_point_lies_on_something() -> None:
    _, points = picture(Painter([BLOCK, POST], exact=True))
    turn = Transform(BLOCK.centre, (np.cos(0.15), 0, 0, np.sin(0.15))).inverse()
    block = np.abs(turn.apply(points)) - np.array(BLOCK.size) / 2
    radius = np.hypot(points[:, 0] - 1.0, points[:, 1] - 0.15)
    on_block = np.abs(block.max(axis=1)) < 1e-5
    on_post = (np.abs(radius - 0.08) < 1e-5) | (
        (np.abs(points[:, 2] - 0.9) < 1e-5) & (radius < 0.08)
    )
    on_floor = np.abs(points[:, 2]) < 1e-5
    assert (on_block | on_post | on_floor).all()
    assert on_block.any()
    assert on_post.any()
    assert on_floor.any()


def test_a_hollow_body_shows_its_inside() -> None:
    _, closed = picture(Painter([Round((1.0, 0.0, 0.0), 0.4, 0.2)], exact=True))
    _, hollow = picture(Painter([Round((1.0, 0.0, 0.0), 0.4, 0.2, hollow=True)], exact=True))
    inside = [np.hypot(p[:, 0] - 1.0, p[:, 1]) < 0.15 for p in (closed, hollow)]
    assert closed[inside[0], 2] == pytest.approx(0.4, abs=1e-5)
    assert hollow[inside[1], 2] == pytest.approx(0.0, abs=1e-5)


def test_noise_grows_with_the_square_of_the_distance() -> None:
    exact, _ = picture(Painter([], exact=True))
    noisy, _ = picture(Painter([], holes=0.0))
    both = (exact.depth > 0) & (noisy.depth > 0)
    relative = (noisy.depth - exact.depth)[both] / exact.depth[both] ** 2
    assert relative.std() == pytest.approx(0.0015, rel=0.15)


def test_a_card_is_bright_where_its_pixels_are() -> None:
    pixels = np.array([[1, 0], [0, 0]], dtype=np.uint8)
    card = Card(Transform((1.8, 0.0, 0.01), (1.0, 0.0, 0.0, 0.0)), 0.6, pixels)
    image, points = picture(Painter([card], exact=True))
    grey = image.color[image.depth > 0][:, 0]
    on_card = (np.abs(points[:, :2] - (1.8, 0.0)) < 0.28).all(axis=1)
    bright = points[on_card & (grey > 200)]
    assert len(bright) > 10
    assert (bright[:, 0] < 1.81).all()
    assert (bright[:, 1] > -0.01).all()


def test_the_same_seed_and_time_give_the_same_picture() -> None:
    first, second = picture(Painter([BLOCK], seed=4))[0], picture(Painter([BLOCK], seed=4))[0]
    other = picture(Painter([BLOCK], seed=5))[0]
    assert (first.depth == second.depth).all()
    assert (first.depth != other.depth).any()
