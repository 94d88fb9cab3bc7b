"""Level tops of static bodies that could be tables: drawn, touched, and free."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import cv2
import numpy as np

from momantu_bt.geometry import Array, Pose2D
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.faces import Outline, drawn_faces, face_of, level_at, patches

LOWEST, HIGHEST = 0.3, 1.1
"""Range of heights of proposed tops, m."""
NARROWEST = 0.25
"""Least edge of such a top, m."""
SMALLEST = 0.2
"""Least area of such a top, m2; the seat of a chair is smaller."""
LONGEST = 6.0
"""Largest edge of such a top, m."""
LEVEL = 0.005
"""Depth below a piece's highest point within which faces belong to its top, m."""
COVERED = 0.7
"""Least share of the rectangle around a top that the top covers: a disc has 0.79."""
HEADROOM = 0.3
"""Free height above a top that the hand needs, m."""
FREE = 0.5
"""Least share of a top with such room above it: plates may stand on a table."""
APART = 0.05
"""Largest height between a top as it is drawn and as it is touched, m."""
SAMPLES, WITHIN, MET = 7, 0.8, 0.5
"""Rows and columns of points at which a top is looked at, their share of its extent, and the least
share of them that must be drawn and touched."""
SEAT, BACK, BESIDE = 0.6, 0.15, 0.1
"""A top below the first height is a seat if its body rises by the second beside it, within the
third, m."""
CELL = 0.025
"""Cell size of the grid on which free room is counted, m."""
_TABLE = re.compile(
    r"table|desk|counter|stand|shelf|case|cabinet|drawer|board|work_?bench|crate|box"
)
_OTHER = re.compile(
    r"chair|sofa|couch|stool|seat|bed|toilet|bath|sink|wall|floor|ceiling|door|window|stair|lamp|light|fitness"
)

_Face: TypeAlias = tuple[float, Array]


@dataclass(frozen=True, slots=True)
class Top:
    """A level rectangle. pose: of its centre in the map. size: along its own x and y, m.

    height: of what is higher of the two, what is drawn and what is touched. drawn, touched: theirs.
    """

    pose: Pose2D
    size: tuple[float, float]
    height: float
    drawn: float
    touched: float

    @property
    def area(self) -> float:
        """m2."""
        return self.size[0] * self.size[1]


class Around:
    """The collision shapes of all static bodies, each by points (n, 3) in the map."""

    def __init__(self, hulls: Sequence[Array]) -> None:
        self._hulls = hulls
        self._low = np.array([hull.min(axis=0) for hull in hulls]).reshape(-1, 3)
        self._high = np.array([hull.max(axis=0) for hull in hulls]).reshape(-1, 3)

    def near(self, low: Array, high: Array) -> list[Array]:
        """Those that reach into a box between two corners (3,)."""
        found = (self._high > low).all(axis=1) & (self._low < high).all(axis=1)
        return [self._hulls[i] for i in np.flatnonzero(found).tolist()]


def best_top(body: ImportedBody, others: Around) -> Top | None:
    """The largest top of a body that is drawn, touched and free; others: all static bodies."""
    named = f"{body.title} {body.name}".lower()
    table = bool(_TABLE.search(named))
    if not table and _OTHER.search(named):
        return None
    faces = [face for hull in body.hulls() if (face := face_of(hull, LEVEL, LOWEST, HIGHEST))]
    drawn = drawn_faces(body, LOWEST, HIGHEST)
    touched = np.array([t for _, points in faces for t in _fan(points)]).reshape(-1, 3, 3)
    found = [_top_of(group) for group in _touched_groups(faces)]
    found += [_top_of([(height, p) for p in patch]) for height, patch in patches(drawn, LEVEL)]
    tops = [
        both
        for top in found
        if top is not None
        if (both := _both(top, drawn, touched)) is not None
        if table or not _is_seat(both, body)
        if _has_room(both, others)
    ]
    return max(tops, key=lambda top: (round(top.area, 3), -top.height), default=None)


def _touched_groups(faces: Sequence[Outline]) -> list[list[_Face]]:
    """Faces one by one, and those of one height together."""
    flat = sorted(((h, points[:, :2]) for h, points in faces), key=lambda face: face[0])
    level: list[list[_Face]] = []
    for face in flat:
        if level and face[0] - level[-1][-1][0] < LEVEL:
            level[-1].append(face)
        else:
            level.append([face])
    return [[face] for face in flat] + [many for many in level if len(many) > 1]


