"""A walker: goes from stop to stop, and gives way to the robot and to other walkers.

A kinematic body knows no mercy, so what real people do by themselves is a rule here: a walker
slows down before the robot, stands before it, steps back from what comes too near, and after a
while looks for another way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from momantu_bt.geometry import Array, Pose2D, wrap_angle
from momantu_worlds.scenes.geometry.bodies import Actor
from momantu_worlds.scenes.geometry.plane import Rectangle

RADIUS = 0.25
"""Half the width of a person's shoulders, m."""
STAND = 0.35
"""Gap to the robot at which a walker stands, m."""
SLOW = 0.8
"""Gap beyond `STAND` below which a walker who comes nearer slows down, m."""
TOO_NEAR = 0.2
"""Gap to the robot below which a walker steps back, m."""
STEP_BACK = 0.8
"""Speed of a step back, m/s; a robot that backs up is slower."""
APART = 0.9
"""Distance of two walkers' middles below which the later one waits for the earlier, m."""
CLOSE = 0.6
"""The same below which the earlier one waits too, m."""
RETRY = 1.0
"""How long a walker stands who finds no way, s."""
PATIENCE = 2.5
"""How long a walker waits before looking for another way, s."""
ACCELERATION = 2.0
"""How fast a walker gets faster, m/s2; who sees somebody stops within a step."""
TURNING = 3.0
"""Turning speed, rad/s."""
REACHED = 0.1
"""Distance from a corner of the way at which it counts as passed, m."""
AHEAD = 0.2
"""How far ahead a walker looks whether the next steps lead nearer to something, m."""
BEHIND = 0.9
"""Distance between two people of a group, m."""
LOOKS = 0.5
"""How often one of a group looks where the one before it is, s."""
HURRY, CATCH_UP = 1.15, 0.6
"""Speed of one of a group, relative to the one before it, and for the latter at least, m/s."""
SIDESTEPS = (0.0, 0.6, -0.6, 1.2, -1.2, 1.9, -1.9)
"""Directions of a step back that are tried, off the straight way back, rad."""

Point = tuple[float, float]


class Floor(Protocol):
    """Where a person can walk."""

    def free(self, point: Point) -> bool:
        """Whether a person can be there."""
        ...

    def way(self, start: Point, end: Point, around: Sequence[Point] = ()) -> Array:
        """Corners (n, 2) of a way; (0, 2) if there is none. around: others who stand there."""
        ...


@dataclass(frozen=True, slots=True)
class Seen:
    """What a walker sees: the robot's rectangles, its middle, and other people.

    earlier, later: those to whom it gives way, and those who give way to it. group: its own.
    """

    robot: Sequence[Rectangle]
    base: Point
    earlier: Sequence[Point] = ()
    later: Sequence[Point] = ()
    group: Sequence[Point] = ()

    def gap(self, point: Point) -> float:
        """Distance of a person at a point from the robot, m; infinite if it is far away."""
        at = np.array([point])
        nearest = min((float(each.distance(at)[0]) for each in self.robot), default=math.inf)
        return nearest - RADIUS


