"""What moves around the base: found in laser scans, and predicted a second ahead.

A cluster of hits counts as moving only if it got on evenly for a second, if beams now pass where it
was, and if beams then passed where it is now; it may hide one of these places itself. So what a
moving base sees of standing things, whose edges and gaps wander, does not count.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from momantu_bt.geometry import Array, Pose2D, wrap_angle
from momantu_skills.navigation.map.sensing import Rays

REACH = 5.0
"""Range up to which moving things are looked for, m."""
SPLIT = 0.25
"""Distance of neighbouring hits at which one thing ends and the next begins, m."""
LEGS = 0.45
"""Distance of two small things below which they are the legs of one person, m."""
WIDEST = 0.9
"""Widest thing that can be a person, m."""
FEWEST = 2
"""Fewest hits of a thing."""
JUMP = 0.3
"""Largest distance of a thing from where it was expected, m."""
SPAN = 1.0
"""Time over which a motion is measured, s."""
LEAST_SEEN = 6
"""Fewest scans in this time in which it was seen."""
LEAST_WAY = 0.25
"""Shortest way in this time, m."""
LEAST_SHARE = 0.3
"""Least share of the way in each half of the time."""
STRAIGHT = 0.8
"""Largest angle between the ways of both halves, rad."""
BEYOND = 0.3
"""How far a beam must get beyond a place that it passes, m."""
BESIDE = 0.1
"""Half width of a place that beams pass, m."""
CONFIRMED = 3
"""Scans in a row in which a thing must have got on so: corners that a robot passes do it once or
twice."""
LOST = 0.5
"""Time without a sight after which a thing is forgotten, s."""
RADIUS = 0.3
"""Radius of somebody who walks, m: the laser sees legs, and arms swing."""
AHEAD = 1.0
"""How far ahead motion is predicted, s."""
FASTEST = 2.0
"""Largest speed of a person, m/s."""


@dataclass(frozen=True, slots=True, eq=False)
class _Scan:
    """A scan where it was taken: `odom_from_base`, bearings in odom (n,), and lengths (n,), m."""

    time: float
    origin: tuple[float, float]
    bearings: Array
    lengths: Array

    def passes(self, place: Array, but: Array | None = None) -> bool:
        """Whether all beams towards a place (2,) get beyond it, and there are some.

        but: beams that end near this place (2,) do not count: there is what hides the other.
        """
        dx, dy = float(place[0]) - self.origin[0], float(place[1]) - self.origin[1]
        away = math.hypot(dx, dy)
        if away < 0.3:
            return False
        off = np.abs(np.angle(np.exp(1j * (self.bearings - math.atan2(dy, dx)))))
        towards = off < math.asin(min(1.0, BESIDE / away))
        beyond = self.lengths[towards] > away + BEYOND
        if but is not None:
            reach = np.minimum(self.lengths[towards], 2.0 * REACH)
            ways = np.stack([np.cos(self.bearings[towards]), np.sin(self.bearings[towards])])
            ends = np.array(self.origin)[:, None] + ways * reach
            beyond |= np.hypot(*(ends - but[:, None])) < LEGS
        return bool(len(beyond) > 0 and beyond.all())


@dataclass(slots=True)
class _Track:
    """A thing, by the times and places (odom) at which it was seen.

    velocity: m/s, or None; confirmed: scans in a row in which it had one.
    """

    times: deque[float] = field(default_factory=deque)
    places: deque[Array] = field(default_factory=deque)
    velocity: Array | None = None
    confirmed: int = 0

    @property
    def walks(self) -> bool:
        """Whether it surely moves."""
        return self.confirmed >= CONFIRMED

    def expected(self, now: float) -> Array:
        """Where it should be now."""
        still = np.zeros(2) if self.velocity is None else self.velocity
        return np.asarray(self.places[-1] + still * (now - self.times[-1]))


class Movers:
    """Keeps track of what moves; places are in odom, which does not jump."""

    def __init__(self) -> None:
        self._tracks: list[_Track] = []
        self._scans: deque[_Scan] = deque()
        self.left: list[Array] = []
        """Places (odom) that moving things have left since the last scan, as far as known."""

    def see(self, now: float, odom_from_base: Pose2D, rays: Rays) -> None:
        """Take a scan into account. now: its time, s."""
        if self._scans and now - self._scans[-1].time < 0.04:
            return
        scan = _placed(now, odom_from_base, rays)
        self._scans.append(scan)
        while now - self._scans[0].time > SPAN + 0.15:
            self._scans.popleft()
        self._follow(now, _things(odom_from_base, rays))
        self.left = []
        kept = []
        for track in self._tracks:
            gone = now - track.times[-1] > LOST
            if track.walks:
                self.left += [track.places[0], track.places[-1]]
            if not gone:
                track.velocity = self._velocity(track, now)
                track.confirmed = 0 if track.velocity is None else track.confirmed + 1
                kept.append(track)
        self._tracks = kept

    def moving(self, now: float) -> Array:
        """What moves: rows of x, y (odom, m), and velocity along both, m/s: (n, 4)."""
        rows = [
            np.concatenate([track.expected(now), track.velocity])
            for track in self._tracks
            if track.velocity is not None and track.walks
        ]
        return np.array(rows).reshape(-1, 4)

    def _follow(self, now: float, things: list[Array]) -> None:
        """Give each track the nearest thing; things of no track begin one."""
        free = list(things)
        for track in self._tracks:
            if not free:
                break
            away = [float(np.hypot(*(thing - track.expected(now)))) for thing in free]
            best = int(np.argmin(away))
            if away[best] < JUMP:
                track.times.append(now)
                track.places.append(free.pop(best))
            while now - track.times[0] > SPAN:
                if len(track.times) == 1:
                    break
                track.times.popleft()
                track.places.popleft()
        self._tracks += [_Track(deque([now]), deque([thing])) for thing in free]

    def _velocity(self, track: _Track, now: float) -> Array | None:
        """Its velocity (2,), m/s, if it surely moves."""
        if len(track.times) < LEAST_SEEN or now - track.times[-1] > 0.15:
            return track.velocity if now - track.times[-1] <= LOST else None
        first, last = track.places[0], track.places[-1]
        way, span = last - first, track.times[-1] - track.times[0]
        if span < 0.6 * SPAN or float(np.hypot(*way)) < LEAST_WAY * span / SPAN:
            return None
        middle = track.places[len(track.places) // 2]
        one, two = middle - first, last - middle
        whole = float(np.hypot(*way))
        if min(float(np.hypot(*one)), float(np.hypot(*two))) < LEAST_SHARE * whole:
            return None
        turn = wrap_angle(math.atan2(two[1], two[0]) - math.atan2(one[1], one[0]))
        if abs(turn) > STRAIGHT or whole > FASTEST * span:
            return None
        if track.velocity is None:
            then = min(self._scans, key=lambda scan: abs(scan.time - track.times[0]))
            here = self._scans[-1]
            comes = then.passes(last) and here.passes(first, last)
            goes = here.passes(first) and then.passes(last, first)
            if not (comes or goes):
                return None
        return np.asarray(way / span)


def _placed(now: float, pose: Pose2D, rays: Rays) -> _Scan:
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    x = pose.x + c * float(rays.origin[0]) - s * float(rays.origin[1])
    y = pose.y + s * float(rays.origin[0]) + c * float(rays.origin[1])
    bearings = np.arctan2(rays.directions[:, 1], rays.directions[:, 0]) + pose.yaw
    return _Scan(now, (x, y), bearings, np.where(rays.hit, rays.ranges, np.inf))


def _things(pose: Pose2D, rays: Rays) -> list[Array]:
    """Middles (2,) in odom of what is as wide as a person at most, beam by beam."""
    points = rays.points()
    if not len(points):
        return []
    ends = np.flatnonzero(np.hypot(*np.diff(points, axis=0).T) > SPLIT) + 1
    pieces = [piece for piece in np.split(points, ends) if len(piece) >= FEWEST]
    small = [
        piece
        for piece in pieces
        if float(np.hypot(*np.ptp(piece, axis=0))) < WIDEST
        and float(np.hypot(*(piece.mean(axis=0) - rays.origin))) < REACH
    ]
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    turn = np.array([[c, s], [-s, c]])
    return [np.asarray(m @ turn + (pose.x, pose.y)) for m in _with_legs(small)]


def _with_legs(pieces: Iterable[Array]) -> list[Array]:
    """Middles of pieces; neighbours that are as near as two legs count as one."""
    merged: list[Array] = []
    for piece in pieces:
        if merged:
            both = np.concatenate([merged[-1], piece])
            apart = float(np.hypot(*(merged[-1].mean(axis=0) - piece.mean(axis=0))))
            if apart < LEGS and float(np.hypot(*np.ptp(both, axis=0))) < WIDEST:
                merged[-1] = both
                continue
        merged.append(piece)
    return [0.5 * (piece.min(axis=0) + piece.max(axis=0)) for piece in merged]
