"""Residuals of both unknowns and their Jacobians, for steps of least squares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.calibration.hand_eye.views import Mounting, Views, predicted
from momantu_skills.calibration.poses import rotation_vectors, rotations_of, skew

UNKNOWNS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """Residuals (N, 6) between the target as it was seen and as predicted, and Jacobian (N, 6, 12).

    The first three of a residual are a rotation vector in the target's frame, rad; the others a
    position in the camera's, m. The Jacobian is with respect to turns `R Exp(turn)` and shifts of
    the eye and then of the target.
    """

    residuals: Array
    rows: Array

    def __getitem__(self, chosen: Any) -> Line:
        """The chosen views: an index array or a mask."""
        return Line(self.residuals[chosen], self.rows[chosen])


def linearised(views: Views, mounting: Mounting) -> Line:
    """The residuals at a mounting."""
    expected, seen = predicted(views, mounting), views.camera_from_target
    turned = rotation_vectors(np.swapaxes(expected.rotations, -1, -2) @ seen.rotations)
    camera_from_hand = mounting.eye.rotation.T
    half = 0.5 * skew(turned)
    rows = np.zeros((len(views), 6, UNKNOWNS))
    rows[:, :3, :3] = (np.eye(3) + half) @ np.swapaxes(seen.rotations, -1, -2)
    rows[:, :3, 6:9] = -(np.eye(3) - half)
    rows[:, 3:, :3] = -skew(expected.positions)
    rows[:, 3:, 3:6] = camera_from_hand
    rows[:, 3:, 9:] = -camera_from_hand @ np.swapaxes(views.outer.rotations, -1, -2)
    return Line(np.hstack([turned, seen.positions - expected.positions]), rows)


def step(square: Array, side: Array) -> Array:
    """The step (12,) of normal equations; unknowns are scaled first."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(square), 1e-30))
    scaled = square * np.outer(scale, scale) + 1e-12 * np.eye(len(square))
    return np.asarray(scale * np.linalg.solve(scaled, scale * side))


def moved(mounting: Mounting, step: Array) -> Mounting:
    """The mounting after a step (12,)."""
    eye, target = mounting.eye, mounting.target
    turns = rotations_of(np.array([step[:3], step[6:9]]))
    return Mounting(
        Transform.from_rotation(eye.rotation @ turns[0], eye.position + step[3:6]),
        Transform.from_rotation(target.rotation @ turns[1], target.position + step[9:]),
    )
