"""One tag in RGB-D pictures: corners from the colour picture, the pose from depth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage
from momantu_bt.service import Snapshot
from momantu_bt.tags import UNIT_CORNERS, USUAL_FAMILY, TagFamily
from momantu_skills.perception.tags.bundles import CORNER_SIGMA, common_error
from momantu_skills.perception.tags.covariances import difference, turned
from momantu_skills.perception.tags.depth import TagPlane, mean_depth, plane_of, rays
from momantu_skills.perception.tags.detector import find_tags

EDGE_TOLERANCE = 0.12
"""Largest relative difference between the measured and the given edge of the tag."""
FLOOR = 0.001
"""Least uncertainty of a measured position, m, whatever its misfit."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenTag:
    """camera_from_tag: x right and y up on the printed tag, z out of it, at its centre.

    misfit: root mean square distance of the measured corners from the fitted square's, m.
    covariance: (6, 6) of the pose, see `covariances`.
    """

    tag_id: int
    camera_from_tag: Transform
    misfit: float
    covariance: Array


def locate(image: CameraImage, tag_id: int, corners: Array, edge: float) -> SeenTag | None:
    """Pose of a tag with a black square `edge` m wide, from its corners (4, 2) in px and depth.

    The rays through the corners meet the plane of the tag's depth pixels in four points; the pose
    is the least-squares fit of a square to them (Kabsch 1976). This has no two-fold ambiguity. None
    if depth is missing or the tag is not of that size.
    """
    plane = plane_of(image, corners)
    if plane is None:
        return None
    points = _on_plane(corners, plane.scaled, image.intrinsics)
    sides = np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1)
    if not np.isfinite(sides).all() or float(np.abs(sides / edge - 1.0).max()) > EDGE_TOLERANCE:
        return None
    pose, misfit = _fit_square(points, edge)
    return SeenTag(tag_id, pose, misfit, _covariance(corners, plane, image.intrinsics, edge))


def _on_plane(corners: Array, scaled: Array, intrinsics: Array) -> Array:
    """Where the rays through corners (4, 2) meet the plane n / d (3,): (4, 3), m."""
    ways, length = rays(corners, intrinsics), float(np.linalg.norm(scaled))
    scale = (1.0 / length) / (ways @ (scaled / length))
    return np.asarray(ways * scale[:, None])


def _covariance(corners: Array, plane: TagPlane, intrinsics: Array, edge: float) -> Array:
    """Of the pose: from the noise of the corners and of the plane, through their derivatives."""
    measured = np.concatenate([corners.ravel(), plane.scaled])
    steps = np.concatenate([np.full(8, 1e-2), np.full(3, 1e-4 * np.linalg.norm(plane.scaled))])

    def pose(values: Array) -> Transform:
        points = _on_plane(values[:8].reshape(4, 2), values[8:], intrinsics)
        return _fit_square(points, edge)[0]

    columns = []
    for index, step in enumerate(steps):
        away = np.zeros(11)
        away[index] = step
        columns.append(difference(pose(measured - away), pose(measured + away)) / (2.0 * step))
    rows = np.column_stack(columns)
    noise = np.zeros((11, 11))
    noise[:8, :8] = CORNER_SIGMA**2 * np.eye(8)
    noise[8:, 8:] = plane.covariance + common_error(plane.scaled)
    return np.asarray(rows @ noise @ rows.T)


def _fit_square(points: Array, edge: float) -> tuple[Transform, float]:
    model = np.column_stack([UNIT_CORNERS * edge, np.zeros(4)])
    centre = points.mean(axis=0)
    u, _, vt = np.linalg.svd(model.T @ (points - centre))
    flip = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(vt.T @ u.T)))])
    rotation = vt.T @ flip @ u.T
    misfits = np.linalg.norm(model @ rotation.T + centre - points, axis=1)
    return Transform.from_rotation(rotation, centre), float(np.sqrt((misfits**2).mean()))


@dataclass(frozen=True, slots=True)
class TagSighting:
    """sigma: standard deviation of the position within the picture, m; stamp: s.

    covariance: (6, 6) of the pose, see `covariances`. Errors of the camera's own pose are in
    neither.
    """

    odom_from_tag: Transform
    sigma: float
    stamp: float
    covariance: Array


def search(
    snapshots: Sequence[Snapshot], tag_id: int, edge: float, family: TagFamily = USUAL_FAMILY
) -> tuple[set[int], TagSighting | None]:
    """Find the ids of all tags in pictures from one place, and the requested tag's pose.

    The pose is None if it cannot be measured. It belongs to the last picture's stamp.
    """
    last = snapshots[-1]
    tags = find_tags([each.image for each in snapshots], family)
    if tag_id not in tags:
        return set(tags), None
    image = last.image
    if len(snapshots) > 1:
        image = replace(image, depth=mean_depth([each.image.depth for each in snapshots]))
    seen = locate(image, tag_id, tags[tag_id], edge)
    if seen is None:
        return set(tags), None
    pose = last.odom_from_camera @ seen.camera_from_tag
    covariance = turned(seen.covariance, last.odom_from_camera.rotation)
    return set(tags), TagSighting(pose, max(FLOOR, seen.misfit), image.stamp, covariance)


def average(sightings: Sequence[TagSighting]) -> TagSighting:
    """Average several poses: weights 1/sigma2, rotation from the mean of their quaternions.

    The resulting sigma adds the scatter of the positions to the sightings' own sigmas; errors
    common to all pictures, such as the camera's mounting, are not included. The covariance is the
    mean one, as most of a corner's error is the same in all pictures from one place.
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
    covariance = sum(w * s.covariance for w, s in zip(weights, sightings, strict=True))
    return TagSighting(Transform(mean, quaternion), sigma, sightings[-1].stamp, covariance)
