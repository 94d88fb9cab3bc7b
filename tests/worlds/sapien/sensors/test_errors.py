"""Sensor errors have the size they claim, are drawn from the seed, and never repeat."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_worlds.robots import fetch
from momantu_worlds.sapien.config import CameraErrors, JointErrors, OdometryErrors
from momantu_worlds.sapien.drives.proprioception import Encoders, Odometry
from momantu_worlds.sapien.sensors.camera import Noise, draw_noise, noisy_color, noisy_depth

from momantu_bt.geometry import Pose2D
from momantu_bt.world import seeded

CAMERA = fetch().camera()[1]
ERRORS = CameraErrors()


def drawn(shape: tuple[int, ...], *parts: float) -> Noise:
    return draw_noise(seeded(*parts), shape[0], shape[1])


@pytest.mark.parametrize("distance", [0.6, 1.5, 3.0])
def test_depth_noise_grows_with_the_square_of_the_distance(distance: float) -> None:
    flat = np.full((480, 640), distance, dtype=np.float32)
    measured = noisy_depth(flat, drawn(flat.shape, 0, distance), CAMERA, ERRORS)
    seen = measured[measured > 0]
    rounding = ERRORS.depth_quantum / math.sqrt(12.0)
    sigma = math.hypot(ERRORS.depth_noise * distance**2, rounding)
    assert np.std(seen) == pytest.approx(sigma, rel=0.05)
    assert np.mean(seen) == pytest.approx(distance, abs=1e-3)
    assert 1.0 - len(seen) / flat.size == pytest.approx(ERRORS.drop_out, rel=0.3)


def test_a_camera_may_be_better_or_worse_than_usual() -> None:
    flat = np.full((480, 640), 2.0, dtype=np.float32)
    coarse = CAMERA.model_copy(update={"depth_noise": 0.006})
    measured = noisy_depth(flat, drawn(flat.shape, 0), coarse, ERRORS)
    assert np.std(measured[measured > 0]) == pytest.approx(0.006 * 4.0, rel=0.05)


def test_depth_ends_at_its_range_and_is_torn_at_edges() -> None:
    depth = np.full((480, 640), 1.0, dtype=np.float32)
    depth[:, 320:] = 2.0
    depth[:100] = 0.2
    depth[400:] = 6.0
    measured = noisy_depth(depth, drawn(depth.shape, 1), CAMERA, ERRORS)
    assert np.all(measured[:99] == 0.0)
    assert np.all(measured[401:] == 0.0)
    lost = np.mean(measured[110:390, 319:321] == 0.0)
    assert lost == pytest.approx(ERRORS.edge_hole, abs=0.1)
    assert np.mean(measured[110:390, 300:310] == 0.0) < 0.02


def test_a_slanted_plane_has_no_holes() -> None:
    focal, height = 554.0, 0.8
    rows = np.arange(1, 241, dtype=np.float32)[:, None]
    depth = np.repeat(height * focal / (rows + 100.0), 640, axis=1).astype(np.float32)
    measured = noisy_depth(depth, drawn(depth.shape, 2), CAMERA, ERRORS)
    near = depth < 4.0
    assert np.mean(measured[near] == 0.0) < 0.005


def test_colour_noise_has_its_sigma_and_stays_in_range() -> None:
    grey = np.full((480, 640, 4), 120, dtype=np.uint8)
    noisy = noisy_color(grey, drawn(grey.shape, 3), ERRORS).astype(float)
    assert noisy.shape == (480, 640, 3)
    assert np.std(noisy) == pytest.approx(ERRORS.color_noise, rel=0.2)
    assert np.mean(noisy) == pytest.approx(120, abs=0.05)
    white = np.full((48, 64, 4), 255, dtype=np.uint8)
    assert noisy_color(white, drawn(white.shape, 4), ERRORS).min() >= 250


def test_joint_offsets_are_constant_and_small() -> None:
    names = tuple(f"j{i}" for i in range(50))
    still = np.zeros(50)
    encoders = Encoders(names, np.zeros(50, dtype=bool), 7, JointErrors())
    readings = np.array([encoders.joints(still, still, still, 0.05 * i)[0] for i in range(200)])
    assert np.allclose(readings.mean(axis=0), encoders.offsets, atol=5e-5)
    assert np.std(encoders.offsets) == pytest.approx(1e-3, rel=0.4)
    assert np.std(readings - readings.mean(axis=0)) == pytest.approx(1e-4, rel=0.1)


def test_gripper_width_is_off_by_about_a_millimetre_and_never_negative() -> None:
    errors = []
    for seed in range(60):
        encoders = Encoders(("j",), np.zeros(1, dtype=bool), seed, JointErrors())
        widths = [encoders.gripper(0.07, 40.0, 0.05 * i)[0] for i in range(20)]
        errors += [width - 0.07 for width in widths]
        assert encoders.gripper(0.0, 0.0, 1.0)[0] >= 0.0
    assert 3e-4 < np.std(errors) < 9e-4
    assert np.max(np.abs(errors)) < 3e-3


def drive(seed: int, ticks: int, turn: float, errors: OdometryErrors) -> tuple[Pose2D, Pose2D]:
    """Where a base really gets to, and where its odometry believes it is; both from the start."""
    start = Pose2D(2.0, -1.0, 0.7)
    true, odometry = start, Odometry(start, seed, errors)
    for i in range(ticks):
        true = true @ Pose2D(0.03, 0.0, turn)
        odometry.update(true, 0.05 * (i + 1))
    return start.inverse() @ true, odometry.odom_from_base


@given(seed=st.integers(0, 100), turn=st.floats(-0.05, 0.05))
@settings(max_examples=20, deadline=None)
def test_odometry_without_errors_is_the_motion(seed: int, turn: float) -> None:
    none = OdometryErrors(0, 0, 0, 0, 0, 0)
    true, believed = drive(seed, 100, turn, none)
    assert believed.distance_to(true) < 1e-9
    assert abs(believed.yaw - true.yaw) < 1e-9


def test_odometry_drifts_with_distance() -> None:
    def drift(ticks: int) -> float:
        pairs = [drive(seed, ticks, 0.0, OdometryErrors()) for seed in range(40)]
        return float(np.mean([true.distance_to(believed) for true, believed in pairs]))

    short, long = drift(60), drift(400)
    assert 0.005 < short < 0.1
    assert 4.0 * short < long < 1.5


def test_odometry_stands_still_with_the_robot() -> None:
    odometry = Odometry(Pose2D(1, 2, 3), 0, OdometryErrors())
    for i in range(100):
        odometry.update(Pose2D(1, 2, 3), 0.05 * i)
    assert odometry.odom_from_base == Pose2D(0.0, 0.0, 0.0)


def test_reported_speeds_are_near_the_true_ones() -> None:
    odometry = Odometry(Pose2D(0, 0, 0), 1, OdometryErrors())
    speeds = np.array([odometry.speeds(0.5, -0.4, 0.05 * i) for i in range(200)])
    assert np.allclose(speeds.mean(axis=0), [0.5, -0.4], atol=0.03)
    assert math.isclose(float(np.std(speeds[:, 0])), 0.005, rel_tol=0.2)
