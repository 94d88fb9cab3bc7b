"""The shape of an object: round or boxy, its size, its radius over its height."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.perception.geometry.rectangles import Rectangle, fitted_to, smallest_rectangle
from momantu_skills.perception.geometry.revolution import Revolution, fit_revolution
from momantu_skills.perception.surface.segment import Thing

ROUND_MISFIT = 0.004
"""Median distance to the fitted surface above which an object is not round, m."""
LARGEST_RADIUS = 0.20
"""A larger fitted radius means that the points are flat, m."""
LEAST_SIDE = 25
"""Fewest points on a side for fitting it."""
NECK = 0.72
"""A bottle's neck is narrower than this share of its body."""
FLARE = 0.80
"""A bowl's foot is narrower than this share of its rim."""
INSIDE = 0.75
"""Share of the radius within which points distinguish a closed top from an opening."""
RIM = 0.015
"""Distance below the highest point within which an inner point belongs to a closed top, m."""
STEEP = math.radians(15.0)
"""Least elevation at which a camera can tell that an object has no closed top, rad."""
EDGE = 95.0
"""Percentile of the points near the upper edge that lies at the edge itself: noise is beyond."""
HANDLE = 0.012
"""Least distance that a handle extends from the body, m."""
BEYOND = 0.008
"""Distance outside the fitted shape above which a point belongs to another object, or a handle,
m."""


@dataclass(frozen=True, slots=True)
class Shape:
    """One object as measured.

    kind: "cylinder" or "box". category: can, bottle, mug, bowl or box, by its shape. centre: x, y
    in odom, m. yaw: of a box, rad. size: along its own x, y and up, m. misfit: median distance of
    its side to the fitted shape, m. radius_sigma: uncertainty of a round object's radius, m.
    beyond: share of its points that lie outside the fitted shape.
    """

    kind: str
    category: str
    centre: tuple[float, float]
    yaw: float
    size: tuple[float, float, float]
    misfit: float
    radius_sigma: float
    beyond: float


def describe(thing: Thing, eyes: Array, expected_radius: float | None = None) -> Shape:
    """Fit a cylinder and a box and keep the better one.

    eyes: (k, 3) positions of the cameras, odom x, y and height above the surface, m.
    expected_radius: of the requested object, m. It is used if the view does not determine the
    radius: the centre of a half-hidden can is still found with it.
    """
    side = thing.points[thing.side]
    rectangle = smallest_rectangle(thing.points[:, :2])
    rectangle = fitted_to(rectangle, thing.points[:, :2], side[:, :2])
    body = fit_revolution(side) if len(side) >= LEAST_SIDE else None
    if body is None or not _is_round(body, rectangle, side):
        return _box(thing, rectangle, side)
    if expected_radius is not None:
        body = _with_expected(side, body, expected_radius)
    return _round(thing, body, eyes)


def _is_round(body: Revolution, rectangle: Rectangle, side: Array) -> bool:
    if body.misfit > ROUND_MISFIT or not 0.01 < body.radius < LARGEST_RADIUS:
        return False
    boxy = float(np.median(np.abs(rectangle.distances(side[:, :2]))))
    reach = float(np.hypot(*(body.centre - rectangle.centre)))
    return body.misfit < boxy and reach < 0.75 * float(rectangle.size.max())


def _with_expected(side: Array, body: Revolution, radius: float) -> Revolution:
    """The fit with the expected radius, unless the free fit is clearly better."""
    difference = abs(body.radius - radius)
    if difference > max(0.15 * radius, 3.0 * body.radius_sigma):
        return body
    tight = fit_revolution(side, radius)
    if tight is None or tight.misfit > 1.15 * body.misfit + 0.0002:
        return body
    return tight


def _round(thing: Thing, body: Revolution, eyes: Array) -> Shape:
    height = thing.height
    known = ~np.isnan(body.radii)
    widest = float(np.percentile(body.radii[known], 90.0))
    category = _round_category(thing, body, height, eyes)
    radius = body.radius if category in ("can", "mug") else widest
    if category == "bowl":
        radius = max(widest, _rim_radius(thing, body))
    return Shape(
        "cylinder",
        category,
        (float(body.centre[0]), float(body.centre[1])),
        0.0,
        (2 * radius, 2 * radius, height),
        body.misfit,
        body.radius_sigma,
        float((_distances(thing, body) > widest + BEYOND).mean()),
    )


def _rim_radius(thing: Thing, body: Revolution) -> float:
    """Radius of the upper edge of an object that is wider there than below, m."""
    upper = _distances(thing, body)[thing.points[:, 2] > thing.height - RIM]
    return float(np.percentile(upper, EDGE)) if len(upper) >= LEAST_SIDE else 0.0


def _round_category(thing: Thing, body: Revolution, height: float, eyes: Array) -> str:
    known = ~np.isnan(body.radii)
    heights, radii = body.heights[known], body.radii[known]
    widest = float(np.percentile(radii, 90.0))
    upper, lower = radii[heights > 0.75 * height], radii[heights < 0.35 * height]
    if len(upper) and float(np.median(upper)) < NECK * widest:
        return "bottle"
    if len(lower) and float(lower.min()) < FLARE * widest and height < 2.2 * widest:
        return "bowl"
    return "mug" if _is_open(thing, body, height, eyes) or _has_handle(thing, body) else "can"


def _is_open(thing: Thing, body: Revolution, height: float, eyes: Array) -> bool:
    """Whether a camera that looks down on the top sees no closed top."""
    away = np.hypot(eyes[:, 0] - body.centre[0], eyes[:, 1] - body.centre[1])
    if float(np.arctan2(eyes[:, 2] - height, away).max()) < STEEP:
        return False
    inside = _distances(thing, body) < INSIDE * body.radius
    return int((inside & (thing.points[:, 2] > height - RIM)).sum()) < LEAST_SIDE


def _distances(thing: Thing, body: Revolution) -> Array:
    """Distance (n,) of the object's points to the axis, m."""
    offsets = thing.points[:, :2] - body.centre
    return np.asarray(np.hypot(offsets[:, 0], offsets[:, 1]))


def _has_handle(thing: Thing, body: Revolution) -> bool:
    """Whether a narrow part extends to one side."""
    offsets = thing.points[:, :2] - body.centre
    out = _distances(thing, body) > body.radius + HANDLE
    if int(out.sum()) < LEAST_SIDE // 2:
        return False
    bearings = np.arctan2(offsets[out, 1], offsets[out, 0])
    together = float(np.hypot(np.cos(bearings).mean(), np.sin(bearings).mean()))
    return together > 0.9


def _box(thing: Thing, rectangle: Rectangle, side: Array) -> Shape:
    misfit = float(np.median(rectangle.distances(side[:, :2]))) if len(side) else 0.0
    return Shape(
        "box",
        "box",
        (float(rectangle.centre[0]), float(rectangle.centre[1])),
        rectangle.yaw,
        (float(rectangle.size[0]), float(rectangle.size[1]), thing.height),
        misfit,
        0.0,
        float((rectangle.outside(thing.points[:, :2]) > BEYOND).mean()),
    )
