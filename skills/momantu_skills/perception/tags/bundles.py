"""The pose of a bundle of tags from all its corners, with its covariance.

Non-linear least squares over the corners in the picture and, where depth was measured, the planes
of the tags. A tag that contradicts the others does not count. A flat bundle has two poses that look
almost alike (Collins and Bartoli 2014, Infinitesimal plane-based pose estimation); what the data do
not tell apart is in the covariance.

Covariances are as in `covariances`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_bt.tags import TagPlate
from momantu_skills.perception.tags.covariances import at_arm, difference, moved, skew
from momantu_skills.perception.tags.depth import TagPlane

CORNER_SIGMA = 0.11
"""Standard deviation of a corner's coordinate, px, measured on rendered views."""
PRIOR = 8
"""How many residuals that figure counts for, beside the picture's own residuals."""
PLANE_SIGMA = (0.005, 0.005)
"""Standard deviations of what a depth camera measures wrong of a whole plane: its tilt, rad, and
its distance, as a share of it. They do not average out over the pixels."""
MISREAD = 4.0
"""Root mean square error of a tag's corners, px, above which it contradicts the bundle."""
WIDEST = 64.0
"""With such an error in place of it the search for the pose begins, px."""
HYPOTHESES = 6
"""The pose is searched from each of so many tags, the largest ones."""
STEPS, NARROWING = 12, 0.6
"""Gauss-Newton steps of a search, and the factor of the allowed error from one to the next."""
ROUNDS = 3
"""Times at most that the tags which count are chosen anew."""
CONVERGED = 1e-9
"""m and rad."""
SIZE_TOLERANCE = 0.12
"""Largest relative difference between distances by the corners and by depth: else the tag's edge
is not what it is said to be."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A tag of a bundle in a picture. corners: (4, 2), px; plane: None without depth."""

    plate: TagPlate
    corners: Array
    plane: TagPlane | None = None


@dataclass(frozen=True, slots=True, eq=False)
class BundlePose:
    """The estimate.

    camera_from_bundle: in the optical frame. covariance: (6, 6). used: the tags that
    count; misread: those that contradict them; wrong_size: those whose edge depth denies. error:
    root mean square of the corners that count, px. doubt: the probability that the bundle is in the
    other of its two poses.
    """

    camera_from_bundle: Transform
    covariance: Array
    used: tuple[Seen, ...]
    misread: tuple[Seen, ...]
    wrong_size: tuple[Seen, ...]
    error: float
    doubt: float


class TagsDisagreeError(ValueError):
    """The tags contradict each other, and no majority tells which of them are right."""


def pose_of(seen: Sequence[Seen], intrinsics: Array) -> BundlePose | None:
    """Estimate where a bundle is; None if depth denies the edges of all its tags.

    Args:
        seen: tags of the bundle in one picture; an id that shows twice is there twice.
        intrinsics: pinhole matrix (3, 3).

    Raises:
        TagsDisagreeError: as many tags contradict each other as agree.
    """
    # about the middle of the tags, because turns about a far origin are hardly linear
    middle = np.mean([each.plate.bundle_from_tag.position for each in seen], axis=0)
    centred = [_shifted(each, -middle) for each in seen]
    found = _about_middle(centred, intrinsics)
    if found is None:
        return None
    given = {id(each): own for each, own in zip(centred, seen, strict=True)}
    arm = -(found.camera_from_bundle.rotation @ middle)
    return replace(
        found,
        camera_from_bundle=found.camera_from_bundle @ Transform(-middle),
        covariance=at_arm(found.covariance, arm),
        used=tuple(given[id(each)] for each in found.used),
        misread=tuple(given[id(each)] for each in found.misread),
        wrong_size=tuple(given[id(each)] for each in found.wrong_size),
    )


def _shifted(seen: Seen, shift: Array) -> Seen:
    """The same tag in a bundle whose origin is elsewhere."""
    plate = replace(seen.plate, bundle_from_tag=Transform(shift) @ seen.plate.bundle_from_tag)
    return replace(seen, plate=plate)


