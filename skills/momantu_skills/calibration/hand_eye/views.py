"""The views of a hand-eye calibration, and the two unknown transforms that explain them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.calibration.poses import Poses, angles


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """N moments at which both the hand's pose and the target's pose were measured.

    outer: `base_from_hand` with the eye in the hand, `hand_from_base` with the eye on the base.
    camera_from_target: as the camera saw it.
    """

    outer: Poses
    camera_from_target: Poses

    def __len__(self) -> int:
        return len(self.outer)

    def __getitem__(self, chosen: Any) -> Views:
        """The chosen views: an index array, a mask or a slice."""
        return Views(self.outer[chosen], self.camera_from_target[chosen])


@dataclass(frozen=True, slots=True)
class Mounting:
    """The unknowns: `outer @ eye @ camera_from_target` is `target` in every view.

    eye: `hand_from_camera`, or `base_from_camera` with the eye on the base.
    target: `base_from_target`, or `hand_from_target` with the eye on the base.
    """

    eye: Transform
    target: Transform


def predicted(views: Views, mounting: Mounting) -> Poses:
    """`camera_from_target` (N) as it should have been seen."""
    outer_from_target = views.outer.inverse() @ Poses.of([mounting.target])
    return Poses.of([mounting.eye.inverse()]) @ outer_from_target


def residuals(views: Views, mounting: Mounting) -> tuple[Array, Array]:
    """How far each view is from its prediction: angles (N,) in rad, distances (N,) in m."""
    expected, seen = predicted(views, mounting), views.camera_from_target
    turned = angles(np.swapaxes(expected.rotations, -1, -2) @ seen.rotations)
    return turned, np.linalg.norm(seen.positions - expected.positions, axis=-1)
