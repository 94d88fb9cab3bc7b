"""Tops among points: as large as they are, from wherever they are seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from momantu_skills.perception.surface.tops import tops_among

PIXEL = 1.0 / 550.0
HEIGHT = 0.7
SIZE = (0.8, 1.4)


def seen(distance: float, above: float, yaw: float, noise: float) -> np.ndarray:
    """A top as a camera of 640 x 480 sees it, its middle `distance` m ahead, that much below."""
    tilt = math.atan2(above, distance)
    rows, columns = np.meshgrid(np.arange(480) - 239.5, np.arange(640) - 319.5, indexing="ij")
    beams = np.stack([np.ones(rows.shape), -columns * PIXEL, -rows * PIXEL], axis=-1).reshape(-1, 3)
    c, s = math.cos(tilt), math.sin(tilt)
    beams = beams @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    beams = beams[beams[:, 2] < -1e-3]
    random = np.random.default_rng(0)
    depths = above / -beams[:, 2]
    depths = depths * (1.0 + noise * random.standard_normal(len(depths)))
    points = beams * depths[:, None] + (0.0, 0.0, HEIGHT + above)
    own = (points[:, :2] - (distance, 0.0)) @ np.array(
        [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    )
    exact = beams[:, :2] * (above / -beams[:, 2])[:, None] - (distance, 0.0)
    exact = exact @ np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    assert own.shape == exact.shape
    return points[(np.abs(exact) <= np.array(SIZE) / 2).all(axis=1)]


@pytest.mark.parametrize("yaw", [0.0, 0.4])
@pytest.mark.parametrize(("distance", "above"), [(1.5, 0.5), (1.8, 0.4), (1.4, 0.7)])
def test_a_top_is_measured_to_its_far_edge(distance: float, above: float, yaw: float) -> None:
    """The camera is nearer to one edge, where the points are many times as dense."""
    (top, *_) = tops_among(seen(distance, above, yaw, 0.002), 0.5, 0.9)
    assert sorted(top.size) == pytest.approx(SIZE, abs=0.02)
    assert top.pose.x == pytest.approx(distance, abs=0.015)
    assert top.height == pytest.approx(HEIGHT, abs=0.005)
