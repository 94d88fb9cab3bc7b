"""A lens: focal lengths, centre and distortion, estimated from what pictures show of a board."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_skills.calibration.camera import tag_edges
from momantu_skills.calibration.camera.board import Board, Seen
from momantu_skills.calibration.errors import CalibrationError
from momantu_skills.calibration.models import Model
from momantu_skills.calibration.poses import Mask, Poses, rotations_of, turns_between

with lazily():
    import cv2

LEAST_PICTURES = 4
_LEAST_TURN = np.radians(5.0)
_OUTLIER = 3.0
_LEAST_OUTLIER = 0.1
"""A picture is wrong if its error is this many times the median, and at least so many pixels."""
_POINT = 5.0
_LEAST_POINT = 0.3
_MOST_POINTS = 0.25
"""So is a point, but if there are more than this share in a picture, they count: all may be off."""
_ROUNDS = 6
_STILL = 0.003
"""px; corners of tags are found if they are moved by less."""


ROS_MODEL = {
    Model.PINHOLE: "plumb_bob",
    Model.PINHOLE8: "rational_polynomial",
    Model.FISHEYE: "equidistant",
}
COEFFICIENTS = {Model.PINHOLE: 5, Model.PINHOLE8: 8, Model.FISHEYE: 4}


@dataclass(frozen=True, slots=True, eq=False)
class Lens:
    """The estimate. matrix: (3, 3), px. distortion: (4,), (5,) or (8,) in OpenCV's order.

    deviations: standard deviations (4 + C,) of fx, fy, cx, cy and the distortion. errors: root mean
    square error of each picture (N,), px. used: pictures (N,) that count. camera_from_board: (N).
    residuals: of each picture (P, 2), px. kept: of each picture (P,), which points count.
    """

    model: Model
    matrix: Array
    distortion: Array
    deviations: Array
    errors: Array
    used: Mask
    camera_from_board: Poses
    residuals: tuple[Array, ...]
    kept: tuple[Mask, ...]

    @property
    def counted(self) -> list[Array]:
        """The residuals that count, of the pictures that count."""
        rows = zip(self.residuals, self.kept, self.used, strict=True)
        return [each[points] for each, points, used in rows if used]

    @property
    def error(self) -> float:
        """Root mean square error of what counts, px."""
        return float(np.sqrt(np.mean((np.concatenate(self.counted) ** 2).sum(axis=1))))


def fit(board: Board, seen: Sequence[Seen], size: tuple[int, int], model: Model) -> Lens:
    """Estimate a lens; pictures and points that fit far worse than the others do not count.

    Args:
        board: the board.
        seen: what each picture shows of it, at least `LEAST_PICTURES`.
        size: width and height of the pictures, px.
        model: of the lens.

    Raises:
        CalibrationError: too few pictures are right, or all show the board from the same side.
    """
    used = np.ones(len(seen), dtype=bool)
    kept = [np.ones(len(each.indices), dtype=bool) for each in seen]
    moves = [np.zeros_like(each.pixels) for each in seen]
    for _ in range(_ROUNDS):
        if used.sum() < LEAST_PICTURES:
            raise CalibrationError(
                f"{used.sum()} pictures agree on a lens; at least {LEAST_PICTURES} are needed: is "
                f"the board flat, and {board} what the pictures show?"
            )
        rows = zip(seen, moves, strict=True)
        straight = [Seen(each.indices, each.pixels - move) for each, move in rows]
        matrix, distortion = _calibrated(board, _chosen(straight, used, kept), size, model)
        lens = _judged(board, straight, used, kept, matrix, distortion, model)
        most = max(_OUTLIER * float(np.median(lens.errors[used])), _LEAST_OUTLIER)
        before, used = (used, kept), lens.errors <= most
        kept = _near(lens)
        still = _bend(board, seen, lens, moves) < _STILL
        if still and (used == before[0]).all() and all(map(np.array_equal, kept, before[1])):
            break
    _check_turns(lens)
    return lens


def _bend(board: Board, seen: Sequence[Seen], lens: Lens, moves: list[Array]) -> float:
    """Set how far the lens bends the edges of tags, so that their corners were found elsewhere.

    moves: of each picture (P, 2) px. Returns the largest change, px, in pictures that count.
    """
    if board.kind != "aprilgrid":
        return 0.0
    largest = 0.0
    for k, each in enumerate(seen):
        corners = board.points()[each.indices].reshape(-1, 4, 3)
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
        pose = lens.camera_from_board[k]
        points = np.stack([corners, middles]).reshape(-1, 3)
        vector = np.asarray(cv2.Rodrigues(pose.rotations)[0], dtype=float).ravel()
        pixels = _projected(
            points, vector, pose.positions, lens.matrix, lens.distortion, lens.model
        )[0].reshape(2, -1, 4, 2)
        move = tag_edges.bent(pixels[0], pixels[1]).reshape(-1, 2)
        if lens.used[k]:
            largest = max(largest, float(np.abs(move - moves[k]).max()))
        moves[k] = move
    return largest


def _near(lens: Lens) -> list[Mask]:
    """Which points of each picture are not far off while the others fit."""
    off = [np.linalg.norm(each, axis=1) for each in lens.residuals]
    usual = np.median(np.linalg.norm(np.concatenate(lens.counted), axis=1))
    near = [each <= max(_POINT * float(usual), _LEAST_POINT) for each in off]
    return [each if each.mean() >= 1.0 - _MOST_POINTS else np.ones_like(each) for each in near]


def _chosen(seen: Sequence[Seen], used: Mask, kept: Sequence[Mask]) -> list[Seen]:
    rows = zip(seen, used, kept, strict=True)
    return [Seen(each.indices[points], each.pixels[points]) for each, w, points in rows if w]


def _calibrated(
    board: Board, seen: Sequence[Seen], size: tuple[int, int], model: Model
) -> tuple[Array, Array]:
    """OpenCV's estimate: matrix (3, 3) and distortion (C,)."""
    points = board.points()
    shape = (1, -1, 3), (1, -1, 2)
    objects: list[Any] = [points[each.indices].reshape(shape[0]) for each in seen]
    pixels: list[Any] = [each.pixels.reshape(shape[1]) for each in seen]
    found: Any
    try:
        if model is Model.FISHEYE:
            flags = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW
            found = cv2.fisheye.calibrate(
                objects, pixels, size, np.zeros((3, 3)), np.zeros(4), flags=flags
            )
        else:
            flags = cv2.CALIB_RATIONAL_MODEL if model is Model.PINHOLE8 else 0
            objects = [each.astype(np.float32) for each in objects]
            pixels = [each.astype(np.float32) for each in pixels]
            found = cv2.calibrateCamera(objects, pixels, size, None, None, flags=flags)
    except cv2.error as error:
        raise CalibrationError(
            f"no lens explains the pictures ({error.err}); tilt the board more, or try another "
            f"--model"
        ) from None
    return np.asarray(found[1]), np.asarray(found[2]).ravel()[: COEFFICIENTS[model]]


