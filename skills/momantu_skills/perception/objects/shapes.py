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
"""m; median distance to the fitted surface from which on a thing is not round."""
LARGEST_RADIUS = 0.20
"""m; a larger fitted radius means that the points are flat."""
LEAST_SIDE = 25
"""Points on a side that make a fit of it worth trying."""
NECK = 0.72
"""A bottle's neck is narrower than this share of its body."""
FLARE = 0.80
"""A bowl's foot is narrower than this share of its rim."""
INSIDE = 0.75
"""Share of the radius within which points tell a closed top from an opening."""
RIM = 0.015
"""m below the highest point within which a point inside belongs to a closed top."""
STEEP = math.radians(15.0)
"""Elevation from which on a camera sees enough of a top to miss it when it is not there."""
HANDLE = 0.012
"""m that a handle stands out at least."""
BEYOND = 0.008
"""m outside the fitted form from which on a point belongs to something else, or to a handle."""


@dataclass(frozen=True, slots=True)
class Shape:
    """One object as measured.

    kind: "cylinder" or "box". category: can, bottle, mug, bowl or box, by its form. centre: x, y
    in odom, m. yaw: of a box, rad. size: along its own x, y and up, m. misfit: median distance of
    its side to the form, m. radius_sigma: uncertainty of a round thing's radius, m. beyond: share
    of its points that lie outside the form.
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
    """Fit both forms and keep the better one.

    eyes: (k, 3) where the cameras were, odom x, y and height above the surface, m.
    expected_radius: of what is looked for, m. It serves where the view leaves the radius open
    within what was measured: the centre of a half-hidden can is then still found.
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
    """The fit with the expected radius, if the free fit is not clearly better."""
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
    """Whether a camera that looks down on the top sees none."""
    away = np.hypot(eyes[:, 0] - body.centre[0], eyes[:, 1] - body.centre[1])
    if float(np.arctan2(eyes[:, 2] - height, away).max()) < STEEP:
        return False
    inside = _distances(thing, body) < INSIDE * body.radius
    return int((inside & (thing.points[:, 2] > height - RIM)).sum()) < LEAST_SIDE


def _distances(thing: Thing, body: Revolution) -> Array:
    """(n,) distance of the thing's points to the axis, m."""
    offsets = thing.points[:, :2] - body.centre
    return np.asarray(np.hypot(offsets[:, 0], offsets[:, 1]))


def _has_handle(thing: Thing, body: Revolution) -> bool:
    """Whether a narrow part stands out to one side."""
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
