"""The head camera sees the scene as it is, within the errors that it claims."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import sapien
from momantu_worlds.robots import fetch
from momantu_worlds.sapien import simulator
from momantu_worlds.sapien.config import CameraErrors, SimulatorConfig
from momantu_worlds.sapien.sensors.camera import Camera
from momantu_worlds.sapien.sensors.camera_view import ViewCamera
from momantu_worlds.sapien.simulator import Simulator
from momantu_worlds.testing import CAN_HEIGHT, TABLE_HEIGHT, plain_episode

from momantu_bt.geometry import Array, Transform, quaternion_from_rpy
from momantu_bt.messages import CameraImage, JointPositions
from momantu_bt.robot import read_camera
from momantu_bt.world import WorldError

FETCH = fetch()
NAME, SENSOR = FETCH.camera()
PERFECT = dataclasses.replace(
    CameraErrors(), mounting_position=0.0, mounting_angle=0.0, color_noise=0.0
)
TAG = (1.0, 0.4, TABLE_HEIGHT + 0.001)
CAN = (0.95, 0.0)


def looking_down(errors: CameraErrors) -> Simulator:
    """A robot whose head has turned to the table."""
    config = SimulatorConfig(camera=errors)
    simulator = Simulator(FETCH, plain_episode(), 0, config=config)
    head = JointPositions(("head_pan_joint", "head_tilt_joint"), (0.2, 0.55))
    for _ in range(20):
        simulator.robot.command("head", head)
        simulator.step()
    return simulator


@pytest.fixture(scope="module")
def exact() -> tuple[Simulator, CameraImage]:
    simulator = looking_down(PERFECT)
    return simulator, read_camera(simulator.robot)


def map_points(simulator: Simulator, image: CameraImage, depth: Array) -> Array:
    """Every pixel (h, w, 3) in the map, by the pinhole model and the link's true pose."""
    v, u = np.mgrid[: depth.shape[0], : depth.shape[1]]
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(image.intrinsics).T
    return simulator.truth.link(image.frame).apply(rays * depth[..., None])


def pixel(simulator: Simulator, image: CameraImage, point: tuple[float, ...]) -> tuple[int, int]:
    """Column and row at which a point of the map appears."""
    x, y, z = simulator.truth.link(image.frame).inverse().apply(np.array(point))
    u, v, _ = image.intrinsics @ np.array([x / z, y / z, 1.0])
    return round(float(u)), round(float(v))


def test_depth_is_where_the_table_and_the_can_are(
    exact: tuple[Simulator, CameraImage],
) -> None:
    simulator, image = exact
    camera = simulator.robot.sensors[NAME]
    assert isinstance(camera, Camera)
    points = map_points(simulator, image, camera.exact_depth())
    on_table = (np.abs(points[..., 0] - 1.2) < 0.38) & (np.abs(points[..., 1]) < 0.6)
    on_can = np.hypot(points[..., 0] - CAN[0], points[..., 1] - CAN[1]) < 0.05
    table = points[on_table & ~on_can]
    assert len(table) > 10_000
    assert np.median(np.abs(table[:, 2] - TABLE_HEIGHT)) < 1e-4
    top = points[on_can][:, 2].max()
    assert top == pytest.approx(TABLE_HEIGHT + CAN_HEIGHT, abs=2e-3)


def test_measured_depth_has_errors_about_the_truth(exact: tuple[Simulator, CameraImage]) -> None:
    simulator, image = exact
    camera = simulator.robot.sensors[NAME]
    assert isinstance(camera, Camera)
    truth = camera.exact_depth()
    seen = image.depth > 0
    assert image.depth.dtype == np.float32
    assert image.depth[seen].max() <= SENSOR.max_depth
    scaled = (image.depth - truth)[seen] / truth[seen] ** 2
    assert np.std(scaled) == pytest.approx(PERFECT.depth_noise, rel=0.1)
    assert np.mean(~seen & (truth > 0.4) & (truth < 4.0)) > 1e-3


def test_a_picture_lies_the_right_way_round(exact: tuple[Simulator, CameraImage]) -> None:
    simulator, image = exact
    # the trial scene's picture is white but for a black square towards its +x and +y corner
    dark = pixel(simulator, image, (TAG[0] + 0.0375, TAG[1] + 0.0375, TAG[2]))
    others = [(-0.05, 0.04), (0.04, -0.05), (-0.05, -0.05)]
    light = [pixel(simulator, image, (TAG[0] + x, TAG[1] + y, TAG[2])) for x, y in others]
    assert image.color[dark[1], dark[0]].max() < 40
    assert all(image.color[v, u].min() > 120 for u, v in light)


def test_the_can_is_red_where_it_stands(exact: tuple[Simulator, CameraImage]) -> None:
    simulator, image = exact
    u, v = pixel(simulator, image, (CAN[0] - 0.035, CAN[1], TABLE_HEIGHT + 0.07))
    red, green, blue = (int(c) for c in image.color[v, u])
    assert red > 3 * max(green, blue, 20)


def test_the_mounting_error_is_small_constant_and_seeded() -> None:
    errors = CameraErrors()
    simulator = looking_down(errors)
    camera = simulator.robot.sensors[NAME]
    assert isinstance(camera, Camera)
    offset = camera.link_from_camera
    assert 0.0 < float(np.linalg.norm(offset.position)) < 4 * errors.mounting_position
    assert 0.0 < offset.angle_to(Transform()) < 4 * math.sqrt(3) * errors.mounting_angle
    again = looking_down(errors).robot.sensors[NAME]
    assert isinstance(again, Camera)
    assert again.link_from_camera == offset


def test_leaving_out_what_is_not_in_view_does_not_change_the_picture(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    simulator = looking_down(PERFECT)
    camera = simulator.robot.sensors[NAME]
    assert isinstance(camera, Camera)
    for tilt in (-0.5, 0.4, 1.4):
        for _ in range(25):
            simulator.robot.command("head", JointPositions(("head_tilt_joint",), (tilt,)))
            simulator.step()
        color = read_camera(simulator.robot).color
        assert camera.culling.outside(simulator.truth.link(SENSOR.frame))
        with monkeypatch.context() as patch:
            patch.setattr(camera.culling, "outside", lambda pose: [])
            complete = camera.read(simulator.now()).color
        assert np.array_equal(color, complete)


def test_reading_pictures_does_not_change_the_run() -> None:
    runs = []
    for look in (False, True):
        simulator = Simulator(FETCH, plain_episode(), 4)
        for _ in range(10):
            simulator.step()
            if look:
                read_camera(simulator.robot)
        runs.append(simulator.state_bytes())
    assert runs[0] == runs[1]


def test_a_free_camera_looks_along_x(exact: tuple[Simulator, CameraImage]) -> None:
    view = ViewCamera(exact[0].scene, 160, 120, 1.0)
    above_can = Transform((*CAN, 2.0), quaternion_from_rpy(0.0, math.pi / 2, 0.0))
    red, green, _ = (int(c) for c in view.take(above_can)[60, 80])
    assert red > 2 * green


def test_without_a_rendering_device_the_cure_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise RuntimeError("failed to find a rendering device")

    monkeypatch.setattr(sapien.render, "RenderSystem", fail)
    with pytest.raises(WorldError, match=r"Vulkan.*make setup.*doctor"):
        simulator.render_system()
