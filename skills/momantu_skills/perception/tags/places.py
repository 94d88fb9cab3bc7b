"""Where the camera is in the map, from all tags in its picture whose places are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage
from momantu_bt.tags import TagBundle
from momantu_skills.perception.tags.bundles import Seen, TagsDisagreeError, pose_of
from momantu_skills.perception.tags.covariances import inverted
from momantu_skills.perception.tags.depth import mean_depth, plane_of
from momantu_skills.perception.tags.detector import find_all


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """map_from_camera: None if no tag tells it; then `unusable` says why, if any showed.

    covariance: (6, 6), in the map's axes. ids: of all tags that showed; used: of those that count.
    """

    map_from_camera: Transform | None
    covariance: Array
    ids: tuple[int, ...]
    used: tuple[int, ...]
    stamp: float
    unusable: str = ""


def place_of(images: Sequence[CameraImage], known: Mapping[str, TagBundle]) -> Place:
    """Estimate the camera's place from pictures from one place.

    All tags count as one bundle in the map, so one that hangs elsewhere, or was misread, does not
    count where two others agree. known: with their places.
    """
    image = images[-1]
    if len(images) > 1:
        image = replace(image, depth=mean_depth([each.depth for each in images]))
    families = sorted({bundle.family for bundle in known.values()})
    detections = find_all(images, families)
    ids = tuple(each.tag_id for each in detections)
    seen = [
        Seen(
            replace(plate, bundle_from_tag=bundle.map_from_bundle @ plate.bundle_from_tag),
            each.corners,
            plane_of(image, each.corners),
        )
        for bundle in known.values()
        if bundle.map_from_bundle is not None
        for plate in bundle.plates
        for each in detections
        if each.key == (bundle.family, plate.tag_id)
    ]
    nothing = Place(None, np.zeros((6, 6)), ids, (), image.stamp)
    if not seen:
        return nothing
    try:
        pose = pose_of(seen, image.intrinsics)
    except TagsDisagreeError as error:
        return replace(nothing, unusable=f"{error}: do they hang where the site says?")
    if pose is None:
        edges = ", ".join(f"{each.plate.tag_id} {each.plate.edge:g} m" for each in seen)
        return replace(nothing, unusable=f"depth denies the edges that the site says: {edges}")
    return Place(
        pose.camera_from_bundle.inverse(),
        inverted(pose.covariance, pose.camera_from_bundle),
        ids,
        tuple(each.plate.tag_id for each in pose.used),
        image.stamp,
    )
