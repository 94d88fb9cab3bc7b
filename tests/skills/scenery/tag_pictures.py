"""Invented RGB-D pictures of AprilTags, with known truth."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from momantu_worlds.scenes.catalogue.tags import picture_edge, tag_picture

from momantu_bt.geometry import Array, Transform, quaternion_from_rpy
from momantu_bt.messages import CameraImage
from momantu_bt.tags import TagBundle, TagFamily, TagPlate

K = np.array([[554.0, 0.0, 319.5], [0.0, 554.0, 239.5], [0.0, 0.0, 1.0]])
SIZE = (640, 480)
FINER = 3
"""The picture is drawn so many times as large, and averaged."""


def grid(
    columns: int = 3,
    rows: int = 2,
    edge: float = 0.06,
    gap: float = 0.03,
    family: TagFamily = "tag36h11",
    first: int = 0,
) -> TagBundle:
    """A flat grid of tags about its middle."""
    step = edge + gap
    plates = tuple(
        TagPlate(
            first + row * columns + column,
            edge,
            Transform(((column - (columns - 1) / 2) * step, (row - (rows - 1) / 2) * step, 0.0)),
        )
        for row in range(rows)
        for column in range(columns)
    )
    return TagBundle(family, plates)


def before(
    distance: float, tilt: float, azimuth: float, roll: float, aside: Sequence[float] = (0.0, 0.0)
) -> Transform:
    """camera_from_bundle: a bundle `distance` m ahead, tilted by `tilt` rad to a side."""
    facing = Transform((0, 0, 0), quaternion_from_rpy(np.pi, 0.0, 0.0))
    turned = Transform((0, 0, 0), quaternion_from_rpy(0.0, 0.0, azimuth))
    tilted = Transform((0, 0, 0), quaternion_from_rpy(tilt, 0.0, 0.0))
    rolled = Transform((0, 0, 0), quaternion_from_rpy(0.0, 0.0, roll))
    turn = facing @ turned @ tilted @ turned.inverse() @ rolled
    return Transform((aside[0], aside[1], distance), turn.quaternion)


def picture(
    placed: Sequence[tuple[TagBundle, Transform]], noise: float = 2.0, seed: int = 0
) -> CameraImage:
    """What a camera sees of bundles at their places; grey around them, depth of their planes."""
    fine = np.diag([FINER, FINER, 1.0])
    fine[:2, 2] = (FINER - 1) / 2
    light = np.full((SIZE[1] * FINER, SIZE[0] * FINER), 0.5, dtype=np.float32)
    depth = np.full((SIZE[1], SIZE[0]), 3.0)
    for bundle, camera_from_bundle in placed:
        for plate in bundle.plates:
            pose = camera_from_bundle @ plate.bundle_from_tag
            grey = tag_picture(plate.tag_id, bundle.family)[..., 0]
            pixels = (grey / 255.0).astype(np.float32) ** 2.2
            half = picture_edge(plate.edge, bundle.family) / 2
            step = 2 * half / len(pixels)
            # pixels of the print, whose row 0 is at the top, to its plane
            onto = np.array([[step, 0, step / 2 - half], [0, -step, half - step / 2], [0, 0, 1.0]])
            flat = np.column_stack([pose.rotation[:, 0], pose.rotation[:, 1], pose.position])
            away = fine @ K @ flat @ onto
            size = (light.shape[1], light.shape[0])
            drawn = cv2.warpPerspective(pixels, away, size, flags=cv2.INTER_AREA)
            cover = cv2.warpPerspective(np.ones_like(pixels), away, size)
            light = np.where(cover > 0.5, drawn, light)
            _lay(depth, cover, pose)
    small = cv2.resize(light, SIZE, interpolation=cv2.INTER_AREA)
    grey = 255.0 * np.clip(small, 0.0, 1.0) ** (1 / 2.2)
    random = np.random.default_rng(seed)
    grey = np.clip(np.rint(grey + noise * random.standard_normal(grey.shape)), 0, 255)
    color = np.repeat(grey.astype(np.uint8)[..., None], 3, axis=2)
    measured = depth + 0.0015 * depth**2 * random.standard_normal(depth.shape)
    return CameraImage(0.0, "camera", color, measured.astype(np.float32), K)


def _lay(depth: Array, cover: Array, pose: Transform) -> None:
    columns, rows = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    rays = np.stack([columns, rows, np.ones_like(rows)], axis=2) @ np.linalg.inv(K).T
    normal = pose.rotation[:, 2]
    plane = (normal @ pose.position) / (rays @ normal)
    on = cv2.resize(cover, SIZE, interpolation=cv2.INTER_AREA) > 0.5
    depth[on] = plane[on]


def without_depth(image: CameraImage) -> CameraImage:
    """The same picture of a camera that measures no depth."""
    return CameraImage(
        image.stamp, image.frame, image.color, np.zeros_like(image.depth), image.intrinsics
    )