def _judged(
    board: Board,
    seen: Sequence[Seen],
    used: Mask,
    kept: Sequence[Mask],
    matrix: Array,
    distortion: Array,
    model: Model,
) -> Lens:
    """The lens with the residuals of all pictures and points, also those that did not count."""
    vectors, places, residuals, jacobians, counted = [], [], [], [], []
    for each, fine in zip(seen, kept, strict=True):
        points = board.points()[each.indices]
        vector, place = _placed(points[fine], each.pixels[fine], matrix, distortion, model)
        pixels, jacobian = _projected(points, vector, place, matrix, distortion, model)
        vectors.append(vector)
        places.append(place)
        residuals.append(each.pixels - pixels)
        jacobians.append(jacobian[np.repeat(fine, 2)])
        counted.append(residuals[-1][fine])
    return Lens(
        model,
        matrix,
        distortion,
        _deviations(_of(jacobians, used), _of(counted, used)),
        np.array([np.sqrt((each**2).sum(axis=1).mean()) for each in counted]),
        used,
        Poses(rotations_of(np.array(vectors)), np.array(places)),
        tuple(residuals),
        tuple(kept),
    )


def _of(values: list[Array], used: Mask) -> list[Array]:
    return [value for value, wanted in zip(values, used, strict=True) if wanted]


