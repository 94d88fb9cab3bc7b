"""A first estimate that wrong views do not spoil: many tries with three views each.

The closed form for three views is that of Park and Martin (1994): the rotation aligns the axes of
relative rotations, the position is linear. Tries are judged by the median over all views, so that
less than half of the views may be wrong.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.calibration.hand_eye.views import Mounting, Views
from momantu_skills.calibration.poses import (
    Indices,
    Poses,
    angles,
    nearest_rotations,
    rotation_vectors,
)

ROTATION_NOISE = 0.005
POSITION_NOISE = 0.0015
"""Usual noise of a target's pose, rad and m: only their ratio matters, to compare tries."""
_TRIES = 800
_JUDGED = 200
_MOST_VIEWS = 60
"""So many of the views judge a try."""


@dataclass(frozen=True, slots=True)
class Start:
    """A first estimate; score: median over the views of the squared residual in units of noise."""

    mounting: Mounting
    score: float


def starts(views: Views, rng: np.random.Generator, count: int = 2) -> list[Start]:
    """The best of many tries, the best one first; empty if no three views allow one."""
    triples = _triples(len(views), rng)
    eye, quality = _solve(views, triples)
    keep = np.argsort(-quality, kind="stable")[:_JUDGED]
    keep = keep[quality[keep] > 1e-9]
    if not len(keep):
        return []
    eye, triples = eye[keep], triples[keep]
    target = _targets(views, eye, triples)
    chosen = np.sort(rng.permutation(len(views))[:_MOST_VIEWS])
    scores = _scores(views[chosen], eye, target)
    best = np.argsort(scores, kind="stable")[:count]
    return [Start(Mounting(eye.transform(i), target.transform(i)), float(scores[i])) for i in best]


def _triples(count: int, rng: np.random.Generator) -> Indices:
    """Different triples of views: all of them if there are few, else random ones; (K, 3)."""
    if count <= 20:
        every = np.array(list(itertools.combinations(range(count), 3)))
        return np.asarray(every[rng.permutation(len(every))[:_TRIES]])
    drawn = np.sort(rng.integers(0, count, (_TRIES, 3)), axis=1)
    return np.asarray(drawn[(drawn[:, 0] < drawn[:, 1]) & (drawn[:, 1] < drawn[:, 2])])


def _solve(views: Views, triples: Indices) -> tuple[Poses, Array]:
    """The eye (K) by each triple (K, 3), and how well each triple determines it (K,), rad."""
    first, second = triples[:, [0, 0, 1]], triples[:, [1, 2, 2]]
    hand = views.outer[second].inverse() @ views.outer[first]
    seen = views.camera_from_target[second] @ views.camera_from_target[first].inverse()
    turns, turns_seen = rotation_vectors(hand.rotations), rotation_vectors(seen.rotations)
    rotations = nearest_rotations(np.einsum("kmi,kmj->kij", turns, turns_seen))
    quality = np.linalg.svd(turns, compute_uv=False)[:, 1].astype(float)
    rows = (hand.rotations - np.eye(3)).reshape(-1, 9, 3)
    moved = np.einsum("kij,kmj->kmi", rotations, seen.positions) - hand.positions
    square = np.einsum("kri,krj->kij", rows, rows) + 1e-12 * np.eye(3)
    side = np.einsum("kri,kr->ki", rows, moved.reshape(-1, 9))
    return Poses(rotations, np.linalg.solve(square, side[..., None])[..., 0]), quality


def _targets(views: Views, eye: Poses, triples: Indices) -> Poses:
    """The target (K) by each try's own three views."""
    spread = Poses(eye.rotations[:, None], eye.positions[:, None])
    each = views.outer[triples] @ spread @ views.camera_from_target[triples]
    return Poses(nearest_rotations(each.rotations.sum(axis=1)), each.positions.mean(axis=1))


def _scores(views: Views, eye: Poses, target: Poses) -> Array:
    """The score (K,) of each try."""
    spread = Poses(eye.rotations[:, None], eye.positions[:, None])
    found = views.outer @ spread @ views.camera_from_target
    turned = angles(np.swapaxes(found.rotations, -1, -2) @ target.rotations[:, None])
    away = np.linalg.norm(found.positions - target.positions[:, None], axis=-1)
    return np.asarray(
        np.median((turned / ROTATION_NOISE) ** 2 + (away / POSITION_NOISE) ** 2, axis=1)
    )
