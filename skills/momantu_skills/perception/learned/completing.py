"""Things of which a part is hidden, completed to the sizes that are asked for.

How far a thing goes on where it is hidden the network tells badly, but the asked sizes tell it.
Whether it can be the asked one, the depth says: its points lie on the asked body, and nothing is
seen through that body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from momantu_bt.categories import Symmetry
from momantu_bt.geometry import Array, Transform
from momantu_bt.messages import ObjectClass
from momantu_skills.perception.geometry.rectangles import smallest_rectangle
from momantu_skills.perception.learned.bodies import Body, asked_body
from momantu_skills.perception.learned.fusing import Look
from momantu_skills.perception.learned.refining import LEVEL
from momantu_skills.perception.learned.solids import UPRIGHT, Solid

LIKELY = 0.2
"""Least probability that a thing is of the asked category."""
LEAST = 40
"""Fewest points of a thing that is completed."""
ENDS = 2.0
"""Per cent of the points that noise puts beyond each end."""
AGREES = 0.015
"""Difference of what is seen of a side from its asked length up to which it is seen whole, m."""
WIDTH = 0.15
"""Share of the asked diameter by which that of a round thing may differ: as for what is not hidden.
"""
NEAR = 0.008
"""Distance from the body's surface up to which a point is on it, m."""
DEEP = 0.012
"""How far within a body, or behind it, a point contradicts it, m."""
EXPLAINED = 0.8
"""Least share of a thing's points that are on the body."""
OUTSIDE = 0.03
"""Share of a thing's points that may lie farther than AGREES outside the body."""
SIDE = 0.55
"""Least share that is on its surface, of a body within which something may be seen too."""
SOUND = 0.96
"""Least share, of what is seen on, in and through the body, that is on it."""
WORTH = 0.85
"""How well a body that agrees with all that is seen explains it: the rest may be otherwise."""


def completed(
    thing: Solid, asked: ObjectClass, symmetry: Symmetry, looks: Sequence[Look], level: float
) -> tuple[Solid, float] | None:
    """A thing as the asked one, and how well that explains what is seen, 0..1; None if it does not.

    symmetry: of the asked category. level: height of the surface, m. All in odom.
    """
    body = asked_body(asked, symmetry)
    likely = thing.chances.get(asked.category, 0.0)
    if body is None or likely < LIKELY or len(thing.points) < LEAST:
        return None
    eye = np.mean([look.eye for look in looks], axis=0)
    best: tuple[float, Body, Transform] | None = None
    for turned, pose in _placed(thing, body, eye, level):
        worth = _worth(turned, pose, thing.points, looks, level)
        if worth > (best[0] if best else 0.0):
            best = worth, turned, pose
    if best is None:
        return None
    worth, body, pose = best
    x, y, z = (2 * body.half).tolist()
    whole = replace(
        thing, category=asked.category, told=symmetry, frame_from_object=pose, size=(x, y, z)
    )
    return whole, WORTH * worth


def _placed(thing: Solid, body: Body, eye: Array, level: float) -> Iterator[tuple[Body, Transform]]:
    """Where the asked body may be, so that it shows the thing's points."""
    for turned, turn in _turned(thing, body):
        own = thing.points @ turn.rotation
        low, high = np.percentile(own, [ENDS, 100.0 - ENDS], axis=0)
        upright = abs(float(turn.rotation[2, 2])) > UPRIGHT
        if upright and abs(high[2] - level - 2 * turned.half[2]) > AGREES:
            continue
        if not _may_be(turned, high - low, thing):
            continue
        if not turned.round:
            across = [_middles(low[k], high[k], turned.half[k]) for k in (0, 1)]
        elif upright:
            across = _behind_its_side(own, turned.half[0], eye @ turn.rotation)
        else:
            across = _about_its_axis(thing, turned, turn, level)
        along = [level + turned.half[2]] if upright else _middles(low[2], high[2], turned.half[2])
        for middle in product(*across, along):
            yield turned, Transform(turn.rotation @ np.array(middle), turn.quaternion)


