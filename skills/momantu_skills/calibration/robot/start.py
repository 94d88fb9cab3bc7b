"""Where the tags roughly are, and which of them move with the hand."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from momantu_bt.geometry import Array
from momantu_skills.calibration.robot.model import Model, State
from momantu_skills.calibration.robot.parameters import columns

_CLEARLY = 0.8
"""A tag moves with the hand if it then fits better by this factor."""


def start(model: Model, told: Array, held: Sequence[int] | None) -> tuple[State, NDArray[np.bool_]]:
    """The state before the estimation, and which tags move with the hand.

    held: ids of the tags that move with the hand; None finds out.
    """
    views = model.views
    base_from_camera = model.camera.matrices(
        views.positions[:, columns(model.camera.names, views.joints)]
    )
    carriers: list[Array] = [_inverse(_planar(views.stand_poses[views.stands]))]
    if model.hand is not None:
        at = columns(model.hand.names, views.joints)
        carriers.append(model.hand.matrices(views.positions[:, at]))
    tags, moving = [], []
    for k, tag_id in enumerate(views.tag_ids):
        chosen = np.flatnonzero(views.tags == k)
        guesses = [_guess(model, chosen, base_from_camera, carrier) for carrier in carriers]
        with_hand = len(guesses) > 1 and (
            guesses[1][1] < _CLEARLY * guesses[0][1] if held is None else tag_id in held
        )
        tags.append(guesses[1 if with_hand else 0][0])
        moving.append(with_hand)
    return State(told, np.array(tags), views.stand_poses.copy()), np.array(moving)


def _guess(
    model: Model, chosen: NDArray[np.intp], base_from_camera: Array, carrier: Array
) -> tuple[Array, float]:
    """The pose of a tag on its carrier that fits most of its sightings, and its error, px."""
    views = model.views
    camera_from_carrier = _inverse(base_from_camera[chosen]) @ carrier[chosen]
    best = (np.eye(4), np.inf)
    for i, camera_from_base in zip(chosen, camera_from_carrier, strict=True):
        for camera_from_tag in poses_seen(views.models[i], views.corners[i], views.intrinsics[i]):
            pose = _inverse(camera_from_base) @ camera_from_tag
            points = views.models[chosen] @ (camera_from_carrier @ pose)[:, :3, :3].mT
            points = points + (camera_from_carrier @ pose)[:, None, :3, 3]
            lens = views.intrinsics[chosen][:, None]
            ahead = np.maximum(points[..., 2:], 0.05)
            off = lens[..., :2] * points[..., :2] / ahead + lens[..., 2:] - views.corners[chosen]
            error = float(np.median(np.linalg.norm(off, axis=2).mean(1)))
            if error < best[1]:
                best = (pose, error)
    return best


def poses_seen(points: Array, corners: Array, lens: Array) -> list[Array]:
    """The poses (4, 4), at most two, of a square (4, 3) m in the camera, from its corners (4, 2).

    The library wants its corners from the upper left one on, clockwise.
    """
    matrix = np.array([[lens[0], 0, lens[2]], [0, lens[1], lens[3]], [0, 0, 1.0]])
    order = [3, 2, 1, 0]
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        points[order], corners[order], matrix, None, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )
    made = []
    for turn, shift in zip(turns, shifts, strict=True):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(turn)[0], np.ravel(shift)
        if np.isfinite(pose).all():
            made.append(pose)
    return made


def _inverse(poses: Array) -> Array:
    return np.asarray(np.linalg.inv(poses), dtype=np.float64)


def _planar(poses: Array) -> Array:
    made = np.tile(np.eye(4), (len(poses), 1, 1))
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    made[:, 0, 0], made[:, 0, 1], made[:, 1, 0], made[:, 1, 1] = c, -s, s, c
    made[:, :2, 3] = poses[:, :2]
    return made