def _placed(
    points: Array, pixels: Array, matrix: Array, distortion: Array, model: Model
) -> tuple[Array, Array]:
    """Where the board is in one picture: rotation vector and position, both (3,)."""
    if model is Model.FISHEYE:
        rays = cv2.fisheye.undistortPoints(pixels.reshape(-1, 1, 2), matrix, distortion)
    else:
        rays = cv2.undistortPoints(pixels.reshape(-1, 1, 2), matrix, distortion)
    _, turn, shift = cv2.solvePnP(points, rays, np.eye(3), None)
    vector, place = np.asarray(turn, dtype=float).ravel(), np.asarray(shift, dtype=float).ravel()
    for _ in range(8):  # Gauss-Newton on the pixels, as `rays` weigh the rim too much
        found, jacobian = _projected(points, vector, place, matrix, distortion, model)
        rows = jacobian[:, -6:]
        step = np.linalg.lstsq(rows, (pixels - found).ravel(), rcond=None)[0]
        vector, place = vector + step[:3], place + step[3:]
    return vector, place


def _projected(
    points: Array, vector: Array, place: Array, matrix: Array, distortion: Array, model: Model
) -> tuple[Array, Array]:
    """Pixels (P, 2), and their Jacobian (2 P, 4 + C + 6): lens, then rotation and position."""
    count = COEFFICIENTS[model]
    shaped = points.reshape(-1, 1, 3)
    pixels: Any
    rows: Any
    if model is Model.FISHEYE:
        pixels, rows = cv2.fisheye.projectPoints(shaped, vector, place, matrix, distortion)
        lens, pose = rows[:, : 4 + count], rows[:, 8:14]
    else:
        pixels, rows = cv2.projectPoints(shaped, vector, place, matrix, distortion)
        lens, pose = rows[:, 6 : 10 + count], rows[:, :6]
    return np.asarray(pixels).reshape(-1, 2), np.hstack([lens, pose])


def _deviations(jacobians: list[Array], residuals: list[Array]) -> Array:
    """Standard deviations of the lens; each picture's own pose is eliminated (Schur complement)."""
    size = jacobians[0].shape[1] - 6
    square = np.zeros((size, size))
    for rows in jacobians:
        lens, pose = rows[:, :size], rows[:, size:]
        mixed = lens.T @ pose
        square += lens.T @ lens - mixed @ np.linalg.pinv(pose.T @ pose) @ mixed.T
    values = np.concatenate([each.ravel() for each in residuals])
    freedom = max(1, len(values) - size - 6 * len(jacobians))
    scale = 1.0 / np.sqrt(np.maximum(np.diag(square), 1e-30))
    scaled = square * np.outer(scale, scale) + 1e-12 * np.eye(size)  # coefficients may be alike
    variances = scale**2 * np.diag(np.linalg.inv(scaled)) * (values @ values) / freedom
    return np.asarray(np.sqrt(np.maximum(variances, 0.0)))


def _check_turns(lens: Lens) -> None:
    """CalibrationError where the board is never tilted: a near one and a long lens look alike."""
    turned, _ = turns_between(lens.camera_from_board[lens.used])
    if turned[0] < _LEAST_TURN or turned[1] < _LEAST_TURN / 5:
        degrees = ", ".join(f"{np.degrees(each):.1f}" for each in turned)
        raise CalibrationError(
            f"all views are alike: between pictures the board turns by {degrees} deg about three "
            f"axes. Focal length and distance cannot be told apart; tilt the board by 30 deg and "
            f"more to all sides"
        )
