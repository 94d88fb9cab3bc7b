"""The paint of loose objects: bands around them, labels on one side, painted parts.

Paint is visible but never collides: a label is half a millimetre thick.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from momantu_bt.geometry import Transform
from momantu_worlds.scenes.catalogue.lathe import Profile, lathe, panel
from momantu_worlds.scenes.geometry.bodies import Color, Part

PAPER = 0.0005
"""m; thickness of a label."""
LABEL = 2.0
"""rad; how far a label on one side reaches around a round thing."""


@dataclass(frozen=True, slots=True)
class Band:
    """A stripe around a thing between two shares of its height."""

    low: float
    high: float
    color: Color


@dataclass(frozen=True, slots=True)
class Look:
    """Paint of a thing. color: of its body. trim: of a can's ends, a bottle's cap, a mug's inside.

    bands: later ones cover earlier ones. label: a band that covers one side alone.
    """

    color: Color
    trim: Color
    bands: tuple[Band, ...] = ()
    label: Band | None = None

    def at(self, share: float) -> Color:
        """The colour around a thing at a share of its height."""
        covering = [band.color for band in self.bands if band.low <= share < band.high]
        return covering[-1] if covering else self.color


def painted(profile: Profile, height: float, look: Look) -> Iterator[Part]:
    """The surface that a profile sweeps around z, cut where its colour changes."""
    borders = sorted({edge * height for band in look.bands for edge in (band.low, band.high)})
    piece: list[tuple[float, float]] = []
    color: Color | None = None
    for start, end in pairwise(_cut(profile, borders)):
        here = look.at((start[1] + end[1]) / 2 / height)
        if here != color:
            if color is not None:
                yield seen(piece, color)
            piece, color = [start], here
        piece.append(end)
    if color is not None:
        yield seen(piece, color)


def seen(profile: Profile, color: Color) -> Part:
    """The surface that a profile sweeps around z, in one colour, to look at alone."""
    return Part(lathe(profile), Transform(), color, collision=False)


def label(radius: float, height: float, look: Look) -> Iterator[Part]:
    """The label on one side of a round thing whose radius is the same all along it."""
    if look.label is not None:
        low, high = look.label.low * height, look.label.high * height
        sheet = panel(radius + PAPER, low, high, LABEL)
        yield Part(sheet, Transform(), look.label.color, collision=False)


def _cut(profile: Profile, borders: list[float]) -> list[tuple[float, float]]:
    """The profile with a point at every height in `borders` that it passes."""
    points = [profile[0]]
    for (r0, z0), (r1, z1) in pairwise(profile):
        between = [z for z in borders if min(z0, z1) < z < max(z0, z1)]
        for z in between if z0 < z1 else reversed(between):
            points.append((r0 + (r1 - r0) * (z - z0) / (z1 - z0), z))
        points.append((r1, z1))
    return points
