"""A tag's pose in odom from one or several pictures, and how sure it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Transform
from momantu_skills.perception.tags import find_tags, locate
from momantu_skills.perception.views import Snapshot

FLOOR = 0.001
"""m; no sighting is surer than this, whatever its misfit says."""


@dataclass(frozen=True, slots=True)
class TagSighting:
    """sigma: standard uncertainty of the position within the picture, m; stamp: s."""

    odom_from_tag: Transform
    sigma: float
    stamp: float


def search(snapshot: Snapshot, tag_id: int, edge: float) -> tuple[set[int], TagSighting | None]:
    """Ids of all tags in a picture, and where the asked one is, when it can be measured."""
    tags = find_tags(snapshot.image)
    if tag_id not in tags:
        return set(tags), None
    seen = locate(snapshot.image, tag_id, tags[tag_id], edge)
    if seen is None:
        return set(tags), None
    pose = snapshot.odom_from_camera @ seen.camera_from_tag
    return set(tags), TagSighting(pose, max(FLOOR, seen.misfit), snapshot.image.stamp)


def average(sightings: Sequence[TagSighting]) -> TagSighting:
    """One pose of several: weighted by 1/sigma2, turned to the mean of their quaternions.

    Its sigma adds the scatter of the positions to what the sightings say themselves; errors that
    all pictures share, such as the camera's mounting, are not in it.
    """
    positions = np.array([s.odom_from_tag.position for s in sightings])
    weights = np.array([1.0 / s.sigma**2 for s in sightings])
    weights /= weights.sum()
    mean = weights @ positions
    reference = sightings[-1].odom_from_tag.quaternion
    turns = [s.odom_from_tag.quaternion for s in sightings]
    quaternion = sum(
        w * math.copysign(1.0, float(q @ reference)) * q
        for w, q in zip(weights, turns, strict=True)
    )
    scatter = float(weights @ ((positions - mean) ** 2).sum(axis=1))
    own = float((weights**2) @ np.array([s.sigma**2 for s in sightings]))
    sigma = math.sqrt(own + scatter / len(sightings))
    return TagSighting(Transform(mean, quaternion), sigma, sightings[-1].stamp)
