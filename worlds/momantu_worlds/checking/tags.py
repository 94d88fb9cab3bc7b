"""Checks of tags: whether each is visible from a place that the robot can reach."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.scenes.geometry.bodies import Body, Picture

RINGS = (0.4, 0.7, 1.0, 1.4, 1.9, 2.5)
"""Distances from the tag along the floor that are tested, m. Few cameras read it from farther
away."""
RING = 0.15
"""Half the width of a ring, m."""
SECTORS = 24
"""Directions around the tag that are tested."""
SLANT = math.radians(75)
"""Largest viewing angle to the tag's normal, rad; beyond it the squares are too narrow to be
read."""
PAPER = 0.001
"""Distance of test points before the tag, m, so that the body that carries the tag does not hide
them."""
INSIDE = 0.95
"""Position of the points that must all be visible, as a share of the distance to the paper's
edge."""
GRID = np.array([(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)]) / 2
"""Of those points, for a paper with edges of 1."""


def tags(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that every tag is completely visible from some reachable point."""
    for body in scenario.bodies:
        if body.category == "tag" and scenario.robot.eyes:
            hidden = _hidden(scenario, body)
            if hidden is not None:
                why, cure = hidden
                yield FindingAtKeys(
                    Severity.ERROR,
                    "tag-unseen",
                    f"the camera cannot see {body.name}: {why}",
                    cure,
                    scenario.place(body.name),
                    about=(body.name,),
                )


def _hidden(scenario: Scenario, tag: Body) -> tuple[str, str] | None:
    """Why a tag is not visible, and what to do; None if it is visible."""
    points, normal = _points(tag)
    within = [
        name
        for name, solids in scenario.solids.items()
        if name != tag.name and any(solid.inside(points).any() for solid in solids)
    ]
    if within:
        return f"it is inside {within[0]}", f"move it out of {within[0]}"
    middle = points.mean(axis=0)
    stands = scenario.stands_near(middle, RINGS[-1] + RING)
    if len(stands) == 0:
        near = f" within {RINGS[-1]:g} m of it"
        return f"{scenario.robot.name} cannot get{near}", "move it to where the robot can get"
    before, blockers = False, Counter[str]()
    for ring in RINGS:
        eyes = _eyes(scenario, stands, middle, ring)
        rays = eyes - middle
        facing = rays @ normal >= math.cos(SLANT) * np.linalg.norm(rays, axis=1)
        if facing.any():
            before = True
            if _seen(scenario, eyes[facing], points, tag.name, blockers):
                return None
    if not before:
        return (
            "it faces away from where the robot can get",
            "turn it, or hang it the other way round",
        )
    blocker = min(blockers, key=lambda name: (-blockers[name], name))
    return f"{blocker} hides it", f"move the tag or {blocker}"


def _points(tag: Body) -> tuple[Array, Array]:
    """Points (9, 3) just before a tag's paper, and the direction that it faces, map."""
    part = next(part for part in tag.parts if isinstance(part.geometry, Picture))
    assert isinstance(part.geometry, Picture)
    map_from_paper = tag.map_from_body @ part.body_from_part
    flat = INSIDE * GRID * part.geometry.size
    own = np.column_stack([flat, np.full(len(flat), PAPER)])
    return map_from_paper.apply(own), map_from_paper.rotation[:, 2]


def _eyes(scenario: Scenario, stands: Array, middle: Array, ring: float) -> Array:
    """Possible camera positions (n, 3): one in each sector of a ring, at each camera height."""
    offsets = stands - middle[:2]
    off = np.abs(np.hypot(offsets[:, 0], offsets[:, 1]) - ring)
    around = np.flatnonzero(off <= RING)
    turns = np.arctan2(offsets[around, 1], offsets[around, 0])
    sectors = np.floor((turns + math.pi) / (2 * math.pi) * SECTORS).astype(int)
    order = np.lexsort((off[around], sectors))
    _, first = np.unique(sectors[order], return_index=True)
    spots = stands[around[order[first]]]
    return np.concatenate(
        [np.column_stack([spots, np.full(len(spots), eye)]) for eye in scenario.robot.eyes]
    )


def _seen(scenario: Scenario, eyes: Array, points: Array, tag: str, blockers: Counter[str]) -> bool:
    """Whether one of the eyes has a free line to all points; counts the bodies in the way."""
    origins = np.repeat(eyes, len(points), axis=0)
    rays = np.tile(points, (len(eyes), 1)) - origins
    at, which = scenario.hit(origins, rays, frozenset({tag}))
    blockers.update(name for name in which if name)
    return bool(np.isinf(at).reshape(len(eyes), len(points)).all(axis=1).any())
