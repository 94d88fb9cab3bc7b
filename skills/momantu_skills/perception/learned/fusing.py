"""Things of several views as one list."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_skills.perception.learned.solids import Solid

SAME = 0.035
"""Distance up to which two middles are one thing's, m: half of the least width of two things."""
AGREEING = 0.2
"""Relative difference of sizes up to which they are averaged."""

WHOLE = 0.5
"""A view that shows a mug's handle is taken from this share of the cells of the fullest view on."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """One view: height (m, odom) and visible area (m2) of the surface, and the things, in odom.

    eye: (3,) the camera's place, and points: (n, 3) what it sees on the surface, m in odom.
    """

    height: float
    area: float
    stamp: float
    solids: tuple[Solid, ...]
    eye: Array = field(default_factory=lambda: np.zeros(3))
    points: Array = field(default_factory=lambda: np.empty((0, 3)))


def height(looks: Sequence[Look]) -> float:
    """The surface's height, m: the mean of the views, by the area that each shows."""
    areas = np.array([look.area for look in looks])
    return float(np.array([look.height for look in looks]) @ areas / areas.sum())


def fused(looks: Sequence[Look]) -> list[Solid]:
    """Each thing once; what most cells show comes first."""
    level = height(looks)
    every = [
        solid.moved(Transform((0.0, 0.0, level - look.height)))
        for look in looks
        for solid in look.solids
    ]
    every.sort(key=lambda solid: -solid.cells)
    groups: list[list[Solid]] = []
    for solid in every:
        at = solid.frame_from_object.position
        same = [
            group
            for group in groups
            if np.linalg.norm(group[0].frame_from_object.position - at) < SAME
        ]
        if same:
            same[0].append(solid)
        else:
            groups.append([solid])
    return [_one(group) for group in groups]


def _one(group: Sequence[Solid]) -> Solid:
    """The thing of several views: the turn of the best, the mean place and size of those alike."""
    best = _best(group)
    like = [
        solid
        for solid in group
        if solid.category == best.category
        and np.allclose(solid.size, best.size, rtol=AGREEING, atol=0.0)
    ]
    weights = np.array([solid.cells for solid in like], dtype=np.float64)
    weights /= weights.sum()
    position = weights @ np.array([solid.frame_from_object.position for solid in like])
    x, y, z = (weights @ np.array([solid.size for solid in like])).tolist()
    pose = Transform(position, best.frame_from_object.quaternion)
    cells = sum(solid.cells for solid in like)
    points = np.concatenate([solid.points for solid in like])
    return replace(best, frame_from_object=pose, size=(x, y, z), cells=cells, points=points)


def _best(group: Sequence[Solid]) -> Solid:
    """The view of the likeliest category that shows most; of mugs, one that shows the handle.

    A view that shows a handle but little of its mug says little of the mug's place and size.
    """
    chance: dict[str, float] = {}
    for solid in group:
        chance[solid.category] = chance.get(solid.category, 0.0) + solid.sure * solid.cells
    category = max(chance, key=lambda name: chance[name])
    like = [solid for solid in group if solid.category == category]
    enough = WHOLE * max(solid.cells for solid in like)
    return max(like, key=lambda solid: (solid.handle and solid.cells >= enough, solid.cells))
