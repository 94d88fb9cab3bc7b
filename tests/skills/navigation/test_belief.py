"""What a cloud of particles says."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from momantu_skills.navigation.localize.belief import (
    covariance,
    differences,
    main_cluster,
    mean_pose,
)
from momantu_skills.navigation.localize.confidence import sigmas

from momantu_bt.geometry import Pose2D

YAWS = st.floats(-math.pi, math.pi)


@settings(max_examples=40)
@given(st.floats(-5, 5), st.floats(-5, 5), YAWS, st.integers(0, 1000))
def test_the_mean_moves_with_the_cloud(x: float, y: float, yaw: float, seed: int) -> None:
    noise = np.random.default_rng(seed).normal(size=(200, 3)) * 0.05
    poses = np.array([x, y, yaw]) + noise - noise.mean(axis=0)
    mean = mean_pose(poses, np.ones(200))
    assert (mean.x, mean.y) == pytest.approx((x, y), abs=1e-9)
    assert abs(differences(np.array([[0, 0, mean.yaw]]), Pose2D(0, 0, yaw))[0, 2]) < 1e-3


def test_the_main_cluster_ignores_the_lighter_one() -> None:
    random = np.random.default_rng(0)
    heavy = np.array([1.0, 2.0, 3.1]) + random.normal(size=(300, 3)) * 0.03
    light = np.array([-4.0, 0.0, 0.0]) + random.normal(size=(100, 3)) * 0.03
    poses = np.concatenate([light, heavy])
    pose = main_cluster(poses, np.ones(400), Pose2D(-4.0, 0.0, 0.0))
    assert pose.distance_to(Pose2D(1.0, 2.0, 0.0)) < 0.01
    assert sigmas(covariance(poses, np.ones(400), pose))[0] > 1.0


@settings(max_examples=40)
@given(st.floats(0.01, 2.0), st.floats(0.01, 2.0), YAWS)
def test_sigma_is_that_of_the_widest_axis(a: float, b: float, turn: float) -> None:
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, -s], [s, c]])
    spread = np.zeros((3, 3))
    spread[:2, :2] = rotation @ np.diag([a * a, b * b]) @ rotation.T
    spread[2, 2] = 0.04
    assert sigmas(spread) == pytest.approx((max(a, b), 0.2), rel=1e-6)


def test_weights_count() -> None:
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    assert mean_pose(poses, np.array([1.0, 3.0])).x == pytest.approx(0.75)