def _turned(thing: Solid, body: Body) -> Iterator[tuple[Body, Transform]]:
    """The body as it may be turned: its sides in the order of the turn's axes, and the turn."""
    turn = Transform((0.0, 0.0, 0.0), thing.frame_from_object.quaternion)
    if body.round:
        yield body, turn if thing.has_axis else Transform((0.0, 0.0, 0.0))
        return
    if thing.has_axis or not thing.upright:
        yaw = smallest_rectangle(thing.points[:, :2]).yaw
    else:
        yaw = turn.yaw
    turn = Transform.from_rpy((0.0, 0.0, 0.0), (0.0, 0.0, yaw))
    yield body, turn
    yield body._replace(half=body.half[[1, 0, 2]]), turn


def _may_be(body: Body, extent: Array, thing: Solid) -> bool:
    """Whether points of some extent (3,) may show the body: at most one of its sides is hidden.

    That is no round thing's diameter: its side tells it, also where a half of it is hidden.
    """
    sizes = 2 * body.half
    if (extent > sizes + NEAR).any():
        return False
    if body.round:
        wide = thing.size[0] if thing.has_axis else float(extent[:2].max())
        return abs(wide - float(sizes[0])) <= WIDTH * float(sizes[0])
    return int((sizes - extent > AGREES).sum()) <= 1


def _middles(low: float, high: float, half: float) -> list[float]:
    """Middles of a side of which the points from low to high are seen: it begins or ends there."""
    if abs(high - low - 2 * half) < AGREES:
        return [(low + high) / 2]
    return [low + half, high - half]


def _behind_its_side(own: Array, radius: float, eye: Array) -> list[list[float]]:
    """Middle (x, y) of an upright round body of which the side towards the eye is seen, m."""
    away = np.median(own[:, :2], axis=0) - eye[:2]
    away /= max(float(np.linalg.norm(away)), 1e-9)
    aside = np.array([-away[1], away[0]])
    nearest = float(np.percentile(own[:, :2] @ away, ENDS))
    left, right = np.percentile(own[:, :2] @ aside, [ENDS, 100.0 - ENDS])
    middle = (nearest + radius) * away + (left + right) / 2 * aside
    return [[float(place)] for place in middle]


def _about_its_axis(thing: Solid, body: Body, turn: Transform, level: float) -> list[list[float]]:
    """Middle (x, y) of a round body with the axis of a thing; one that is level lies, m."""
    at = thing.frame_from_object.position.copy()
    if abs(float(turn.rotation[2, 2])) < LEVEL:
        at[2] = level + body.half[0]
    return [[float(place)] for place in (turn.rotation.T @ at)[:2]]


def _worth(
    body: Body, pose: Transform, points: Array, looks: Sequence[Look], level: float
) -> float:
    """How well a body explains points (n, 3) and all that is seen, 0..1; 0 if that speaks against.

    Where something stands before it, nothing is known of it.
    """
    object_from_odom = pose.inverse()
    away = body.distances(object_from_odom.apply(points))
    if float((away > AGREES).mean()) > OUTSIDE:
        return 0.0
    explained = float((np.abs(away) < NEAR if body.solid else away < NEAR).mean())
    if explained < EXPLAINED or float((np.abs(away) < NEAR).mean()) < SIDE:
        return 0.0
    on = against = 0
    reach = float(np.linalg.norm(body.half))
    for look in looks:
        shift = (0.0, 0.0, level - look.height)
        eye, seen = look.eye + shift, look.points + shift
        ways = (seen - eye) / np.linalg.norm(seen - eye, axis=1)[:, None]
        aside = np.linalg.norm(np.cross(ways, pose.position - eye), axis=1)
        seen = object_from_odom.apply(seen[aside < reach])
        away = body.distances(seen)
        on += int((np.abs(away) < NEAR).sum())
        against += int((body.behind(object_from_odom.apply(eye), seen) > DEEP).sum())
        against += int((away < -DEEP).sum()) if body.solid else 0
    sound = on / max(on + against, 1)
    return explained * sound if sound > SOUND else 0.0
