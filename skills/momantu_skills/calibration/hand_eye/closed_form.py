"""Closed forms for the eye's mounting, as OpenCV and ROS packages have them; for comparison.

Tsai and Lenz 1989, Park and Martin 1994, Horaud and Dornaika 1995, Andreff et al. 1999,
Daniilidis 1999. None of them knows that a view can be wrong.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from momantu_bt.geometry import Array, Transform, quaternion_product
from momantu_skills.calibration.hand_eye.motions import Motions, motions, position_of_eye
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import (
    Poses,
    angles,
    nearest_rotations,
    quaternions,
    rotation_vectors,
    rotations_of,
    skew,
)


def tsai(pairs: Motions) -> Transform:
    """Tsai and Lenz: a linear system for the rotation's Rodrigues vector, then the position."""
    hand = 2.0 * quaternions(pairs.hand.rotations)[:, 1:]
    camera = 2.0 * quaternions(pairs.camera.rotations)[:, 1:]
    rows, side = skew(hand + camera).reshape(-1, 3), (camera - hand).ravel()
    tangent = np.linalg.lstsq(rows, side, rcond=None)[0]
    length = float(np.linalg.norm(tangent))
    vector = tangent * (2.0 * np.arctan(length) / length if length > 1e-12 else 2.0)
    return _with_position(pairs, rotations_of(vector))


def park(pairs: Motions) -> Transform:
    """Park and Martin: aligns the rotation vectors, then the position."""
    hand, camera = rotation_vectors(pairs.hand.rotations), rotation_vectors(pairs.camera.rotations)
    return _with_position(pairs, nearest_rotations(hand.T @ camera))


def horaud(pairs: Motions) -> Transform:
    """Horaud and Dornaika: aligns the axes as unit quaternions, then the position."""
    hand, camera = rotation_vectors(pairs.hand.rotations), rotation_vectors(pairs.camera.rotations)
    hand /= np.linalg.norm(hand, axis=1, keepdims=True)
    camera /= np.linalg.norm(camera, axis=1, keepdims=True)
    rows = np.zeros((len(pairs), 4, 4))  # hand * q - q * camera, linear in q
    rows[:, 0, 1:], rows[:, 1:, 0] = camera - hand, hand - camera
    rows[:, 1:, 1:] = skew(hand + camera)
    _, vectors = np.linalg.eigh(np.einsum("mri,mrj->ij", rows, rows))
    return _with_position(pairs, Transform(quaternion=vectors[:, 0]).rotation)


def andreff(pairs: Motions) -> Transform:
    """Andreff et al.: rotation matrix and position from one linear system."""
    count = len(pairs)
    rows, side = np.zeros((count, 12, 12)), np.zeros((count, 12))
    turned = np.einsum("mij,mkl->mikjl", pairs.hand.rotations, pairs.camera.rotations)
    rows[:, :9, :9] = np.eye(9) - turned.reshape(count, 9, 9)
    rows[:, 9:, :9] = np.einsum("ij,mk->mijk", np.eye(3), pairs.camera.positions).reshape(-1, 3, 9)
    rows[:, 9:, 9:] = np.eye(3) - pairs.hand.rotations
    side[:, 9:] = pairs.hand.positions
    found = np.linalg.lstsq(rows.reshape(-1, 12), side.ravel(), rcond=None)[0]
    return _with_position(pairs, nearest_rotations(found[:9].reshape(3, 3).astype(float)))


def daniilidis(pairs: Motions) -> Transform:
    """Daniilidis: rotation and position as one unit dual quaternion."""
    hand, hand_dual = _dual(pairs.hand)
    camera, camera_dual = _dual(pairs.camera)
    rows = np.zeros((len(pairs), 6, 8))
    rows[:, :3, 0] = rows[:, 3:, 4] = hand - camera
    rows[:, :3, 1:4] = rows[:, 3:, 5:] = skew(hand + camera)
    rows[:, 3:, 0] = hand_dual - camera_dual
    rows[:, 3:, 1:4] = skew(hand_dual + camera_dual)
    _, vectors = np.linalg.eigh(np.einsum("mri,mrj->ij", rows, rows))
    (u1, v1), (u2, v2) = np.split(vectors[:, 0], 2), np.split(vectors[:, 1], 2)
    roots = np.roots([u1 @ v1, u1 @ v2 + u2 @ v1, u2 @ v2]).real
    lengths = [s * s * (u1 @ u1) + 2 * s * (u1 @ u2) + u2 @ u2 for s in roots]
    best = int(np.argmax(lengths))
    second = 1.0 / np.sqrt(lengths[best])
    real, dual = second * (roots[best] * u1 + u2), second * (roots[best] * v1 + v2)
    return Transform(2.0 * quaternion_product(dual, real * [1, -1, -1, -1])[1:], real)


METHODS: dict[str, Callable[[Motions], Transform]] = {
    "Tsai": tsai,
    "Park": park,
    "Horaud": horaud,
    "Andreff": andreff,
    "Daniilidis": daniilidis,
}


def closed_form(views: Views, method: str) -> Mounting | None:
    """The mounting by one of the methods; None where the views allow none."""
    pairs = motions(views)
    if len(pairs) < 2:
        return None
    try:
        eye = METHODS[method](pairs)
    except (np.linalg.LinAlgError, ValueError, IndexError):
        return None
    if not np.isfinite(eye.matrix).all():
        return None
    return Mounting(eye, target_of(views, eye))


def target_of(views: Views, eye: Transform) -> Transform:
    """Where the target is, by that half of the views that agree best with each other."""
    each = views.outer @ Poses.of([eye]) @ views.camera_from_target
    middle = np.median(each.positions, axis=0)
    typical = nearest_rotations(each.rotations.sum(axis=0))
    apart = np.linalg.norm(each.positions - middle, axis=1)
    turned = angles(typical.T @ each.rotations)
    rank = np.maximum(np.argsort(np.argsort(apart)), np.argsort(np.argsort(turned)))
    near = each[np.argsort(rank, kind="stable")[: (len(views) + 1) // 2]]
    return Transform.from_rotation(
        nearest_rotations(near.rotations.sum(axis=0)), near.positions.mean(axis=0)
    )


def _with_position(pairs: Motions, rotation: Array) -> Transform:
    return Transform.from_rotation(rotation, position_of_eye(pairs, rotation))


def _dual(poses: Poses) -> tuple[Array, Array]:
    """The vector parts (N, 3) of unit dual quaternions, real and dual; the real scalar is >= 0."""
    real = quaternions(poses.rotations)
    dual = 0.5 * (real[:, :1] * poses.positions + np.cross(poses.positions, real[:, 1:]))
    return real[:, 1:], dual
