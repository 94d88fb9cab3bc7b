"""Checks of bodies that overlap each other or the floor."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_worlds.checking.scenario import WALL, Scenario
from momantu_worlds.scenes.geometry.bodies import Body

TOUCHING = 0.005
"""m; a smaller overlap counts as contact."""


def overlaps(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Every two bodies that overlap, unless both are walls, and every body in the floor."""
    bodies = [body for body in scenario.bodies if scenario.solids[body.name]]
    for body in bodies:
        yield from _in_floor(scenario, body)
    for first, second in _near(scenario, bodies):
        if first.category == second.category == WALL:
            continue
        depth = _depth(scenario, first.name, second.name)
        if depth > TOUCHING:
            yield _overlap(scenario, first, second, depth)


def _near(scenario: Scenario, bodies: list[Body]) -> Iterator[tuple[Body, Body]]:
    """Pairs whose boxes overlap."""
    boxes = [[solid.box for solid in scenario.solids[body.name]] for body in bodies]
    low = np.array([np.min([b[0] for b in own], axis=0) for own in boxes]).reshape(-1, 3)
    high = np.array([np.max([b[1] for b in own], axis=0) for own in boxes]).reshape(-1, 3)
    for i, body in enumerate(bodies):
        rest = slice(i + 1, None)
        meet = (high[i] - TOUCHING > low[rest]) & (high[rest] - TOUCHING > low[i])
        for j in np.flatnonzero(meet.all(axis=1)):
            yield body, bodies[i + 1 + int(j)]


def _depth(scenario: Scenario, first: str, second: str) -> float:
    """How deep two bodies overlap at the worst of their parts, m."""
    return max(
        (
            ours.depth(theirs)
            for ours in scenario.solids[first]
            for theirs in scenario.solids[second]
            if ours.near(theirs, TOUCHING)
        ),
        default=0.0,
    )


def _overlap(scenario: Scenario, first: Body, second: Body, depth: float) -> FindingAtKeys:
    """Report it at the loose body, else at the one that is not a wall, else at the later one."""
    blamed, other = (first, second) if second.category == WALL else (second, first)
    if blamed.static and not other.static:
        blamed, other = other, blamed
    loose = not (first.static and second.static)
    return FindingAtKeys(
        Severity.ERROR if loose else Severity.WARNING,
        "overlap",
        f"{blamed.name} overlaps {other.name} by {100 * depth:.1f} cm",
        "physics would push them apart with force; move one of them"
        if loose
        else "move one of them, or make it smaller",
        scenario.place(blamed.name),
        about=(blamed.name, other.name),
        amount=depth,
    )


def _in_floor(scenario: Scenario, body: Body) -> Iterator[FindingAtKeys]:
    depth = -min(float(solid.box[0][2]) for solid in scenario.solids[body.name])
    if depth > TOUCHING and body.category != WALL:
        yield FindingAtKeys(
            Severity.WARNING if body.static else Severity.ERROR,
            "in-floor",
            f"{body.name} reaches {100 * depth:.1f} cm into the floor",
            "the floor is at height 0; lift it",
            scenario.place(body.name),
            about=(body.name,),
            amount=depth,
        )
