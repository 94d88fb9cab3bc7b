"""Loops in three dimensions: two places on the way that show the same surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.mapping.three_d.config import CloudConfig
from momantu_skills.mapping.three_d.registration import Surface, laid_on

MOST_TURN = 0.2
"""Turn by which a loop may correct the guess, rad."""


def candidate(
    ways: Sequence[float], poses: Sequence[Transform], off: float, config: CloudConfig
) -> int | None:
    """The number of the nearest earlier place that may show what the newest one shows.

    ways: (n,) way until each place, m. off: how far the newest may be from where it is thought, m.
    """
    newest = poses[-1].position
    early = [number for number, way in enumerate(ways) if ways[-1] - way > config.loop_way]
    if not early:
        return None
    apart = np.array([np.linalg.norm(poses[number].position - newest) for number in early])
    best = int(np.argmin(apart))
    return early[best] if apart[best] < config.loop_near + off else None


def closed(
    older: Surface, newer: Surface, guess: Transform, off: float, config: CloudConfig
) -> Transform | None:
    """`older_from_newer` if both show the same place. guess: the same, off by up to `off` m."""
    coarse = laid_on(older, newer, guess, max(off, config.match_distance))
    if coarse is None:
        return None
    fine = laid_on(older, newer, coarse.pose, config.loop_distance)
    if fine is None or fine.share < config.loop_share:
        return None
    moved = float(np.linalg.norm(fine.pose.position - guess.position))
    return fine.pose if moved < off and fine.pose.angle_to(guess) < MOST_TURN else None


def around(
    number: int, points: Sequence[Array], poses: Sequence[Transform], config: CloudConfig
) -> Surface:
    """What was seen from a place and its neighbours on the way, in the frame of the place.

    points: (n, 3) of each place, in its own frame.
    """
    low, high = max(0, number - config.loop_around), number + config.loop_around + 1
    back = poses[number].inverse()
    seen = [(back @ poses[each]).apply(points[each]) for each in range(low, min(high, len(points)))]
    return Surface.of(np.concatenate(seen), config.voxel, config.neighbours)
