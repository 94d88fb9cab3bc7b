"""Boxes and cylinders of known size: how far points are from them, and what is seen through them.

All in the body's own frame: z is its axis, the origin its middle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array
from momantu_bt.messages import ObjectClass

SLENDER = 1.3
"""A round category that is longer than wide by this factor narrows to one end, as a bottle."""
NECK = 0.3
"""Diameter of a bottle's neck as a share of the bottle's."""
SKIN = 0.008
"""Thickness of the outer part of a body that a ray may graze, m; at most half of the body."""


class Body(NamedTuple):
    """A box, or a cylinder about z. half: (3,) of its extent, m. round: whether it is a cylinder.

    hollow: whether its inside may be seen. slender: whether it narrows to one end.
    """

    half: Array
    round: bool
    hollow: bool
    slender: bool

    @property
    def solid(self) -> bool:
        """Whether nothing can be seen within it."""
        return not (self.hollow or self.slender)

    def distances(self, points: Array) -> Array:
        """Distance (n,) of points (n, 3) from its surface, m; negative inside."""
        beyond = np.abs(points) - self.half
        if self.round:
            across = np.hypot(points[:, 0], points[:, 1]) - self.half[0]
            beyond = np.column_stack([across, beyond[:, 2]])
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0))

    def behind(self, eye: Array, points: Array) -> Array:
        """How far (n,) points (n, 3) are behind its core, seen from the eye, m; else negative.

        The core is surely not empty: it is the body without SKIN, of a bottle as wide as its neck.
        """
        half = np.maximum(self.half - SKIN, 0.5 * self.half)
        if self.slender:
            half = np.array([NECK, NECK, 1.0]) * half
        length = np.linalg.norm(points - eye, axis=1)
        way = (points - eye) / length[:, None]
        spans = [_between(eye[2], way[:, 2], half[2])]
        if self.round:
            spans.append(_around(eye, way, half[0]))
        else:
            spans += [_between(eye[axis], way[:, axis], half[axis]) for axis in (0, 1)]
        enter = np.max([span[0] for span in spans], axis=0)
        leave = np.min([span[1] for span in spans], axis=0)
        return np.where(enter < leave, length - leave, -np.inf)


def asked_body(asked: ObjectClass, symmetry: Symmetry) -> Body | None:
    """The body of what is asked for, of a category that looks the same so; None if unknown.

    All sizes must be told. Of a bowl mostly the inside is seen, so it has none.
    """
    if symmetry is Symmetry.BOX:
        if asked.width is None or asked.depth is None or asked.height is None:
            return None
        half = np.array([asked.width, asked.depth, asked.height]) / 2
        return Body(half, round=False, hollow=False, slender=False)
    if symmetry is Symmetry.NONE or asked.diameter is None or asked.height is None:
        return None
    slender = symmetry is Symmetry.ROUND
    if slender and asked.height < SLENDER * asked.diameter:
        return None
    half = np.array([asked.diameter, asked.diameter, asked.height]) / 2
    return Body(half, round=True, hollow=symmetry is Symmetry.HANDLE, slender=slender)


def _between(start: float, way: Array, half: float) -> tuple[Array, Array]:
    """Where rays (n,) enter and leave what lies between -half and half on one axis, m."""
    rate = np.where(np.abs(way) < 1e-9, 1e-9, way)
    one, other = (-half - start) / rate, (half - start) / rate
    return np.minimum(one, other), np.maximum(one, other)


def _around(eye: Array, way: Array, radius: float) -> tuple[Array, Array]:
    """Where rays (n, 3) enter and leave an endless cylinder about z, m; inf and -inf of a miss."""
    square = np.maximum((way[:, :2] ** 2).sum(axis=1), 1e-12)
    half = way[:, :2] @ eye[:2]
    under = half**2 - square * float(eye[:2] @ eye[:2] - radius**2)
    root = np.sqrt(np.maximum(under, 0.0))
    missed = under <= 0.0
    enter, leave = (-half - root) / square, (-half + root) / square
    return np.where(missed, np.inf, enter), np.where(missed, -np.inf, leave)
