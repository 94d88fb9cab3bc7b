"""Checks of loose objects: whether they stand on something."""

from __future__ import annotations

import math
from collections.abc import Iterator

import cv2
import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.solids import FLUSH

FROM_ABOVE = 0.002
"""Height above a body's lowest points, m, at which the search for its support starts."""
FALL = 3.0
"""Depth below a body of the search for its support, m."""
TIPPING = 0.003
"""Tolerance of a body's centre beyond its support, m, and the sampling step of its outline."""
MOST_STEPS = 1000
"""Most steps along the outline of a large body."""
WITHIN, COARSE = (0.0, 0.25, 0.5, 0.75), 8
"""Scales of the outline, and the step along it, at which the inside of the bottom is sampled: a
tray may stand on a narrow foot."""


def upright(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that every loose body is supported from below, under its centre."""
    for body in scenario.bodies:
        if body.static or not scenario.solids[body.name]:
            continue
        points = _lowest(scenario, body)
        fall, below = _falls(scenario, body, points)
        carried = points[fall <= FLUSH]
        if len(carried) == 0:
            nearest = int(fall.argmin())
            yield _remark(
                scenario,
                body,
                "in-the-air",
                f"{body.name} starts {100 * float(fall[nearest]):.1f} cm above {below[nearest]}",
                "it would fall when the episode begins; set it down on something",
                float(fall[nearest]),
            )
        elif (beyond := _beyond(carried, _middle(scenario, body))) > TIPPING:
            under = below[int(fall.argmin())]
            yield _remark(
                scenario,
                body,
                "over-the-edge",
                f"the middle of {body.name} is {100 * beyond:.1f} cm beyond the edge of {under}",
                "it would tip over; move it onto what carries it",
                beyond,
            )


def _lowest(scenario: Scenario, body: Body) -> Array:
    """Points (n, 3) on the whole bottom of a body."""
    solids = scenario.solids[body.name]
    height = min(float(solid.box[0][2]) for solid in solids) + FLUSH
    return np.concatenate([_bottom(s.vertices[s.vertices[:, 2] <= height]) for s in solids])


def _bottom(corners: Array) -> Array:
    """Points (n, 3) along the outline of corners (m, 3) that lie level, and within it."""
    if len(corners) < 3:
        return corners
    order = cv2.convexHull(corners[:, :2].astype(np.float32), returnPoints=False)[:, 0]
    edges = np.roll(corners[order], -1, axis=0) - corners[order]
    lengths = np.linalg.norm(edges, axis=1)
    step = max(TIPPING, float(lengths.sum()) / MOST_STEPS)
    outline = np.concatenate(
        [
            corner + np.linspace(0.0, 1.0, math.ceil(length / step) + 1)[:-1, None] * edge
            for corner, edge, length in zip(corners[order], edges, lengths, strict=True)
        ]
    )
    middle = outline.mean(axis=0)
    within = [middle + share * (outline[::COARSE] - middle) for share in WITHIN]
    return np.concatenate([corners, outline, *within])


def _falls(scenario: Scenario, body: Body, points: Array) -> tuple[Array, list[str]]:
    """Distance from each point down to the next body, m, and that body."""
    origins = points + np.array([0.0, 0.0, FROM_ABOVE])
    rays = np.tile((0.0, 0.0, -FALL), (len(points), 1))
    at, which = scenario.hit(origins, rays, frozenset({body.name}))
    above_floor = origins[:, 2]
    deep = np.where(np.isinf(at), np.inf, at * FALL)
    names = [w if d <= z else "the floor" for w, d, z in zip(which, deep, above_floor, strict=True)]
    return np.minimum(deep, above_floor) - FROM_ABOVE, names


def _middle(scenario: Scenario, body: Body) -> Array:
    """The middle (2,) of a body on the floor plan."""
    points = np.concatenate([solid.vertices for solid in scenario.solids[body.name]])
    return np.asarray((points.min(axis=0) + points.max(axis=0))[:2] / 2)


def _beyond(carried: Array, middle: Array) -> float:
    """Distance of a point from the hull of the supporting points, m; at most 0 inside."""
    hull = cv2.convexHull((carried[:, :2] - middle).astype(np.float32))
    return -float(cv2.pointPolygonTest(hull, (0.0, 0.0), True))


def _remark(
    scenario: Scenario, body: Body, code: str, message: str, cure: str, amount: float
) -> FindingAtKeys:
    return FindingAtKeys(
        Severity.ERROR,
        code,
        message,
        cure,
        scenario.place(body.name),
        about=(body.name,),
        amount=amount,
    )
