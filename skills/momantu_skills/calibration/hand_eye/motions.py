"""Motions between views, of the hand and of the camera: the eye's mounting relates them.

For each pair of views `hand @ X == X @ camera`, with X the eye; the target drops out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.hand_eye.views import Views
from momantu_skills.calibration.poses import Poses, angles

_MOST_VIEWS = 60
"""Pairs grow with the square of the views; more views than this tell little."""
_LEAST_ANGLE = math.radians(3.0)
_MOST_ANGLE = math.radians(170.0)
"""An axis is badly known below, and its sign above."""


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """M pairs of motions, each in its own frame: of the hand, and of the camera."""

    hand: Poses
    camera: Poses

    def __len__(self) -> int:
        return len(self.hand)


def motions(views: Views) -> Motions:
    """All motions between two views whose rotation has a good axis, of evenly chosen views."""
    few = views[np.unique(np.linspace(0, len(views) - 1, _MOST_VIEWS).round().astype(int))]
    first, second = np.triu_indices(len(few), 1)
    hand = few.outer[second].inverse() @ few.outer[first]
    seen = few.camera_from_target
    camera = seen[second] @ seen[first].inverse()
    turned = np.stack([angles(hand.rotations), angles(camera.rotations)])
    good = (turned > _LEAST_ANGLE).all(axis=0) & (turned < _MOST_ANGLE).all(axis=0)
    return Motions(hand[good], camera[good])


def position_of_eye(motions: Motions, rotation: Array) -> Array:
    """The eye's position (3,), given its rotation (3, 3): linear least squares."""
    rows = (motions.hand.rotations - np.eye(3)).reshape(-1, 3)
    side = motions.camera.positions @ rotation.T - motions.hand.positions
    return np.asarray(np.linalg.lstsq(rows, side.ravel(), rcond=None)[0])
