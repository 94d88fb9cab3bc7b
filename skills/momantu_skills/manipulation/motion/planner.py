"""Plan a collision-free path to any of several goal postures, or out of a collision."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from momantu_bt.geometry import Array
from momantu_skills.manipulation.config import PlanningConfig
from momantu_skills.manipulation.model.collision import CollisionWorld
from momantu_skills.manipulation.model.group import Group

Valid = Callable[[Array], bool]

ROOM = 0.4
"""How far the first search may move slow joints beyond start and goals, scaled rad."""
LEAST_GAIN = 0.01
"""Least time that a shortcut must save, s."""
WIDE = 1.3 * np.pi
"""Range around the start in which endless joints are searched, rad."""

ou.setLogLevel(ou.LogLevel.LOG_NONE)  # it warns of every reseeding, which is what we want


LIFTS = (0.02, 0.04, 0.08)
"""Heights by which the tip is lifted first, m: most contacts are below it."""
RADII = (0.05, 0.1, 0.2, 0.35)
"""Sizes of random motions, scaled rad, from small to large."""
TRIES = 40
"""Number of random motions of each size."""


class Planner:
    """Paths for one group of joints. All random numbers come from `random`."""

    def __init__(self, group: Group, random: np.random.Generator, config: PlanningConfig) -> None:
        self.group, self.random, self.config = group, random, config

    def path(self, start: Array, goals: Sequence[Array], valid: Valid) -> Array | None:
        """Valid waypoints (k, n) from `start` to one of `goals`; None if no path was found.

        `start` must be valid. Invalid goals are skipped; endless joints of the others take the
        short way. First straight lines are tried, nearest goal first; then RRT-Connect (Kuffner and
        LaValle 2000) with slow joints kept near their positions; then RRT-Connect with their full
        range.
        """
        turned = [self.group.nearest_turn(np.asarray(goal), start) for goal in goals]
        ends = sorted((g for g in turned if valid(g)), key=lambda g: self.duration(start, g))
        for goal in ends:
            if self.straight(start, goal, valid):
                return np.array([start, goal])
        if not ends:
            return None
        for tight in (True, False):
            found = [self._search(start, ends, valid, tight) for _ in range(self.config.attempts)]
            paths = [self._shortened(path, valid) for path in found if path is not None]
            if paths:
                return min(paths, key=self.length)
        return None

    def duration(self, start: Array, goal: Array) -> float:
        """Seconds of a straight joint motion at full speed, without acceleration."""
        return float(np.max(np.abs(goal - start) / self.group.velocity))

    def length(self, path: Array) -> float:
        """Seconds that the segments of a path (k, n) take at full speed, one after the other."""
        steps = np.abs(np.diff(path, axis=0)) / self.group.velocity
        return float(steps.max(axis=1).sum())

    def straight(self, start: Array, goal: Array, valid: Valid) -> bool:
        """Whether the straight line in joint space is valid, both ends included."""
        return all(valid(q) for q in self.line(start, goal))

    def line(self, start: Array, goal: Array) -> Array:
        """Joints (k, n) along a straight line, at the configured distance between checks."""
        length = float(np.linalg.norm((goal - start) * self.group.scale))
        count = max(2, int(np.ceil(length / self.config.step)) + 1)
        return start + np.linspace(0.0, 1.0, count)[:, None] * (goal - start)

    def _search(
        self, start: Array, goals: Sequence[Array], valid: Valid, tight: bool
    ) -> Array | None:
        scale = self.group.scale
        space = ob.RealVectorStateSpace(len(start))
        bounds = self._bounds(start, goals, tight)
        space.setBounds(bounds)
        information = ob.SpaceInformation(space)
        n = len(start)
        information.setStateValidityChecker(lambda state: valid(np.array(state[0:n]) / scale))
        information.setStateValidityCheckingResolution(self.config.step / space.getMaximumExtent())
        information.setup()
        ou.RNG.setSeed(int(self.random.integers(1, 2**31)))
        problem = ob.ProblemDefinition(information)
        problem.addStartState(_state(space, start * scale))
        ends = ob.GoalStates(information)
        for goal in goals:
            ends.addState(_state(space, goal * scale))
        problem.setGoal(ends)
        planner = og.RRTConnect(information)
        planner.setRange(self.config.range)
        planner.setProblemDefinition(problem)
        planner.setup()
        planner.solve(ob.PlannerTerminationCondition(_Counter(self.config.searches)))
        if not problem.hasExactSolution():
            return None
        path = problem.getSolutionPath()
        simplifier = og.PathSimplifier(information)
        simplifier.partialShortcutPath(path, self.config.shortcut_rounds)
        simplifier.reduceVertices(path)
        return np.array([state[0:n] for state in path.getStates()]) / scale

    def _shortened(self, path: Array, valid: Valid) -> Array:
        """Replace parts of the path by straight lines that are valid and quicker, at random points.

        After Geraerts and Overmars, "Creating High-quality Paths for Motion Planning", 2007.
        """
        for _ in range(self.config.shortcut_rounds):
            if len(path) == 2:
                break
            i, j = sorted(self.random.uniform(0.0, len(path) - 1.0, 2))
            a, b = _at(path, i), _at(path, j)
            between = path[int(i) + 1 : int(np.ceil(j))]
            old = np.vstack([a, between, b])
            quicker = self.duration(a, b) < self.length(old) - LEAST_GAIN
            if len(between) and quicker and self.straight(a, b, valid):
                path = _distinct(np.vstack([path[: int(i) + 1], a, b, path[int(np.ceil(j)) :]]))
        return path

    def _bounds(self, start: Array, goals: Sequence[Array], tight: bool) -> ob.RealVectorBounds:
        scale = self.group.scale
        ends = np.vstack([start, *goals])
        lower = np.where(self.group.endless, start - WIDE, self.group.lower)
        upper = np.where(self.group.endless, start + WIDE, self.group.upper)
        if tight:
            slow = scale > 2.0
            lower = np.where(slow, np.maximum(lower, ends.min(axis=0) - ROOM / scale), lower)
            upper = np.where(slow, np.minimum(upper, ends.max(axis=0) + ROOM / scale), upper)
        bounds = ob.RealVectorBounds(len(start))
        for i in range(len(start)):
            bounds.setLow(i, float(min(lower[i], ends[:, i].min()) * scale[i]) - 1e-6)
            bounds.setHigh(i, float(max(upper[i], ends[:, i].max()) * scale[i]) + 1e-6)
        return bounds


def _at(path: Array, where: float) -> Array:
    """The point at a fractional waypoint number."""
    i = min(int(where), len(path) - 2)
    return np.asarray(path[i] + (where - i) * (path[i + 1] - path[i]))


def _distinct(path: Array) -> Array:
    """The path without repeated waypoints."""
    keep = np.ones(len(path), dtype=bool)
    keep[1:] = np.abs(np.diff(path, axis=0)).max(axis=1) > 1e-6
    return path[keep]


class _Counter:
    """Ends a search after a number of calls."""

    def __init__(self, most: int) -> None:
        self.left = most

    def __call__(self) -> bool:
        self.left -= 1
        return self.left < 0


def _state(space: ob.RealVectorStateSpace, values: Array) -> ob.State:
    state = space.allocState()
    for i, value in enumerate(values):
        state[i] = float(value)
    return state


def escape(
    group: Group,
    start: Array,
    world: CollisionWorld,
    bare: CollisionWorld,
    random: np.random.Generator,
) -> Array | None:
    """Joints (k, n) from a `start` in collision to a posture free in `world`, or None.

    `bare` is the same world without margin. On the way the robot touches nothing new in it: the
    motion only leaves contacts. It is first straight up, then small random motions of all joints.
    """
    allowed = set(bare.touching(start))
    for path in (*_lifts(group, start), *_wiggles(group, start, random)):
        if world.free(path[-1]) and all(set(bare.touching(q)) <= allowed for q in path):
            return path
    return None


def _lifts(group: Group, start: Array) -> list[Array]:
    paths = []
    for height in LIFTS:
        pose = group.tip_matrix(start)
        targets = np.repeat(pose[None], max(2, round(height / 0.01)), axis=0)
        targets[:, 2, 3] += np.linspace(0.0, height, len(targets) + 1)[1:]
        path, reached = group.trace(targets, start)
        if reached == len(targets):
            paths.append(np.vstack([start, path]))
    return paths


def _wiggles(group: Group, start: Array, random: np.random.Generator) -> list[Array]:
    paths = []
    for radius in RADII:
        for _ in range(TRIES):
            direction = random.normal(size=len(start))
            step = radius * direction / np.linalg.norm(direction) / group.scale
            end = np.clip(start + step, group.lower, group.upper)
            paths.append(start + np.linspace(0.0, 1.0, 5)[:, None] * (end - start))
    return paths
