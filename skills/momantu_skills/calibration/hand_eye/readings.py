"""Other ways to read the same numbers: inverted, in another unit, quaternions in another order.

If both records are inverted, or swapped, the equations hold all the same: the eye and the target
have changed roles. No residual shows that.
"""

from __future__ import annotations

from enum import Enum

import numpy as np

from momantu_skills.calibration.hand_eye.start import starts
from momantu_skills.calibration.hand_eye.views import Views
from momantu_skills.calibration.poses import Poses, quaternions, rotations_of_quaternions

_TIMES = 4.0**2
"""A reading is another one only if its residuals are smaller by this factor, squared."""
_BAD = 5.0**2
"""Squared residuals in units of usual noise below which nobody doubts the files."""


class Reading(Enum):
    """What the numbers may be instead of what they were said to be."""

    HAND_INVERTED = "hand inverted"
    TARGET_INVERTED = "target inverted"
    HAND_MILLIMETRES = "hand in mm"
    TARGET_MILLIMETRES = "target in mm"
    HAND_CENTIMETRES = "hand in cm"
    TARGET_CENTIMETRES = "target in cm"
    MIRRORED = "one against the other mirrored"
    HAND_TURNED_BACK = "quaternions of the hand inverted, positions not"
    TARGET_TURNED_BACK = "quaternions of the target inverted, positions not"
    HAND_W_FIRST = "quaternions of the hand w first"
    TARGET_W_FIRST = "quaternions of the target w first"
    BOTH_W_FIRST = "quaternions of both w first"


def better_reading(views: Views, seed: int) -> Reading | None:
    """The reading that explains the views far better than they do as they are, if there is one."""
    given = _score(views, seed)
    if given < _BAD:
        return None
    scores = {
        reading: min(_score(each, seed) for each in options)
        for reading, options in _readings(views).items()
    }
    best = min(scores, key=lambda reading: scores[reading])
    return best if scores[best] * _TIMES < given else None


def _score(views: Views, seed: int) -> float:
    found = starts(views, np.random.default_rng(seed), 1)
    return found[0].score if found else float("inf")


def _readings(views: Views) -> dict[Reading, list[Views]]:
    """The views by each reading; several where it is not known which of them it would be."""
    hand, target = views.outer, views.camera_from_target
    readings = {
        Reading.HAND_INVERTED: [Views(hand.inverse(), target)],
        Reading.TARGET_INVERTED: [Views(hand, target.inverse())],
        Reading.MIRRORED: [Views(hand, _mirrored(target))],
        Reading.HAND_TURNED_BACK: [Views(each, target) for each in _turned_back(hand)],
        Reading.TARGET_TURNED_BACK: [Views(hand, each) for each in _turned_back(target)],
        Reading.HAND_W_FIRST: [Views(each, target) for each in _reordered(hand)],
        Reading.TARGET_W_FIRST: [Views(hand, each) for each in _reordered(target)],
        Reading.BOTH_W_FIRST: [Views(a, b) for a in _reordered(hand) for b in _reordered(target)],
    }
    # a few metres may be metres; shrinking them would hide residuals, not explain them
    if _extent(hand) > 20.0:
        readings[Reading.HAND_MILLIMETRES] = [Views(_scaled(hand, 0.001), target)]
        readings[Reading.HAND_CENTIMETRES] = [Views(_scaled(hand, 0.01), target)]
    if _extent(target) > 20.0:
        readings[Reading.TARGET_MILLIMETRES] = [Views(hand, _scaled(target, 0.001))]
        readings[Reading.TARGET_CENTIMETRES] = [Views(hand, _scaled(target, 0.01))]
    return readings


def _extent(poses: Poses) -> float:
    """The typical distance from the origin, m."""
    return float(np.median(np.linalg.norm(poses.positions, axis=1)))


def _scaled(poses: Poses, factor: float) -> Poses:
    return Poses(poses.rotations, poses.positions * factor)


def _mirrored(poses: Poses) -> Poses:
    """In a mirror, or a frame that is left-handed; which axis is turned makes no difference."""
    mirror = np.diag([-1.0, 1.0, 1.0])
    return Poses(mirror @ poses.rotations @ mirror, poses.positions @ mirror)


def _turned_back(poses: Poses) -> list[Poses]:
    """The poses with inverse rotations; the file may have held them or their inverse."""
    turned = poses.inverse()
    return [
        Poses(np.swapaxes(poses.rotations, -1, -2), poses.positions),
        Poses(np.swapaxes(turned.rotations, -1, -2), turned.positions).inverse(),
    ]


def _reordered(poses: Poses) -> list[Poses]:
    """The poses if w was first in the file; the file may have held them or their inverse."""
    turned = poses.inverse()
    return [_w_first(poses), _w_first(turned).inverse()]


def _w_first(poses: Poses) -> Poses:
    """X y z w, as they were read, were w x y z."""
    w, x, y, z = quaternions(poses.rotations).T
    return Poses(rotations_of_quaternions(np.stack([x, y, z, w], axis=1)), poses.positions)
