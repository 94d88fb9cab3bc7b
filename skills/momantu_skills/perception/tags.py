"""AprilTags in RGB-D pictures: corners from the colour picture, the pose from depth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pyapriltags
from numpy.typing import NDArray

from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import CameraImage
from momantu_bt.service import Snapshot
from momantu_skills.perception.light import levels, lift_of, light_of

FAMILY = "tag36h11"
PIXEL_CENTRE = 0.5
"""Pixel coordinate of the first pixel's centre, px: 0.5 in the tag library, 0 in the pinhole
matrices here."""
LEAST_MARGIN = 15.0
"""Decision margin of the decoded bits below which a tag is ignored."""
WRONG_BITS = 1
"""Most bits of a tag that may be wrong in a clear picture; in a lifted or averaged one, none."""
EDGE_TOLERANCE = 0.12
"""Largest relative difference between the measured and the given edge of the tag."""
LEAST_DEPTHS = 30
"""Fewest depth pixels on a tag for fitting its plane."""
PLANE_OUTLIER = 3.0
"""Multiple of the median residual above which a depth pixel is left out of the plane."""
UNIT_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
"""A tag's corners in the library's order, x right and y up on the printed tag, in edge lengths."""


FLOOR = 0.001
"""Least uncertainty of a measured position, m, whatever its misfit."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenTag:
    """camera_from_tag: x right and y up on the printed tag, z out of it, at its centre.

    misfit: root mean square distance of the measured corners from the fitted square's, m.
    """

    tag_id: int
    camera_from_tag: Transform
    misfit: float


def find_tags(images: Sequence[CameraImage]) -> dict[int, Array]:
    """Corners (4, 2) in px of every tag in pictures from one place, by id.

    The larger one if an id repeats. Several pictures are averaged. Dim ones are searched in lifted
    light too, as the library counts light in whole levels of 255.
    """
    grays = [np.ascontiguousarray(image.color[..., 1]) for image in images]
    found = tags_in(grays[0]) if len(grays) == 1 else {}
    mean = light_of(grays)
    if len(grays) > 1:
        found = _detect(levels(mean), wrong_bits=0)
    lift = lift_of(mean)
    return found if lift is None else {**_detect(levels(mean, lift), wrong_bits=0), **found}


def tags_in(gray: NDArray[np.uint8]) -> dict[int, Array]:
    """Corners (4, 2) in px of every tag in a gray picture (H, W), by id.

    Its gamma is reversed, because otherwise white bleeds into a tag's black border and the tag
    seems 1.6 % farther away.
    """
    return _detect(levels(light_of([gray])), WRONG_BITS)


def _detect(light: NDArray[np.uint8], wrong_bits: int) -> dict[int, Array]:
    found: dict[int, Array] = {}
    for detection in _detector().detect(np.ascontiguousarray(light)):
        if detection.hamming > wrong_bits or detection.decision_margin < LEAST_MARGIN:
            continue
        corners = np.asarray(detection.corners, dtype=np.float64) - PIXEL_CENTRE
        other = found.get(int(detection.tag_id))
        if other is None or _area(corners) > _area(other):
            found[int(detection.tag_id)] = corners
    return found


def locate(image: CameraImage, tag_id: int, corners: Array, edge: float) -> SeenTag | None:
    """Pose of a tag with a black square `edge` m wide, from its corners (4, 2) in px and depth.

    The rays through the corners meet the plane of the tag's depth pixels in four points; the pose
    is the least-squares fit of a square to them (Kabsch 1976). This has no two-fold ambiguity. None
    if depth is missing or the tag is not of that size.
    """
    plane = _plane_of(image, corners)
    if plane is None:
        return None
    rays = _rays(corners, image.intrinsics)
    scale = plane[1] / (rays @ plane[0])
    points = rays * scale[:, None]
    sides = np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1)
    if not np.isfinite(sides).all() or float(np.abs(sides / edge - 1.0).max()) > EDGE_TOLERANCE:
        return None
    pose, misfit = _fit_square(points, edge)
    return SeenTag(tag_id, pose, misfit)


def _rays(pixels: Array, intrinsics: Array) -> Array:
    """(n, 3) directions with z = 1 through pixels (n, 2)."""
    x = (pixels[:, 0] - intrinsics[0, 2]) / intrinsics[0, 0]
    y = (pixels[:, 1] - intrinsics[1, 2]) / intrinsics[1, 1]
    return np.column_stack([x, y, np.ones(len(pixels))])