class Walker:
    """One person: pose, speed, and where it goes next. Advance it once per tick."""

    def __init__(
        self, actor: Actor, floor: Floor, start: Point, random: np.random.Generator
    ) -> None:
        self.name, self._actor, self._floor, self._random = actor.name, actor, floor, random
        self.pose = Pose2D(*start, float(random.uniform(-math.pi, math.pi)))
        self.speed = 0.0
        self._pace = self._drawn(actor.speed)
        self._way = np.zeros((0, 2))
        self._rests_until = self._drawn(actor.pause)
        self._waits_since: float | None = None

    @property
    def at(self) -> Point:
        """Where it is."""
        return self.pose.x, self.pose.y

    def advance(self, now: float, dt: float, seen: Seen) -> None:
        """Walk for `dt` s."""
        if seen.gap(self.at) < TOO_NEAR and self._steps_back(dt, seen):
            return
        if self._lets_pass(dt, seen):
            return
        if not len(self._way):
            self.speed = 0.0
            if now >= self._rests_until:
                self._sets_out(seen)
            return
        to = self._way[0]
        heading = math.atan2(to[1] - self.pose.y, to[0] - self.pose.x)
        allowed = min(self._pace, self._allowed(heading, seen))
        self.speed = min(allowed, self.speed + ACCELERATION * dt)
        self._moves(heading, min(self.speed * dt, math.dist(self.at, to)), dt)
        if math.dist(self.at, to) < REACHED:
            self._way = self._way[1:]
            if not len(self._way):
                self._rests_until = now + self._drawn(self._actor.pause)
        self._loses_patience(now, allowed, seen)

    def _allowed(self, heading: float, seen: Seen) -> float:
        """The speed at which nobody is bumped into, m/s."""
        ahead = (
            self.pose.x + AHEAD * math.cos(heading),
            self.pose.y + AHEAD * math.sin(heading),
        )
        gap, most = seen.gap(self.at), self._pace
        if gap < STAND + SLOW and seen.gap(ahead) < gap:
            most = self._pace * max(0.0, (gap - STAND) / SLOW)
        for others, least in ((seen.earlier, APART), (seen.later, CLOSE)):
            for other in others:
                off = math.dist(self.at, other)
                if off < least and math.dist(ahead, other) < off:
                    most = 0.0
        return most

    def _loses_patience(self, now: float, allowed: float, seen: Seen) -> None:
        if allowed > 0.1 or not len(self._way):
            self._waits_since = None
            return
        if self._waits_since is None:
            self._waits_since = now
        if now - self._waits_since > PATIENCE:
            self._waits_since = now
            self._sets_out(seen)

    def _sets_out(self, seen: Seen) -> None:
        """Choose another stop that a way leads to, around who stands there now."""
        around = [seen.base] if math.dist(seen.base, self.at) < 4.0 else []
        around += [p for p in (*seen.earlier, *seen.later) if math.dist(p, self.at) < 2.0]
        stops = [s for s in self._actor.stops if math.dist(s, self.at) > 2 * REACHED]
        for index in self._random.permutation(len(stops)).tolist():
            way = self._floor.way(self.at, stops[index], around)
            if len(way):
                self._way = way
                self._pace = self._drawn(self._actor.speed)
                return
        self._way = np.zeros((0, 2))
        self._rests_until += RETRY

    def _lets_pass(self, dt: float, seen: Seen) -> bool:
        """Make room for somebody of its own group; a leader does not."""
        return False

    def _steps_back(self, dt: float, seen: Seen) -> bool:
        """Step away from the robot, wherever there is room; whether there is any."""
        return self._steps_from(seen.base, dt, seen)

    def _steps_from(self, point: Point, dt: float, seen: Seen) -> bool:
        gap = seen.gap(self.at)
        away = math.atan2(self.pose.y - point[1], self.pose.x - point[0])
        for turn in SIDESTEPS:
            heading = away + turn
            step = STEP_BACK * dt
            there = (
                self.pose.x + step * math.cos(heading),
                self.pose.y + step * math.sin(heading),
            )
            nearer = math.dist(there, point) <= math.dist(self.at, point)
            if gap < TOO_NEAR:
                nearer = seen.gap(there) <= gap
            if nearer or not self._floor.free(there):
                continue
            if any(math.dist(there, p) < 2 * RADIUS for p in (*seen.earlier, *seen.later)):
                continue
            facing = self.pose.yaw
            self._moves(heading, step, dt)
            self.pose = Pose2D(self.pose.x, self.pose.y, facing)  # it keeps its eyes on the robot
            self.speed = 0.0
            return True
        return False

    def _moves(self, heading: float, step: float, dt: float) -> None:
        turn = float(np.clip(wrap_angle(heading - self.pose.yaw), -TURNING * dt, TURNING * dt))
        self.pose = Pose2D(
            self.pose.x + step * math.cos(heading),
            self.pose.y + step * math.sin(heading),
            wrap_angle(self.pose.yaw + turn),
        )

    def _drawn(self, bounds: tuple[float, float]) -> float:
        return float(self._random.uniform(*bounds))


class Leader(Protocol):
    """Whom somebody follows."""

    @property
    def at(self) -> Point:
        """Where it is."""
        ...

    @property
    def speed(self) -> float:
        """How fast it goes, m/s."""
        ...


class Follower(Walker):
    """Walks behind the one before it, and stops when that one stops."""

    def __init__(
        self,
        actor: Actor,
        floor: Floor,
        start: Point,
        random: np.random.Generator,
        before: Leader,
    ) -> None:
        super().__init__(actor, floor, start, random)
        self._before = before
        self._looks_at = 0.0

    @property
    def _behind(self) -> float:
        return math.dist(self.at, self._before.at)

    def advance(self, now: float, dt: float, seen: Seen) -> None:
        """Walk for `dt` s, not nearer to the one before than usual."""
        if now >= self._looks_at:
            self._looks_at = now + LOOKS
            self._sets_out(seen)
        if self._behind < BEHIND:
            self._way = np.zeros((0, 2))
        self._rests_until = math.inf
        self._pace = HURRY * max(self._before.speed, CATCH_UP)
        super().advance(now, dt, seen)

    def _sets_out(self, seen: Seen) -> None:
        """Go to where the one before is now."""
        far = self._behind > BEHIND
        self._way = self._floor.way(self.at, self._before.at) if far else np.zeros((0, 2))

    def _lets_pass(self, dt: float, seen: Seen) -> bool:
        """Make room for the one before, who comes back."""
        return self._behind < CLOSE and self._steps_from(self._before.at, dt, seen)
