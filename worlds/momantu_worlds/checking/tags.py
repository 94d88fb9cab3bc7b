"""Checks of tags: whether each can be read from a place that the robot can reach."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array
from momantu_worlds.checking.legible import LEAST_CELL, cell_widths, least_light, light_on
from momantu_worlds.checking.scenario import Scenario
from momantu_worlds.scenes.catalogue.tags import cells_along
from momantu_worlds.scenes.geometry.bodies import Body, Part, Picture

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
    """Check that every tag can be read from some reachable point."""
    for body in scenario.bodies:
        if body.category == "tag" and scenario.robot.eyes:
            hidden = [_hidden(scenario, body, part) for part in body.parts]
            if hidden[0] is not None and all(each is not None for each in hidden):
                why, cure = hidden[0]
                yield FindingAtKeys(
                    Severity.ERROR,
                    "tag-unseen",
                    f"the camera cannot read {body.name}: {why}",
                    cure,
                    scenario.place(body.name),
                    about=(body.name,),
                )


def _hidden(scenario: Scenario, tag: Body, part: Part) -> tuple[str, str] | None:
    """Why a tag, or one of a bundle, cannot be read, and what to do; None if it can."""
    points, normal, cell = _points(tag, part)
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
    dark = _dark(scenario, middle, normal)
    if dark is not None:
        return dark
    return _from_stands(scenario, tag, points, normal, cell, stands)


def _dark(scenario: Scenario, middle: Array, normal: Array) -> tuple[str, str] | None:
    camera = scenario.robot.camera
    if camera is None:
        return None
    light, least = light_on(scenario.episode, middle, normal), least_light(camera.exposure)
    if light >= least:
        return None
    why = (
        f"it is too dark there from everywhere: the light on it is {light:.2g}, and"
        f" {scenario.robot.name}'s camera needs {least:.2g} at its longest exposure"
    )
    return (
        why,
        "put a lamp near it under `light`, or give the camera a longer exposure or more gain",
    )


def _from_stands(
    scenario: Scenario, tag: Body, points: Array, normal: Array, cell: float, stands: Array
) -> tuple[str, str] | None:
    """As `_hidden`, by looking from each of the stands."""
    middle, camera = points.mean(axis=0), scenario.robot.camera
    facing_eyes, small, blockers = 0, 0, Counter[str]()
    for ring in RINGS:
        eyes = _eyes(scenario, stands, middle, ring)
        rays = eyes - middle
        eyes = eyes[rays @ normal >= math.cos(SLANT) * np.linalg.norm(rays, axis=1)]
        if len(eyes) == 0:
            continue
        facing_eyes += len(eyes)
        free = eyes[_free(scenario, eyes, points, tag.name, blockers)]
        if len(free) == 0:
            continue
        if camera is None or (cell_widths(camera, free, middle, normal, cell).max() >= LEAST_CELL):
            return None
        small += len(free)
    if facing_eyes == 0:
        return (
            "it faces away from where the robot can get",
            "turn it, or hang it the other way round",
        )
    hidden = facing_eyes - small
    if not blockers or small > hidden:
        many = (
            f" from all {facing_eyes} points"
            if not hidden
            else (f" from {small} of {facing_eyes} points, and hidden from the others")
        )
        return f"it is too small{many} that the robot can look from", "print it larger"
    blocker = min(blockers, key=lambda name: (-blockers[name], name))
    many = f", and from {small} of {facing_eyes} points it is too small" if small else ""
    return f"{blocker} hides it{many}", f"move the tag or {blocker}"


def _points(tag: Body, part: Part) -> tuple[Array, Array, float]:
    """Points (9, 3) just before a tag's paper, the direction that it faces, map, and a cell, m."""
    assert isinstance(part.geometry, Picture)
    map_from_paper = tag.map_from_body @ part.body_from_part
    flat = INSIDE * GRID * part.geometry.size
    own = np.column_stack([flat, np.full(len(flat), PAPER)])
    cell = min(part.geometry.size) / cells_along(part.geometry.pixels)
    return map_from_paper.apply(own), map_from_paper.rotation[:, 2], cell


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


def _free(
    scenario: Scenario, eyes: Array, points: Array, tag: str, blockers: Counter[str]
) -> NDArray[np.bool_]:
    """Which eyes (n,) have a free line to all points; counts the bodies in the way."""
    origins = np.repeat(eyes, len(points), axis=0)
    rays = np.tile(points, (len(eyes), 1)) - origins
    at, which = scenario.hit(origins, rays, frozenset({tag}))
    blockers.update(name for name in which if name)
    return np.asarray(np.isinf(at).reshape(len(eyes), len(points)).all(axis=1))
