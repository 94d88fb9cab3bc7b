"""The measures by which it is told whether a thing stands on a table: its cylinder, the top."""

from __future__ import annotations

import math

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.bodies import Body, Cylinder
from momantu_worlds.scenes.solids import box_tops


class Upright:
    """The cylinder that an item is, standing on its origin."""

    def __init__(self, body: Body) -> None:
        shape = next(
            (p.geometry for p in body.parts if p.collision and isinstance(p.geometry, Cylinder)),
            None,
        )
        if shape is None:
            raise ValueError(f"the item {body.name!r} has no cylinder to judge it by")
        self.radius, self.height = shape.radius, shape.height

    def distance(self, map_from_item: Transform, map_from_link: Transform) -> float:
        """From a link's origin to the nearest point of the item, m."""
        x, y, z = map_from_item.inverse().apply(map_from_link.position)
        beside = max(0.0, math.hypot(x, y) - self.radius)
        above = max(0.0, abs(z - self.height / 2) - self.height / 2)
        return math.hypot(beside, above)


class Top:
    """A body's top: the one that is told, or else its highest box's."""

    def __init__(self, body: Body) -> None:
        tops = (body.top,) if body.top is not None else tuple(box_tops(body))
        if not tops:
            raise ValueError(f"the support {body.name!r} has no box to stand on")
        top = max(tops, key=lambda top: float(top.body_from_top.position[2]))
        self._body_from_surface, self.size = top.body_from_top, top.size

    def surface(self, map_from_body: Transform) -> Transform:
        """Frame of the surface, z up, its origin in the middle, in the map."""
        return map_from_body @ self._body_from_surface

    def _on(self, map_from_body: Transform, pose: Transform) -> tuple[float, float, float]:
        x, y, z = self.surface(map_from_body).inverse().apply(pose.position)
        return float(x), float(y), float(z)

    def margin(self, map_from_body: Transform, pose: Transform) -> float:
        """How far a point lies within the nearest edge, m; below 0 beyond it."""
        x, y, _ = self._on(map_from_body, pose)
        return min(self.size[0] / 2 - abs(x), self.size[1] / 2 - abs(y))

    def height_above(self, map_from_body: Transform, pose: Transform) -> float:
        """Height of a point above the surface, m."""
        return self._on(map_from_body, pose)[2]