def _about_middle(seen: Sequence[Seen], intrinsics: Array) -> BundlePose | None:
    """As `pose_of`, for a bundle whose origin is amid its tags."""
    fine, wrong_size = _by_size(seen, intrinsics)
    if not fine:
        return None
    pose, fits = _consensus(fine, intrinsics)
    for _ in range(ROUNDS):
        used = [each for each, good in zip(fine, fits, strict=True) if good]
        first = _settled(used, intrinsics, pose)
        second = _settled(used, intrinsics, _mirrored(used, first.pose))
        if second.cost < first.cost:
            first, second = second, first
        before, fits = fits, _fits(fine, intrinsics, first.pose)[0]
        if fits == before or not any(fits):
            break
        pose = first.pose
    misread = tuple(each for each in fine if each not in used)
    if len(fine) > 1 and len(used) <= len(misread):
        ids = ", ".join(str(each.plate.tag_id) for each in fine)
        raise TagsDisagreeError(f"the tags {ids} do not fit together")
    covariance, doubt = _mixture(first, second)
    return BundlePose(
        first.pose, covariance, tuple(used), misread, tuple(wrong_size), first.error, doubt
    )


def _by_size(seen: Sequence[Seen], intrinsics: Array) -> tuple[list[Seen], list[Seen]]:
    """Those whose edge depth does not deny, and the others."""
    fine: list[Seen] = []
    wrong: list[Seen] = []
    for each in seen:
        (wrong if _denied(each, intrinsics) else fine).append(each)
    return fine, wrong


def _denied(seen: Seen, intrinsics: Array) -> bool:
    if seen.plane is None:
        return False
    ways = np.column_stack([seen.corners, np.ones(4)]) @ np.linalg.inv(intrinsics).T
    points = ways / (ways @ seen.plane.scaled)[:, None]
    sides = np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1)
    off = np.abs(sides / seen.plate.edge - 1.0)
    return not bool(np.isfinite(sides).all() and off.max() <= SIZE_TOLERANCE)


# the search for a pose that most tags agree on


def _consensus(seen: Sequence[Seen], intrinsics: Array) -> tuple[Transform, list[bool]]:
    """The pose on which the most tags agree, the largest area of them, and which these are."""
    corners = _Corners.of(seen, intrinsics)
    sizes = [_edge_px(each) for each in seen]
    largest = sorted(range(len(seen)), key=lambda i: -sizes[i])[:HYPOTHESES]
    best: tuple[tuple[int, float], Transform, list[bool]] | None = None
    for index in largest:
        for start in _planar(seen[index], intrinsics):
            for pose in (start, _descend(corners, start)) if len(seen) > 1 else (start,):
                fits, misfit = _fits(seen, intrinsics, pose)
                score = (sum(fits), -misfit)
                if best is None or score > best[0]:
                    best = score, pose, fits
        if best is not None and best[0][0] == len(seen):
            break  # no other tag could find more
    assert best is not None
    _, pose, fits = best
    return (pose, fits) if any(fits) else (pose, [len(seen) == 1] * len(seen))


def _fits(seen: Sequence[Seen], intrinsics: Array, pose: Transform) -> tuple[list[bool], float]:
    """Which tags agree with a pose; the sum of squared errors, px2, each at most `MISREAD`."""
    errors = [
        math.inf if _faces_away(each, pose) else float(error)
        for each, error in zip(seen, _Corners.of(seen, intrinsics).errors(pose), strict=True)
    ]
    return [error <= MISREAD for error in errors], sum(min(e, MISREAD) ** 2 for e in errors)


def _edge_px(seen: Seen) -> float:
    return float(np.linalg.norm(seen.corners - np.roll(seen.corners, -1, axis=0), axis=1).mean())


def _planar(seen: Seen, intrinsics: Array) -> list[Transform]:
    """Both poses of the bundle by one tag alone."""
    flat = TagPlate(seen.plate.tag_id, seen.plate.edge).corners()
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        flat, seen.corners, intrinsics, None, flags=cv2.SOLVEPNP_IPPE
    )
    found = []
    for turn, shift in zip(turns, shifts, strict=True):
        camera_from_tag = Transform.from_rotation(cv2.Rodrigues(turn)[0], shift.ravel())
        found.append(camera_from_tag @ seen.plate.bundle_from_tag.inverse())
    return found


