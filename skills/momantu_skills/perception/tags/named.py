"""A tag or bundle that the site knows by its name, in pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from momantu_bt.service import Snapshot
from momantu_bt.tags import TagBundle
from momantu_skills.perception.tags.covariances import turned
from momantu_skills.perception.tags.recognise import recognise
from momantu_skills.perception.tags.single import FLOOR, TagSighting


def search(
    snapshots: Sequence[Snapshot], name: str, tags: Mapping[str, TagBundle], refused: list[str]
) -> tuple[set[int], TagSighting | None]:
    """Find the ids of all tags of its family in pictures from one place, and a bundle's pose.

    refused: gets the reason where it shows without a usable pose. tags: all that the site knows.
    """
    wanted = tags[name]
    family = {key: each for key, each in tags.items() if each.family == wanted.family}
    shown = recognise([each.image for each in snapshots], family)
    ids = {each.tag_id for each in shown.detections}
    found, last = shown.named(name), snapshots[-1]
    if found is None:
        refused += [shown.refused[name]] if name in shown.refused else []
        return ids, None
    covariance = turned(found.pose.covariance, last.odom_from_camera.rotation)
    sigma = max(FLOOR, float(np.sqrt(np.trace(covariance[:3, :3]))))
    pose = last.odom_from_camera @ found.pose.camera_from_bundle
    return ids, TagSighting(pose, sigma, last.image.stamp, covariance)
