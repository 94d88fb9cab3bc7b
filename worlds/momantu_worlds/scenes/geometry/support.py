"""The measures of an object and a table top that decide whether it stands there."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.geometry.bodies import Body, Cylinder, Part
from momantu_worlds.scenes.geometry.solids import box_tops, outline


class UprightCylinder:
    """The smallest upright cylinder around an item's colliding parts, on its foot.

    Poses of the item are those of its foot.
    """

    def __init__(self, body: Body) -> None:
        parts = [part for part in body.parts if part.collision]
        if not parts:
            raise ValueError(f"the item {body.name!r} has nothing solid to judge it by")
        if body.foot is not None:
            from_body = body.foot.inverse()
            parts = [replace(p, body_from_part=from_body @ p.body_from_part) for p in parts]
        self.radius = max(_reach(part) for part in parts)
        levels = [level for part in parts for level in _levels(part)]
        self.height = max(levels) - min(levels)

    def distance(self, map_from_item: Transform, map_from_link: Transform) -> float:
        """From a link's origin to the nearest point of the item, m."""
        x, y, z = map_from_item.inverse().apply(map_from_link.position)
        beside = max(0.0, math.hypot(x, y) - self.radius)
        above = max(0.0, abs(z - self.height / 2) - self.height / 2)
        return math.hypot(beside, above)


def _reach(part: Part) -> float:
    """The farthest that an upright part stands out from its body's axis, m."""
    if isinstance(part.geometry, Cylinder):
        x, y, _ = part.body_from_part.position
        return math.hypot(x, y) + part.geometry.radius
    corners = part.body_from_part.apply(outline(part))
    return float(np.hypot(corners[:, 0], corners[:, 1]).max())


def _levels(part: Part) -> tuple[float, float]:
    """Heights between which a part lies in its body's frame, m."""
    if isinstance(part.geometry, Cylinder):
        z, half = float(part.body_from_part.position[2]), part.geometry.height / 2
        return z - half, z + half
    heights = part.body_from_part.apply(outline(part))[:, 2]
    return float(heights.min()), float(heights.max())


class SupportTop:
    """The top of a supporting body: the one that is given, or else its highest box's."""

    def __init__(self, body: Body) -> None:
        tops = (body.top,) if body.top is not None else tuple(box_tops(body))
        if not tops:
            raise ValueError(f"the support {body.name!r} has no box to stand on")
        top = max(tops, key=lambda top: float(top.body_from_top.position[2]))
        self.top, self.size = top, top.size

    def surface(self, map_from_body: Transform) -> Transform:
        """Frame of the surface, z up, its origin in the middle, in the map."""
        return map_from_body @ self.top.body_from_top

    def _on(self, map_from_body: Transform, pose: Transform) -> tuple[float, float, float]:
        x, y, z = self.surface(map_from_body).inverse().apply(pose.position)
        return float(x), float(y), float(z)

    def margin(self, map_from_body: Transform, pose: Transform) -> float:
        """How far a point lies within the nearest edge, m; below 0 beyond it."""
        x, y, _ = self._on(map_from_body, pose)
        return self.top.margin(x, y)

    def height_above(self, map_from_body: Transform, pose: Transform) -> float:
        """Height of a point above the surface, m."""
        return self._on(map_from_body, pose)[2]
