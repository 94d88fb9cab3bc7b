"""Getting out of a posture that touches something, by a small motion."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.manipulation.collision import CollisionWorld
from momantu_skills.manipulation.model import Group

LIFTS = (0.02, 0.04, 0.08)
"""m the tip is lifted, the first thing tried: what is touched mostly lies below."""
RADII = (0.05, 0.1, 0.2, 0.35)
"""Scaled rad of random motions, tried from small to large."""
TRIES = 40
"""Random motions of each size."""


def escape(
    group: Group,
    start: Array,
    world: CollisionWorld,
    bare: CollisionWorld,
    random: np.random.Generator,
) -> Array | None:
    """Joints (k, n) from a touching `start` to a posture that is free in `world`, or None.

    On the way nothing new is touched in `bare`, the same world without margin: the motion only
    leaves contacts. First straight up, then small random motions of all joints.
    """
    allowed = set(bare.touching(start))
    for path in (*_lifts(group, start), *_wiggles(group, start, random)):
        if world.free(path[-1]) and all(set(bare.touching(q)) <= allowed for q in path):
            return path
    return None


def _lifts(group: Group, start: Array) -> list[Array]:
    paths = []
    for height in LIFTS:
        pose = group.tip_matrix(start)
        targets = np.repeat(pose[None], max(2, round(height / 0.01)), axis=0)
        targets[:, 2, 3] += np.linspace(0.0, height, len(targets) + 1)[1:]
        path, reached = group.trace(targets, start)
        if reached == len(targets):
            paths.append(np.vstack([start, path]))
    return paths


def _wiggles(group: Group, start: Array, random: np.random.Generator) -> list[Array]:
    paths = []
    for radius in RADII:
        for _ in range(TRIES):
            direction = random.normal(size=len(start))
            step = radius * direction / np.linalg.norm(direction) / group.scale
            end = np.clip(start + step, group.lower, group.upper)
            paths.append(start + np.linspace(0.0, 1.0, 5)[:, None] * (end - start))
    return paths
