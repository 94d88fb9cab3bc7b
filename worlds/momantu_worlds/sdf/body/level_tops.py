"""Level tops of static bodies that could be tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import cv2
import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sdf.body.bodies import ImportedBody

LOWEST, HIGHEST = 0.3, 1.2
"""Range of heights of proposed tops, m."""
NARROWEST = 0.25
"""Least edge of such a top, m."""
SMALLEST = 0.2
"""Least area of such a top, m2; the seat of a chair is smaller."""
LEVEL = 0.005
"""Depth below a piece's highest point within which faces belong to its top, m."""
COVERED = 0.7
"""Least share of the rectangle around a top that the top covers: a disc has 0.79."""
HEADROOM = 0.3
"""Free height above a top that the hand needs, m."""


_Face: TypeAlias = tuple[float, Array]


@dataclass(frozen=True, slots=True)
class Top:
    """A level rectangle. pose: of its centre in the map. size: along its own x and y, m."""

    pose: Pose2D
    size: tuple[float, float]
    height: float

    @property
    def area(self) -> float:
        """m2."""
        return self.size[0] * self.size[1]


def best_top(body: ImportedBody, others: Sequence[Array]) -> Top | None:
    """The largest top of a body with room above it; others: hulls (n, 3) of all static bodies."""
    faces = sorted(filter(None, map(_face_of, body.hulls())), key=lambda face: face[0])
    level: list[list[_Face]] = []
    for face in faces:
        if level and face[0] - level[-1][-1][0] < LEVEL:
            level[-1].append(face)
        else:
            level.append([face])
    groups = [[face] for face in faces] + [many for many in level if len(many) > 1]
    found = [top for group in groups if (top := _top_of(group)) is not None]
    free = [top for top in found if _has_room(top, others)]
    return max(free, key=lambda top: (round(top.area, 6), -top.height), default=None)


def _face_of(hull: Array) -> _Face | None:
    """Height and points (n, 2) of the level upper face of a hull, m; None if it has none."""
    height = float(hull[:, 2].max())
    upper = hull[hull[:, 2] > height - LEVEL, :2]
    return (height, upper) if LOWEST <= height <= HIGHEST and len(upper) > 2 else None


def _top_of(faces: Sequence[_Face]) -> Top | None:
    """The rectangle around faces of one height, if they fill it and it is large enough."""
    height = max(face[0] for face in faces)
    middle = np.concatenate([face[1] for face in faces]).mean(axis=0)
    outlines = [cv2.convexHull((face[1] - middle).astype(np.float32)) for face in faces]
    (x, y), (width, depth), angle = cv2.minAreaRect(np.concatenate(outlines))
    if min(width, depth) < NARROWEST or width * depth < SMALLEST:
        return None
    if sum(map(cv2.contourArea, outlines)) < COVERED * width * depth:
        return None
    yaw = math.radians(angle)
    while yaw > math.pi / 4:
        yaw, width, depth = yaw - math.pi / 2, depth, width
    while yaw < -math.pi / 4:
        yaw, width, depth = yaw + math.pi / 2, depth, width
    at = Pose2D(float(middle[0] + x), float(middle[1] + y), yaw)
    return Top(at, (float(width), float(depth)), height)


def _has_room(top: Top, others: Iterable[Array]) -> bool:
    """Whether no static body extends into the space above the centre of a top."""
    back = top.pose.inverse()
    c, s = math.cos(back.yaw), math.sin(back.yaw)
    half = np.array(top.size) / 4.0
    for hull in others:
        if hull[:, 2].max() <= top.height + LEVEL or hull[:, 2].min() >= top.height + HEADROOM:
            continue
        own = hull[:, :2] @ np.array([(c, s), (-s, c)]) + (back.x, back.y)
        if (own.min(axis=0) < half).all() and (own.max(axis=0) > -half).all():
            return False
    return True
