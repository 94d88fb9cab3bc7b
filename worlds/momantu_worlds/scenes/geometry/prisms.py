"""Upright prisms around bodies, for keeping them apart."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.plane import Rectangle, gap
from momantu_worlds.scenes.geometry.solids import outline


@dataclass(frozen=True, slots=True)
class Prism:
    """An upright prism over a rectangle, between two heights, m."""

    base: Rectangle
    bottom: float
    top: float

    def foot(self) -> Array:
        """Points (17, 3) of its bottom in the map: the middle and two rings within its edges."""
        turns = np.arange(8) * (math.pi / 4)
        ring = np.column_stack([np.cos(turns), np.sin(turns)]) * np.array(self.base.size) / 2
        own = np.concatenate([np.zeros((1, 2)), 0.5 * ring, 0.95 * ring])
        flat = np.column_stack([own, np.full(len(own), self.bottom)])
        return self.base.pose.transform().apply(flat)

    def clear_of(self, others: Iterable[Prism], least: float) -> bool:
        """Whether it keeps `least` m, sideways or upwards, from all others."""
        reach = math.hypot(*self.base.size) / 2 + least
        for other in others:
            if self.bottom - least >= other.top or other.bottom - least >= self.top:
                continue
            far = reach + math.hypot(*other.base.size) / 2
            if self.base.pose.distance_to(other.base.pose) >= far:
                continue
            between = gap(self.base, other.base)
            if between == 0.0 or between < least:
                return False
        return True


def prism_around(points: Array, yaw: float) -> Prism:
    """The least prism around points (n, 3) of the map whose rectangle is turned by `yaw` rad."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    own = points[:, :2] @ np.array([(cos, -sin), (sin, cos)])
    low, high = own.min(axis=0), own.max(axis=0)
    x, y = ((low + high) / 2).tolist()
    pose = Pose2D(cos * x - sin * y, sin * x + cos * y, yaw)
    size = float(high[0] - low[0]), float(high[1] - low[1])
    return Prism(Rectangle(pose, size), float(points[:, 2].min()), float(points[:, 2].max()))


def tightest_prism(points: Array) -> Prism:
    """The prism around points (n, 3) of the map over the smallest rectangle of all.

    One of its sides lies along two of the points (Freeman and Shapira, 1975). If several rectangles
    are equally small, as around a prism, the result is the least turned one. Shapely's oriented
    envelope takes another, which would change the episodes of worlds with bodies.
    """
    flat = np.unique(np.round(points[:, :2], 5), axis=0)
    first, second = np.triu_indices(len(flat), 1)
    steps = flat[second] - flat[first]
    yaws = np.unique(np.round(np.arctan2(steps[:, 1], steps[:, 0]) % (math.pi / 2), 6))
    if len(yaws) == 0:
        return prism_around(points, 0.0)
    along = flat @ np.stack([np.cos(yaws), np.sin(yaws)])
    across = flat @ np.stack([-np.sin(yaws), np.cos(yaws)])
    areas = np.ptp(along, axis=0) * np.ptp(across, axis=0)
    return prism_around(points, float(yaws[int(np.argmin(areas))]))


def body_prism(body: Body, map_from_body: Transform) -> Prism | None:
    """The prism around all of a body that collides, however it lies; None when nothing does."""
    points = body_points(body)
    if points is None:
        return None
    return prism_around(map_from_body.apply(points), map_from_body.yaw)


def part_prisms(body: Body, map_from_body: Transform) -> list[Prism]:
    """A prism around each part that collides: between the boards of a rack there is room."""
    parts = [p for p in body.parts if p.collision]
    placed = (map_from_body @ part.body_from_part for part in parts)
    return [
        prism_around(at.apply(outline(part)), at.yaw)
        for at, part in zip(placed, parts, strict=True)
    ]


def body_points(body: Body) -> Array | None:
    """Points (n, 3) in the body's frame whose convex hull holds all that collides."""
    parts = [p.body_from_part.apply(outline(p)) for p in body.parts if p.collision]
    return np.concatenate(parts) if parts else None