def _plane_of(image: CameraImage, corners: Array) -> tuple[Array, float] | None:
    """Unit normal (3,) and distance n.p of the tag's plane in the optical frame.

    On a plane 1/z is linear in the pixel coordinates. Its noise is uniform there, because depth
    noise grows with z2. Therefore the fit is plain least squares, repeated once without outliers.
    """
    pixels = _pixels_within(image.depth.shape, corners)
    z = image.depth[pixels[:, 1], pixels[:, 0]].astype(np.float64)
    pixels, z = pixels[z > 0], z[z > 0]
    if len(z) < LEAST_DEPTHS:
        return None
    rays, inverse = _rays(pixels.astype(np.float64), image.intrinsics), 1.0 / z
    scaled = np.linalg.lstsq(rays, inverse, rcond=None)[0]
    residuals = np.abs(rays @ scaled - inverse)
    kept = residuals <= PLANE_OUTLIER * max(float(np.median(residuals)), 1e-6)
    scaled = np.linalg.lstsq(rays[kept], inverse[kept], rcond=None)[0]
    length = float(np.linalg.norm(scaled))
    return (np.asarray(scaled / length), 1.0 / length) if length > 1e-9 else None


def _pixels_within(shape: tuple[int, ...], corners: Array) -> NDArray[np.int64]:
    """Whole pixels (n, 2) as (column, row) inside a convex quadrilateral."""
    low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil(corners.max(axis=0)).astype(int), [shape[1] - 1, shape[0] - 1])
    columns, rows = np.meshgrid(
        np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1), indexing="xy"
    )
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    turn = np.ones(len(pixels), dtype=bool)
    sign = math.copysign(1.0, _signed_area(corners))
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along, relative = end - start, pixels - start
        turn &= sign * (along[0] * relative[:, 1] - along[1] * relative[:, 0]) >= 0.0
    return np.asarray(pixels[turn])


def _fit_square(points: Array, edge: float) -> tuple[Transform, float]:
    model = np.column_stack([UNIT_CORNERS * edge, np.zeros(4)])
    centre = points.mean(axis=0)
    u, _, vt = np.linalg.svd(model.T @ (points - centre))
    flip = np.diag([1.0, 1.0, float(np.sign(np.linalg.det(vt.T @ u.T)))])
    rotation = vt.T @ flip @ u.T
    misfits = np.linalg.norm(model @ rotation.T + centre - points, axis=1)
    return Transform.from_rotation(rotation, centre), float(np.sqrt((misfits**2).mean()))


def _signed_area(corners: Array) -> float:
    x, y = corners[:, 0], corners[:, 1]
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _area(corners: Array) -> float:
    return abs(_signed_area(corners))


@lru_cache(maxsize=1)
def _detector() -> pyapriltags.Detector:
    return pyapriltags.Detector(families=FAMILY, nthreads=1, quad_decimate=1.0)


@dataclass(frozen=True, slots=True)
class TagSighting:
    """sigma: standard deviation of the position within the picture, m; stamp: s."""

    odom_from_tag: Transform
    sigma: float
    stamp: float


def search(
    snapshots: Sequence[Snapshot], tag_id: int, edge: float
) -> tuple[set[int], TagSighting | None]:
    """Find the ids of all tags in pictures from one place, and the requested tag's pose.

    The pose is None if it cannot be measured. It belongs to the last picture's stamp.
    """
    last = snapshots[-1]
    tags = find_tags([each.image for each in snapshots])
    if tag_id not in tags:
        return set(tags), None
    image = last.image
    if len(snapshots) > 1:
        image = replace(image, depth=_mean_depth([each.image.depth for each in snapshots]))
    seen = locate(image, tag_id, tags[tag_id], edge)
    if seen is None:
        return set(tags), None
    pose = last.odom_from_camera @ seen.camera_from_tag
    return set(tags), TagSighting(pose, max(FLOOR, seen.misfit), image.stamp)


def _mean_depth(depths: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Mean of the measured values of each pixel; 0 where nothing was measured."""
    measured = np.sum([depth > 0.0 for depth in depths], axis=0)
    total = np.sum(depths, axis=0, dtype=np.float64)
    return np.asarray(total / np.maximum(measured, 1), dtype=np.float32)


def average(sightings: Sequence[TagSighting]) -> TagSighting:
    """Average several poses: weights 1/sigma2, rotation from the mean of their quaternions.

    The resulting sigma adds the scatter of the positions to the sightings' own sigmas; errors
    common to all pictures, such as the camera's mounting, are not included.
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
