"""Transforms form a group, and every way to write a rotation agrees with the others."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from momantu_bt.geometry import (
    Pose2D,
    Transform,
    matrix_from_quaternion,
    quaternion_from_axis_angle,
    quaternion_from_matrix,
    quaternion_from_rpy,
    rotation_between,
    wrap_angle,
)

coordinate = st.floats(-10, 10)
angle = st.floats(-10, 10)
unit = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
transforms = st.builds(Transform, st.tuples(coordinate, coordinate, coordinate), unit)
planar = st.builds(Pose2D, coordinate, coordinate, angle)


def close(a: Transform, b: Transform) -> bool:
    return bool(np.allclose(a.position, b.position, atol=1e-9)) and a.angle_to(b) < 1e-6


@given(transforms, transforms, transforms)
def test_composition_is_associative(a: Transform, b: Transform, c: Transform) -> None:
    assert close((a @ b) @ c, a @ (b @ c))


@given(transforms)
def test_inverse_undoes(a: Transform) -> None:
    assert close(a @ a.inverse(), Transform())
    assert close(a.inverse() @ a, Transform())


@given(transforms, transforms, st.tuples(coordinate, coordinate, coordinate))
def test_composition_applies_right_first(
    a: Transform, b: Transform, p: tuple[float, float, float]
) -> None:
    assert np.allclose((a @ b).apply(p), a.apply(b.apply(p)), atol=1e-9)


@given(transforms)
def test_matrix_round_trip(a: Transform) -> None:
    assert close(Transform.from_matrix(a.matrix), a)


@given(unit)
def test_rotation_matrix_is_orthonormal(q: tuple[float, ...]) -> None:
    rotation = Transform(quaternion=q).rotation
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@given(angle, st.floats(-1.5, 1.5), angle)
def test_rpy_is_yaw_after_pitch_after_roll(roll: float, pitch: float, yaw: float) -> None:
    turns = [
        matrix_from_quaternion(quaternion_from_axis_angle(axis, value))
        for axis, value in (((0, 0, 1), yaw), ((0, 1, 0), pitch), ((1, 0, 0), roll))
    ]
    expected = turns[0] @ turns[1] @ turns[2]
    assert np.allclose(
        matrix_from_quaternion(quaternion_from_rpy(roll, pitch, yaw)), expected, atol=1e-9
    )


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
def test_half_turns_survive_the_matrix(axis: tuple[float, float, float]) -> None:
    rotation = matrix_from_quaternion(quaternion_from_axis_angle(axis, math.pi))
    assert np.allclose(matrix_from_quaternion(quaternion_from_matrix(rotation)), rotation)


@given(unit, unit)
def test_the_rotation_between_two_vectors_is_the_smallest_one(
    a: tuple[float, ...], b: tuple[float, ...]
) -> None:
    start, end = (Transform(quaternion=q).rotation[:, 0] for q in (a, b))
    assume(float(start @ end) > -0.99)
    rotation = rotation_between(start, end)
    assert np.allclose(rotation @ start, end, atol=1e-9)
    assert np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
    assert (np.trace(rotation) - 1) / 2 == pytest.approx(float(start @ end), abs=1e-9)


@given(angle)
def test_wrap_angle_keeps_the_direction(value: float) -> None:
    wrapped = wrap_angle(value)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(value), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(value), abs=1e-9)


@given(planar, planar)
def test_planar_poses_compose_as_their_transforms(a: Pose2D, b: Pose2D) -> None:
    assert close((a @ b).transform(), a.transform() @ b.transform())
    assert close(a.inverse().transform(), a.transform().inverse())


@given(planar, planar)
def test_a_planar_pose_carries_points_as_it_carries_poses(a: Pose2D, b: Pose2D) -> None:
    carried = a @ b
    np.testing.assert_allclose(a.apply(np.array([[b.x, b.y]])), [[carried.x, carried.y]], atol=1e-9)
    ahead = np.array([[math.cos(b.yaw), math.sin(b.yaw)]])
    turned = [[math.cos(carried.yaw), math.sin(carried.yaw)]]
    np.testing.assert_allclose(a.rotate(ahead), turned, atol=1e-9)


def test_a_transform_cannot_be_changed() -> None:
    transform = Transform((1, 2, 3))
    with pytest.raises(ValueError, match="read-only"):
        transform.position[0] = 5.0


def test_a_quaternion_without_length_is_refused() -> None:
    with pytest.raises(ValueError, match="no length"):
        Transform(quaternion=(0, 0, 0, 0))


def test_equal_transforms_hash_alike() -> None:
    a, b = Transform((1, 2, 3)), Transform((1, 2, 3))
    assert a == b
    assert len({a, b}) == 1
    assert a != Transform((1, 2, 4))
