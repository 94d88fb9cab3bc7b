"""How far a found thing is from the true one: boxes' overlap, and angles up to symmetry.

As in the NOCS benchmark (Wang and others, 2019) a thing of revolution may be turned about its axis,
and so may a mug whose handle is not seen. A can may stand on its head, and a box's axes may have
other names.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from momantu_bt.categories import USUAL, Symmetry
from momantu_bt.geometry import Array, Transform


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A thing. pose: `camera_from_object`; size: (3,) m; turns: it may be turned about its z.

    symmetry: None: that of the usual category.
    """

    category: str
    pose: Transform
    size: tuple[float, float, float]
    turns: bool = False
    symmetry: Symmetry | None = None


def overlap(one: Solid, true: Solid) -> float:
    """Intersection over union of two things' boxes, in 0..1."""
    apart = float(np.linalg.norm(one.pose.position - true.pose.position))
    if apart > (np.linalg.norm(one.size) + np.linalg.norm(true.size)) / 2:
        return 0.0
    turn = one.pose.rotation
    if true.turns:
        turn = turn @ _about_axis(turn.T @ true.pose.rotation)
    a = float(np.prod(one.size))
    b = float(np.prod(true.size))
    if min(a, b) <= 0.0:
        return 0.0
    there = Transform.from_rotation(turn, one.pose.position)
    shared = _shared(there, one.size, true.pose, true.size)
    return shared / (a + b - shared)


def angle(one: Solid, true: Solid) -> float:
    """The angle between two things' turns, degrees, the least of those that look alike."""
    relative = one.pose.rotation.T @ true.pose.rotation
    symmetry = true.symmetry or USUAL.get(true.category, Symmetry.NONE)
    if symmetry is Symmetry.BOX:
        best = max(float(np.trace(relative @ turn)) for turn in _CUBE)
        return _degrees((best - 1.0) / 2.0)
    if true.turns:
        cosine = float(relative[2, 2])
        return _degrees(abs(cosine) if symmetry is Symmetry.ENDS else cosine)
    return _degrees((float(np.trace(relative)) - 1.0) / 2.0)


def distance(one: Solid, true: Solid) -> float:
    """Distance between the middles of two things, m."""
    return float(np.linalg.norm(one.pose.position - true.pose.position))


def _degrees(cosine: float) -> float:
    return math.degrees(math.acos(min(1.0, max(-1.0, cosine))))


def _about_axis(relative: Array) -> Array:
    """The turn about z that comes nearest to a rotation (3, 3)."""
    sign = 1.0 if relative[2, 2] >= 0.0 else -1.0
    yaw = math.atan2(relative[1, 0] - sign * relative[0, 1], relative[0, 0] + sign * relative[1, 1])
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _shared(
    one: Transform, size: tuple[float, ...], other: Transform, of: tuple[float, ...]
) -> float:
    """Volume that two boxes share, m3: of the hull of all corners of what they share."""
    there = other.inverse() @ one
    corners = _UNIT * np.array(size)
    in_other = _within(there.apply(corners), np.array(of) / 2)
    in_one = _within(there.inverse().apply(_UNIT * np.array(of)), np.array(size) / 2)
    points = np.concatenate([in_other, there.apply(in_one)])
    if len(points) < 4:
        return 0.0
    try:
        return float(ConvexHull(points).volume)
    except QhullError:  # they touch at most
        return 0.0


def _within(corners: Array, half: Array) -> Array:
    """Corners (8, 3) of a box, and where its edges pass faces, that lie in a box around 0."""
    starts, ends = corners[_EDGES[:, 0]], corners[_EDGES[:, 1]]
    way = np.where(np.abs(ends - starts) < 1e-12, 1e-12, ends - starts)
    found = [corners]
    for sign in (-1.0, 1.0):
        along = (sign * half - starts) / way
        edges, axes = np.nonzero((along >= 0.0) & (along <= 1.0))
        passing = starts[edges] + along[edges, axes, None] * (ends - starts)[edges]
        found.append(passing)
    points = np.concatenate(found)
    return np.asarray(points[(np.abs(points) <= half + 1e-9).all(axis=1)])


_UNIT = np.array(list(product((-0.5, 0.5), repeat=3)))
_EDGES = np.array([(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1])
_CUBE = [
    turn
    for order in permutations(range(3))
    for signs in product((-1.0, 1.0), repeat=3)
    if np.linalg.det(turn := np.eye(3)[list(order)] * np.array(signs)) > 0.0
]