def _descend(corners: _Corners, pose: Transform) -> Transform:
    """Gauss-Newton on all corners; tags whose error is beyond a narrowing bound count little."""
    allowed = WIDEST
    for _ in range(STEPS):
        rows, left = corners.rows(pose)
        weights = 1.0 / (1.0 + (left**2).sum(axis=1) / 4.0 / allowed**2) ** 2
        weighted = rows * weights[:, None, None]
        square = np.einsum("nij,nik->jk", weighted, rows)
        slope = np.einsum("nij,ni->j", weighted, left)
        pose = moved(pose, np.asarray(np.linalg.lstsq(square, slope, rcond=None)[0]))
        allowed = max(MISREAD / 2, allowed * NARROWING)
    return pose


def _faces_away(seen: Seen, pose: Transform) -> bool:
    """Whether a tag would show its back, or be behind the camera."""
    tag = pose @ seen.plate.bundle_from_tag
    return bool(tag.position[2] <= 0.0 or tag.rotation[:, 2] @ tag.position >= 0.0)


# the estimate


@dataclass(frozen=True, slots=True, eq=False)
class _Corners:
    """The corners of some tags. points: in the bundle (n, 4, 3), m. pixels: (n, 4, 2)."""

    points: Array
    pixels: Array
    intrinsics: Array

    @classmethod
    def of(cls, seen: Sequence[Seen], intrinsics: Array) -> _Corners:
        """Those of tags in a picture."""
        points = np.stack([each.plate.corners() for each in seen])
        return cls(points, np.stack([each.corners for each in seen]), intrinsics)

    def rows(self, pose: Transform) -> tuple[Array, Array]:
        """Derivatives (n, 8, 6) of the corners by the pose, and what is left (n, 8), px."""
        arms = self.points @ pose.rotation.T
        points = arms + pose.position
        z = np.where(np.abs(points[..., 2]) < 1e-6, 1e-6, points[..., 2])
        fx, fy = self.intrinsics[0, 0], self.intrinsics[1, 1]
        x, y = points[..., 0] / z, points[..., 1] / z
        rows = np.zeros((*z.shape, 2, 6))
        rows[..., 0, 0], rows[..., 0, 2] = fx / z, -fx * x / z
        rows[..., 1, 1], rows[..., 1, 2] = fy / z, -fy * y / z
        # a rotation by w about the camera's axes moves a point by w x arm
        a, b, c = arms[..., None, 0], arms[..., None, 1], arms[..., None, 2]
        u, v, w = rows[..., 0], rows[..., 1], rows[..., 2]
        rows[..., 3], rows[..., 4], rows[..., 5] = w * b - v * c, u * c - w * a, v * a - u * b
        middle = self.intrinsics[:2, 2]
        left = self.pixels - np.stack([fx * x, fy * y], axis=-1) - middle
        return rows.reshape(len(z), 8, 6), left.reshape(len(z), 8)

    def errors(self, pose: Transform) -> Array:
        """Root mean square distance (n,) of each tag's corners from where they should be, px."""
        return np.asarray(np.sqrt((self.rows(pose)[1] ** 2).sum(axis=1) / 4.0))


@dataclass(frozen=True, slots=True, eq=False)
class _Settled:
    """A minimum. square: normal matrix (6, 6). cost: chi2. error: px. scale: of the variances."""

    pose: Transform
    square: Array
    cost: float
    error: float
    scale: float


def _settled(seen: Sequence[Seen], intrinsics: Array, pose: Transform) -> _Settled:
    """The minimum of the least squares that is next to a pose (Gauss-Newton, halved steps)."""
    corners = _Corners.of(seen, intrinsics)
    current = _normal(seen, corners, pose)
    for _ in range(4 * STEPS):
        step = np.asarray(np.linalg.lstsq(current[0], current[1], rcond=None)[0])
        for _ in range(6):
            there = moved(pose, step)
            following = _normal(seen, corners, there)
            if following[2] <= current[2]:
                break
            step = step / 2
        else:
            break
        pose, current = there, following
        if float(np.abs(step).max()) < CONVERGED:
            break
    square, _, cost, squares = current
    freedom = 8 * len(seen) - 6
    scale = (PRIOR + squares / CORNER_SIGMA**2) / (PRIOR + freedom)
    return _Settled(pose, square, cost, float(np.sqrt(squares / 4 / len(seen))), scale)


