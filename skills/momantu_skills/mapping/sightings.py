"""What the camera has been turned to on a growing map, and the tops that were seen on the way."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.world import Surface

with lazily():
    from momantu_skills.perception.surface import tops

LEVEL = 0.08
"""Largest difference in height of two sights of one top, m."""
BESIDE = 0.1
"""How far beside a top the middle of a part of it may seem to lie, m."""


@dataclass(slots=True)
class Sightings:
    """What was looked at in one run; poses are in the map.

    looks: the camera over the floor, and its direction. seen: tops that were seen from afar, and
    not measured yet. refused: those that are none, or that nobody gets near to.
    """

    looks: list[Pose2D] = field(default_factory=list)
    seen: list[tops.Top] = field(default_factory=list)
    refused: list[tops.Top] = field(default_factory=list)

    def forget(self) -> None:
        """As if nothing had been looked at."""
        self.looks.clear()
        self.seen.clear()
        self.refused.clear()

    def note(self, sights: Iterable[tops.Top], known: Iterable[Surface]) -> None:
        """Keep what is none of the known surfaces; of several sights of one top the largest."""
        named = [as_top(surface) for surface in known]
        for top in sights:
            if any(same(top, other) for other in (*self.refused, *named)):
                continue
            before = [other for other in self.seen if same(top, other)]
            if all(other.area < top.area for other in before):
                self.seen = [other for other in self.seen if other not in before]
                self.seen.append(top)

    def nearest(
        self, base: Pose2D, known: Iterable[Surface], fits: Callable[[tops.Top], bool]
    ) -> tops.Top | None:
        """Take out the top nearest to the base that fits and is new; None: none is left."""
        old = [*self.refused, *(as_top(surface) for surface in known)]
        self.seen = [top for top in self.seen if not any(same(top, other) for other in old)]
        best = min(
            filter(fits, self.seen), key=lambda top: base.distance_to(top.pose), default=None
        )
        if best is not None:
            self.seen.remove(best)
        return best


def as_top(surface: Surface) -> tops.Top:
    """A surface as if it had been seen whole."""
    width, depth = surface.size
    return tops.Top(surface.map_from_surface, surface.size, surface.height, width * depth)


def as_surface(top: tops.Top) -> Surface:
    """A top as a surface that may be approached from all four sides."""
    return Surface(top.pose, top.size, top.height, (0.0, math.pi / 2, -math.pi / 2, math.pi))


def same(one: tops.Top, other: tops.Top) -> bool:
    """Whether two may be sights of one top: the middle of one lies on the other, and as high."""
    if abs(one.height - other.height) > LEVEL:
        return False
    return _on(one, other.pose) or _on(other, one.pose)


def _on(top: tops.Top, point: Pose2D) -> bool:
    here = top.pose.inverse() @ point
    return abs(here.x) <= top.size[0] / 2 + BESIDE and abs(here.y) <= top.size[1] / 2 + BESIDE
