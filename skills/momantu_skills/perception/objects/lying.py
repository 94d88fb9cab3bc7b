"""Bottles and cans that lie: their axis, radius and length by the points of all views.

A detector says that something lies. What it is like is measured here, as its axis is level and its
side a body of revolution: more exactly than a detector tells that looks at one picture at a time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.detector import View
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.geometry.revolution import Revolution, fit_revolution
from momantu_skills.perception.objects.matching import MatchConfig, score
from momantu_skills.perception.objects.shapes import NECK, Shape
from momantu_skills.perception.surface.planes import PlaneConfig, measure_support
from momantu_skills.perception.surface.segment import Thing, things_on

LEVEL = math.sin(math.radians(45.0))
"""Share of an axis along the vertical below which a detector says that a round thing lies."""
COARSE, SPREAD = math.radians(3.0), math.radians(33.0)
"""Step of the directions that are tried, and how far from the longest extent, rad: a side that the
camera does not see shortens a can."""
FINE = math.radians(1.0)
"""Step of the directions that are tried around the best of those, rad."""
MOST_POINTS = 600
"""Points that are fitted for each direction."""
MISFIT = 0.004
"""Median distance from the side up to which a body of revolution explains the points, m."""
OFF = 0.012
"""How far the axis may be from the radius above the surface, m; likewise the upper side."""
RADII = (0.015, 0.08)
"""Range of the radii of bottles and cans, m."""
LONGER = 1.15
"""A lying thing is longer than its diameter by this factor; else its axis cannot be told."""
ENDS = 1.0
"""Per cent of the points that noise puts beyond each end."""
WIDEST = 85.0
"""Percentile of the slices' radii that is the body's."""
NECK_SHARE = 0.2
"""Share of the length, at either end, by whose radius a neck is told."""
WITHIN = 0.03
"""How far outside the outline of a thing answers of a detector are about it, m."""
TOLERANCES = MatchConfig(relative=0.12, absolute=0.008)
"""The ends of what lies are seen less well than the height of what stands."""


@dataclass(frozen=True, slots=True)
class Lying:
    """A lying round thing. yaw: of its axis, towards the neck if it has one, rad.

    centre: (x, y) of its middle, m. radius, length: m. neck: whether one end is narrow.
    """

    yaw: float
    centre: tuple[float, float]
    radius: float
    length: float
    neck: bool


def remeasured(
    found: Sequence[DetectedObject],
    views: Sequence[View],
    low: float,
    high: float,
    asked: ObjectClass,
    accepted: float,
) -> tuple[DetectedObject, ...]:
    """The answers of a detector, with those about a thing that lies replaced by what it measures.

    low, high: heights between which the surface lies, m in odom. accepted: the least score of what
    counts as asked for. Where no answer is one about a lying thing, all stay as they are.
    """
    if not any(map(_lies, found)):
        return tuple(found)
    support = measure_support(views, low, high, PlaneConfig())
    if support is None:
        return tuple(found)
    left, measured = list(found), []
    for thing in things_on(support):
        about = [each for each in left if _is_about(each, thing)]
        if not any(map(_lies, about)):
            continue
        lying = measure(thing)
        if lying is None:
            continue
        left = [each for each in left if each not in about]
        measured.append(_answer(lying, support.height, support.stamp, asked, accepted))
    return tuple(sorted([*left, *measured], key=lambda each: -each.score))


def measure(thing: Thing) -> Lying | None:
    """The lying round thing that explains points on a surface; None if none does."""
    points = thing.points[:: -(-len(thing.points) // MOST_POINTS)]
    flat = points[:, :2] - points[:, :2].mean(axis=0)
    _, axes = np.linalg.eigh(flat.T @ flat)
    first = math.atan2(axes[1, 1], axes[0, 1])
    best = min(np.arange(-SPREAD, SPREAD, COARSE), key=lambda off: _misfit(points, first + off))
    yaw = min(
        np.arange(best - COARSE, best + COARSE, FINE),
        key=lambda off: _misfit(points, first + off),
    )
    return _lying(thing.points, first + float(yaw))


def _along(points: Array, yaw: float) -> Array:
    """Points (n, 3) as (aside, height, along) of a level axis at that yaw."""
    c, s = math.cos(yaw), math.sin(yaw)
    aside = -s * points[:, 0] + c * points[:, 1]
    return np.stack([aside, points[:, 2], c * points[:, 0] + s * points[:, 1]], axis=1)


def _misfit(points: Array, yaw: float) -> float:
    """Root mean square distance from the side, clipped, m; infinite where nothing fits."""
    found = fit_revolution(_along(points, yaw))
    if found is None:
        return math.inf
    return float(np.sqrt(np.minimum(found.residuals**2, (2 * MISFIT) ** 2).mean()))


def _lying(points: Array, yaw: float) -> Lying | None:
    own = _along(points, yaw)
    found = fit_revolution(own)
    if found is None or found.misfit > MISFIT:
        return None
    radius = _radius(found)
    low, high = np.percentile(own[:, 2], (ENDS, 100.0 - ENDS)).tolist()
    top = float(np.percentile(own[:, 1], 98.0))
    if not RADII[0] <= radius <= RADII[1] or high - low < LONGER * 2 * radius:
        return None
    if abs(float(found.centre[1]) - radius) > OFF or abs(top - 2 * radius) > OFF:
        return None
    ends = _end_radii(found, low, high)
    neck = min(ends) < NECK * radius
    if neck and ends[0] < ends[1]:
        yaw += math.pi
    c, s = math.cos(yaw), math.sin(yaw)
    aside, middle = float(found.centre[0]), (low + high) / 2
    if neck and ends[0] < ends[1]:
        aside, middle = -aside, -middle
    return Lying(yaw, (c * middle - s * aside, s * middle + c * aside), radius, high - low, neck)


def _radius(found: Revolution) -> float:
    radii = found.radii[~np.isnan(found.radii)]
    return float(np.percentile(radii, WIDEST))


def _end_radii(found: Revolution, low: float, high: float) -> tuple[float, float]:
    """Median radius near the lower and the upper end, m."""
    share, seen = NECK_SHARE * (high - low), ~np.isnan(found.radii)
    heights, radii = found.heights[seen], found.radii[seen]
    lower, upper = radii[heights < low + share], radii[heights > high - share]
    wide = float(np.median(radii))
    return (
        float(np.median(lower)) if len(lower) else wide,
        float(np.median(upper)) if len(upper) else wide,
    )


def _lies(each: DetectedObject) -> bool:
    upward = abs(float(each.pose.transform.rotation[2, 2]))
    return each.shape == "cylinder" and upward < LEVEL


def _is_about(each: DetectedObject, thing: Thing) -> bool:
    """Whether the middle of an answer lies over the points of a thing."""
    away = np.hypot(*(thing.points[:, :2] - each.pose.position[:2]).T)
    return bool(away.min() < WITHIN)


def _answer(
    lying: Lying, height: float, stamp: float, asked: ObjectClass, accepted: float
) -> DetectedObject:
    category = "bottle" if lying.neck else "can"
    wide = 2 * lying.radius
    size = (wide, wide, lying.length)
    shape = Shape("cylinder", category, lying.centre, lying.yaw, size, 0.0, 0.0, 0.0)
    worth = score(shape, asked, TOLERANCES)
    c, s = math.cos(lying.yaw), math.sin(lying.yaw)
    rotation = np.array([[0.0, -s, c], [0.0, c, s], [-1.0, 0.0, 0.0]])
    pose = Transform.from_rotation(rotation, (*lying.centre, height + lying.radius))
    if worth >= accepted:
        category = asked.category
    return DetectedObject(category, Pose(pose, ODOM, stamp), size, "cylinder", worth, height)
