"""Bodies on the floor: lowered to it, and what lies flat on it out of a robot's way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from momantu_bt.geometry import Transform
from momantu_worlds.sdf.bodies import ImportedBody
from momantu_worlds.sdf.findings import Findings
from momantu_worlds.sdf.parts import Part

FLAT = 0.03
"""m; a still part that ends below this height is driven over, as a carpet or a marking is."""
PAPER = 0.001
"""m; what is flush with the floor lies this much above it, to be seen."""


def settled(
    bodies: Iterable[ImportedBody], height: float, findings: Findings
) -> Iterator[ImportedBody]:
    """Bodies with the floor at z = 0; height: of the floor where they come from, m."""
    for body in bodies:
        lowered = body.lifted(-height) if height else body
        parts = tuple(_flattened(lowered, findings)) if body.still else body.parts
        if parts:
            yield replace(lowered, parts=parts)


def _flattened(body: ImportedBody, findings: Findings) -> Iterator[Part]:
    for part in body.parts:
        top = _top(body, part)
        if top is None or top > FLAT:
            yield part
            continue
        what = f"a part that lies flat on the floor, up to {top:.3f} m"
        if part.visual:
            findings.changed(body.place, body.title, what, "it is seen, but not touched")
            lift = Transform((0.0, 0.0, PAPER if abs(top) < PAPER else 0.0))
            at = body.at.inverse() @ lift @ body.at @ part.body_from_part
            yield replace(part, collision=False, hulls=(), body_from_part=at)
        else:
            findings.dropped(body.place, body.title, what, "it is not touched")


def _top(body: ImportedBody, part: Part) -> float | None:
    """Height of what is touched of a part, m; None when nothing is."""
    if not part.hulls:
        return None
    return max(
        float(body.at.apply(part.body_from_part.apply(hull))[:, 2].max()) for hull in part.hulls
    )