def _fan(points: Array) -> list[Array]:
    """Triangles (3, 3) of a convex face of points (n, 3)."""
    order = cv2.convexHull(points[:, :2].astype(np.float32), returnPoints=False)[:, 0]
    corners = points[order]
    return [np.stack([corners[0], a, b]) for a, b in pairwise(corners[1:])]


def _top_of(faces: Sequence[_Face]) -> Top | None:
    """The rectangle around faces of one height, if they fill it and it is large enough."""
    height = max(face[0] for face in faces)
    middle = np.concatenate([face[1] for face in faces]).mean(axis=0)
    outlines = [cv2.convexHull((face[1] - middle).astype(np.float32)) for face in faces]
    (x, y), (width, depth), angle = cv2.minAreaRect(np.concatenate(outlines))
    if min(width, depth) < NARROWEST or width * depth < SMALLEST or max(width, depth) > LONGEST:
        return None
    if sum(map(cv2.contourArea, outlines)) < COVERED * width * depth:
        return None
    yaw = math.radians(angle)
    while yaw > math.pi / 4:
        yaw, width, depth = yaw - math.pi / 2, depth, width
    while yaw < -math.pi / 4:
        yaw, width, depth = yaw + math.pi / 2, depth, width
    at = Pose2D(float(middle[0] + x), float(middle[1] + y), yaw)
    return Top(at, (float(width), float(depth)), height, height, height)


def _both(top: Top, drawn: Array, touched: Array) -> Top | None:
    """The top as it is drawn and as it is touched; None if it is only one of both."""
    steps = np.linspace(-WITHIN / 2, WITHIN / 2, SAMPLES)
    own = np.array([(x * top.size[0], y * top.size[1]) for x in steps for y in steps])
    c, s = math.cos(top.pose.yaw), math.sin(top.pose.yaw)
    points = own @ np.array([(c, s), (-s, c)]) + (top.pose.x, top.pose.y)
    heights = []
    for faces in (drawn, touched):
        found = level_at(points, faces, top.height - APART, top.height + APART)
        met = np.isfinite(found)
        if met.mean() < MET:
            return None
        heights.append(float(np.median(found[met])))
    return Top(top.pose, top.size, max(heights), *heights)


def _is_seat(top: Top, body: ImportedBody) -> bool:
    """Whether a low top has a back or arms: its own body rises beside it."""
    if top.height > SEAT:
        return False
    half = np.array(top.size) / 2 + BESIDE
    for hull in body.hulls():
        if hull[:, 2].max() > top.height + BACK:
            own = _own(top, hull)
            if (own.min(axis=0) < half).all() and (own.max(axis=0) > -half).all():
                return True
    return False


def _own(top: Top, hull: Array) -> Array:
    """Points (n, 2) of a hull in the top's frame."""
    back = top.pose.inverse()
    c, s = math.cos(back.yaw), math.sin(back.yaw)
    return np.asarray(hull[:, :2] @ np.array([(c, s), (-s, c)]) + (back.x, back.y))


def _has_room(top: Top, others: Around) -> bool:
    """Whether enough of a top has nothing in the space above it."""
    size = np.array(top.size)
    reach = float(np.hypot(*size)) / 2
    middle = np.array([top.pose.x, top.pose.y])
    low = np.array([*(middle - reach), top.height + LEVEL])
    high = np.array([*(middle + reach), top.height + HEADROOM])
    taken = np.zeros(tuple(int(n) for n in np.ceil(size / CELL)[::-1]), dtype=np.uint8)
    for hull in others.near(low, high):
        corners = ((_own(top, hull) + size / 2) / CELL - 0.5).astype(np.float32)
        cv2.fillConvexPoly(taken, np.round(cv2.convexHull(corners)).astype(np.int32), 1)
    return bool(1.0 - taken.mean() >= FREE)


def proposed_tops(bodies: Iterable[ImportedBody]) -> dict[str, Top]:
    """The best top of each static body that has one, by the body's name."""
    still = [body for body in bodies if body.still]
    around = Around([hull for body in still for hull in body.hulls()])
    found = {body.name: best_top(body, around) for body in still}
    return {name: top for name, top in found.items() if top is not None}
