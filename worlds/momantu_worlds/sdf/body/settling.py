"""Bodies on the floor: moved down to it; flat ones become visual only."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from momantu_bt.geometry import Array, Transform
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.parts import Part
from momantu_worlds.sdf.deviations import Deviations

FLAT = 0.03
"""Height below which the robot drives over a static part, m, such as a carpet or a marking."""
FLUSH = 0.002
"""Depth below the floor, m, down to which a part is still meant to be visible on it."""
DEEP = 0.02
"""Depth below the floor, m, down to which a loose body is set on it."""
LOW = 0.02
"""Height above the floor, m, from which a loose body is set on it: it would only drop there."""
WIDE, LIFTED = 10.0, (0.001, 0.003)
"""Least area of a wide part, m2; least height above the floor of parts on it, m: of wide ones, and
of parts on those. Two faces at the same height flicker in pictures."""


def settled(
    bodies: Iterable[ImportedBody], height: float, deviations: Deviations
) -> Iterator[ImportedBody]:
    """Bodies with the floor at z = 0; height: of the floor in the SDF world, m."""
    for body in bodies:
        lowered = body.lifted(-height) if height else body
        lowered = lowered if lowered.still else _raised(lowered, deviations)
        parts = tuple(_flattened(lowered, deviations)) if lowered.still else lowered.parts
        if parts:
            yield replace(lowered, parts=parts)


def _raised(body: ImportedBody, deviations: Deviations) -> ImportedBody:
    """A loose body near the floor: set on it, or held where it is if it is deep in it."""
    lowest = min((float(hull[:, 2].min()) for hull in body.hulls()), default=0.0)
    if FLUSH < lowest <= LOW:
        what = f"it begins {lowest:.3f} m above the floor"
        deviations.changed(body.place, body.title, what, "it stands on it")
        return body.lifted(-lowest)
    if lowest > -FLUSH:
        return body
    what = f"it begins {-lowest:.3f} m in the floor"
    if lowest > -DEEP:
        deviations.changed(body.place, body.title, what, "it stands on it")
        return body.lifted(-lowest)
    deviations.changed(body.place, body.title, what, "it stays there, as it would be thrown out")
    return replace(body, still=True, mass=None)


def _flattened(body: ImportedBody, deviations: Deviations) -> Iterator[Part]:
    for part in body.parts:
        if part.seen is not None:
            yield _visible(body, part, part.seen)
            continue
        around = np.concatenate(part.hulls) if part.hulls else None
        top = None if around is None else _height(body, part, around)
        if around is None or top is None or top > FLAT:
            yield part
            continue
        what = f"a part that lies flat on the floor, up to {top:.3f} m"
        if part.visual:
            deviations.changed(body.place, body.title, what, "it is seen, but not touched")
            yield _visible(body, replace(part, collision=False, hulls=()), around)
        else:
            deviations.dropped(body.place, body.title, what, "it is not touched")


def _visible(body: ImportedBody, part: Part, around: Array) -> Part:
    """A part that is flush with the floor, raised above it; around: points (n, 3) of it."""
    points = body.at.apply(part.body_from_part.apply(around))
    top, wide = float(points[:, 2].max()), float(np.ptp(points[:, :2], axis=0).prod()) > WIDE
    least = LIFTED[0] if wide else LIFTED[1]
    if not -FLUSH <= top < least:
        return part
    lift = Transform((0.0, 0.0, least - top))
    return replace(part, body_from_part=body.at.inverse() @ lift @ body.at @ part.body_from_part)


def _height(body: ImportedBody, part: Part, points: Array) -> float:
    """Height of the highest of some points of a part, m."""
    return float(body.at.apply(part.body_from_part.apply(points))[:, 2].max())