def _normal(
    seen: Sequence[Seen], corners: _Corners, pose: Transform
) -> tuple[Array, Array, float, float]:
    """Normal matrix (6, 6), right side (6,), chi2, and the sum of the corners' squares, px2."""
    all_rows, all_left = corners.rows(pose)
    rows, left = all_rows.reshape(-1, 6), all_left.ravel()
    square, slope = rows.T @ rows / CORNER_SIGMA**2, rows.T @ left / CORNER_SIGMA**2
    squares, cost = float(left @ left), 0.0
    for each in seen:
        if each.plane is not None:
            rows, left, weight = _plane_rows(each, each.plane, pose)
            square += rows.T @ weight @ rows
            slope += rows.T @ weight @ left
            cost += float(left @ weight @ left)
    return square, slope, cost + squares / CORNER_SIGMA**2, squares


def _plane_rows(seen: Seen, plane: TagPlane, pose: Transform) -> tuple[Array, Array, Array]:
    """Derivatives (3, 6) of a tag's plane by the pose, what is left (3,), its weight (3, 3)."""
    tag = pose @ seen.plate.bundle_from_tag
    normal, centre = tag.rotation[:, 2], tag.position
    distance = float(normal @ centre)
    scaled = normal / distance
    by_position = -np.outer(normal, normal) / distance**2
    arm = centre - pose.position
    # a rotation by w turns the normal by w x normal, and moves the centre by w x arm
    by_rotation = -skew(normal) / distance
    by_rotation -= np.outer(normal, np.cross(normal, centre) + np.cross(arm, normal)) / distance**2
    rows = np.hstack([by_position, by_rotation])
    weight = np.linalg.inv(plane.covariance + common_error(scaled))
    return rows, plane.scaled - scaled, np.asarray(weight)


def common_error(scaled: Array) -> Array:
    """Covariance (3, 3) of what depth measures wrong of a whole plane n / d; see `PLANE_SIGMA`."""
    tilt, share = PLANE_SIGMA
    along = np.outer(scaled, scaled)
    return np.asarray(share**2 * along + tilt**2 * (float(scaled @ scaled) * np.eye(3) - along))


# the second pose of what is flat


def _mirrored(seen: Sequence[Seen], pose: Transform) -> Transform:
    """Where the second pose is: the corners' plane mirrored in the line of sight.

    The plane is that of the bundle's corners that are seen.
    """
    points = np.concatenate([each.plate.corners() for each in seen])
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle)[2][2]
    sight = pose.apply(middle)
    sight = sight / np.linalg.norm(sight)
    axis = pose.rotation @ normal
    half = float(axis @ sight) * sight
    other = 2.0 * half - axis
    turn = _turning(axis, other)
    rotation = turn @ pose.rotation
    return Transform.from_rotation(rotation, pose.apply(middle) - rotation @ middle)


def _turning(one: Array, other: Array) -> Array:
    """The rotation (3, 3) that turns one unit vector into another by the shortest way."""
    axis = np.cross(one, other)
    sine, cosine = float(np.linalg.norm(axis)), float(one @ other)
    if sine < 1e-12:
        return np.eye(3)
    return np.asarray(cv2.Rodrigues(axis / sine * np.arctan2(sine, cosine))[0])


def _mixture(first: _Settled, second: _Settled) -> tuple[Array, float]:
    """The covariance about the first pose, and the probability of the second one."""
    own = np.asarray(first.scale * np.linalg.inv(first.square))
    apart = difference(first.pose, second.pose)
    if float(apart @ np.linalg.solve(own, apart)) < 1.0 or any(np.isnan(apart)):
        return own, 0.0  # the same minimum
    odds = float(np.exp(-0.5 * (second.cost - first.cost) / first.scale))
    doubt = odds / (1.0 + odds)
    other = second.scale * np.linalg.pinv(second.square)
    both = (1.0 - doubt) * own + doubt * (other + np.outer(apart, apart))
    return np.asarray(both), doubt
