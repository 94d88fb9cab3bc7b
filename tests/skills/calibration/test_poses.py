"""Arrays of transforms: the group's laws, and conversions at small angles and half turns."""

from __future__ import annotations

import numpy as np
import pytest
from momantu_skills.calibration.poses import (
    Poses,
    angles,
    nearest_rotations,
    quaternions,
    rotation_vectors,
    rotations_of,
    rotations_of_quaternions,
)

from momantu_bt.geometry import Transform


def random(count: int, seed: int) -> Poses:
    rng = np.random.default_rng(seed)
    return Poses(rotations_of(rng.normal(size=(count, 3))), rng.normal(size=(count, 3)))


def test_products_and_inverses_are_those_of_single_transforms() -> None:
    first, second = random(5, 0), random(5, 1)
    both, back = first @ second, first.inverse()
    for i in range(5):
        single = first.transform(i) @ second.transform(i)
        assert both.transform(i).matrix == pytest.approx(single.matrix, abs=1e-12)
        assert back.transform(i).matrix == pytest.approx(
            first.transform(i).inverse().matrix, abs=1e-12
        )
    one = Poses.of([Transform((1, 2, 3))])
    assert (one @ first).positions == pytest.approx(first.positions + np.array([1, 2, 3]))


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 0.3, 3.0, np.pi - 1e-5, np.pi - 1e-9])
def test_rotation_vectors_come_back(angle: float) -> None:
    axes = np.random.default_rng(2).normal(size=(20, 3))
    vectors = angle * axes / np.linalg.norm(axes, axis=1, keepdims=True)
    found = rotations_of(vectors)
    assert rotation_vectors(found) == pytest.approx(vectors, abs=1e-9)
    assert angles(found) == pytest.approx(np.full(20, angle), abs=1e-9)


def test_quaternions_come_back() -> None:
    poses = random(9, 3)
    found = quaternions(poses.rotations)
    assert (found[:, 0] >= 0).all()
    assert rotations_of_quaternions(found) == pytest.approx(poses.rotations, abs=1e-12)


def test_the_nearest_rotation_is_a_rotation() -> None:
    matrices = np.random.default_rng(4).normal(size=(20, 3, 3))
    found = nearest_rotations(matrices)
    assert np.linalg.det(found) == pytest.approx(np.ones(20))
    assert found @ np.swapaxes(found, -1, -2) == pytest.approx(np.tile(np.eye(3), (20, 1, 1)))
    assert nearest_rotations(7.0 * found) == pytest.approx(found)
