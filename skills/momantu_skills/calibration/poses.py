"""Many rigid transforms at once, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from momantu_bt.geometry import Array, Transform

_SMALL = 1e-9
_HALF_TURN = 1e-3
"""Twice the sine of an angle near pi, where the skew part hardly tells the axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """N rigid transforms: rotations (..., 3, 3) and positions (..., 3) in metres."""

    rotations: Array
    positions: Array

    @classmethod
    def of(cls, transforms: Sequence[Transform]) -> Poses:
        """From single transforms; at least one."""
        return cls(
            np.array([each.rotation for each in transforms]),
            np.array([each.position for each in transforms]),
        )

    def __len__(self) -> int:
        return len(self.positions)

    def __getitem__(self, chosen: Any) -> Poses:
        """The chosen ones: an index array, a mask or a slice."""
        return Poses(self.rotations[chosen], self.positions[chosen])

    def __matmul__(self, other: Poses) -> Poses:
        """`a_from_b @ b_from_c` is `a_from_c`, of arrays that broadcast."""
        moved = np.einsum("...ij,...j->...i", self.rotations, other.positions)
        return Poses(self.rotations @ other.rotations, moved + self.positions)

    def inverse(self) -> Poses:
        """The transforms that undo these."""
        turned = np.swapaxes(self.rotations, -1, -2)
        return Poses(turned, -np.einsum("...ij,...j->...i", turned, self.positions))

    def transform(self, index: int = 0) -> Transform:
        """One of them as a single transform."""
        return Transform.from_rotation(self.rotations[index], self.positions[index])


def rotation_vectors(rotations: Array) -> Array:
    """Axis times angle in rad, (..., 3), of rotations (..., 3, 3)."""
    vectors = _axial(rotations)
    sine = np.linalg.norm(vectors, axis=-1)
    cosine = np.trace(rotations, axis1=-2, axis2=-1) - 1.0
    if (sine[cosine < 0] < _HALF_TURN).any():
        flat = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_rotvec()
        return np.asarray(flat.reshape(vectors.shape))
    small = sine < _SMALL
    scale = np.where(small, 0.5, np.arctan2(sine, cosine) / np.where(small, 1.0, sine))
    return np.asarray(scale[..., None] * vectors)


def rotations_of(vectors: Array) -> Array:
    """Rotations (..., 3, 3) of rotation vectors (..., 3)."""
    flat = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
    return np.asarray(flat.reshape(*vectors.shape, 3))


def quaternions(rotations: Array) -> Array:
    """Unit quaternions (..., 4), w x y z with w >= 0, of rotations (..., 3, 3)."""
    flat = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat(True, scalar_first=True)
    return np.asarray(flat.reshape(*rotations.shape[:-2], 4))


def rotations_of_quaternions(values: Array) -> Array:
    """Rotations (N, 3, 3) of unit quaternions (N, 4), w x y z."""
    return np.asarray(Rotation.from_quat(values, scalar_first=True).as_matrix())


def angles(rotations: Array) -> Array:
    """The angles of rotations (..., 3, 3), rad in [0, pi]; exact for small angles too."""
    sine = np.linalg.norm(_axial(rotations), axis=-1)
    return np.asarray(np.arctan2(sine, np.trace(rotations, axis1=-2, axis2=-1) - 1.0))


def _axial(matrices: Array) -> Array:
    """The axes (..., 3) of rotations (..., 3, 3), of length twice the sine of the angle."""
    m = matrices
    return np.stack(
        [
            m[..., 2, 1] - m[..., 1, 2],
            m[..., 0, 2] - m[..., 2, 0],
            m[..., 1, 0] - m[..., 0, 1],
        ],
        axis=-1,
    )


def nearest_rotations(matrices: Array) -> Array:
    """The rotations (..., 3, 3) nearest to matrices (Kabsch); of a sum, the chordal mean."""
    left, _, right = np.linalg.svd(matrices)
    sign = np.linalg.det(left @ right)
    left = left.copy()
    left[..., :, 2] *= sign[..., None]
    return np.asarray(left @ right)


def turns_between(poses: Poses) -> tuple[Array, Array]:
    """Typical angles (3,) in rad between two views about three axes, largest first, and the axes.

    The axes (3, 3), a row each, are in the frame whose pose is given, such as the hand of
    `base_from_hand`.
    """
    first, second = np.triu_indices(len(poses), 1)
    if len(first) > 20_000:
        even = np.linspace(0, len(first) - 1, 20_000).astype(int)
        first, second = first[even], second[even]
    between = np.swapaxes(poses.rotations[second], -1, -2) @ poses.rotations[first]
    vectors = 2.0 * quaternions(between)[:, 1:]
    values, axes = np.linalg.eigh(np.einsum("mi,mj->ij", vectors, vectors) / len(vectors))
    return np.sqrt(np.clip(values[::-1], 0.0, None)), axes[:, ::-1].T


def skew(vectors: Array) -> Array:
    """Matrices (..., 3, 3) of the cross products with vectors (..., 3)."""
    matrices = np.zeros((*vectors.shape, 3))
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    matrices[..., 0, 1], matrices[..., 0, 2], matrices[..., 1, 2] = -z, y, -x
    matrices[..., 1, 0], matrices[..., 2, 0], matrices[..., 2, 1] = z, -y, x
    return matrices


Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]
