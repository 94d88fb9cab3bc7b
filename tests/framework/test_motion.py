"""Between two poses a frame is where an even motion brings it; beyond the ends it stands."""

from __future__ import annotations

import math

import numpy as np
import pytest

from momantu_bt.geometry import Transform, matrix_from_quaternion, quaternion_from_axis_angle
from momantu_bt.motion import Motion, rotations


def turned(angle: float, x: float) -> Transform:
    return Transform((x, 0.0, 0.0), quaternion_from_axis_angle((0, 0, 1), angle))


def test_halfway_is_half_the_turn_and_half_the_way() -> None:
    motion = Motion.of([1.0, 2.0, 4.0], [turned(0.0, 0.0), turned(1.0, 2.0), turned(1.0, 2.0)])
    turns, places = motion.at(np.array([1.5, 1.75, 3.0]))
    angles = np.arctan2(turns[:, 1, 0], turns[:, 0, 0])
    assert angles == pytest.approx([0.5, 0.75, 1.0])
    assert places[:, 0] == pytest.approx([1.0, 1.5, 2.0])


def test_the_shorter_way_is_taken_whatever_the_signs_of_quaternions() -> None:
    one, other = turned(0.1, 0.0), turned(0.3, 0.0)
    flipped = Transform(other.position, -other.quaternion)
    turns, _ = Motion.of([0.0, 1.0], [one, flipped]).at(np.array([0.5]))
    assert math.atan2(turns[0, 1, 0], turns[0, 0, 0]) == pytest.approx(0.2)


def test_beyond_its_ends_and_with_one_pose_it_stands() -> None:
    motion = Motion.of([1.0, 2.0], [turned(0.0, 0.0), turned(1.0, 2.0)])
    assert motion.at(np.array([0.0, 9.0]))[1][:, 0] == pytest.approx([0.0, 2.0])
    assert Motion.of([1.0], [turned(0.4, 3.0)]).at(np.array([0.0, 5.0]))[1][:, 0] == (
        pytest.approx([3.0, 3.0])
    )


def test_rotations_of_many_quaternions_are_those_of_each() -> None:
    random = np.random.default_rng(0)
    some = random.standard_normal((5, 4))
    some /= np.linalg.norm(some, axis=1, keepdims=True)
    assert rotations(some) == pytest.approx(np.array([matrix_from_quaternion(q) for q in some]))
