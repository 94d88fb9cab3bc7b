"""Tops that are drawn and touched at different heights: a thin plate makes them one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_worlds.sdf.body.bodies import ImportedBody
from momantu_worlds.sdf.body.level_tops import Top
from momantu_worlds.sdf.body.parts import MeshPart, Part, hull_of
from momantu_worlds.sdf.deviations import Deviations
from momantu_worlds.sdf.read.model import Box

SAME = 0.001
"""Heights that differ by no more are one, m."""
PAPER = 0.0005
"""Height above a top of what lies on it to be seen, such as a tag, m."""


def flush(
    bodies: Iterable[ImportedBody], tops: Mapping[str, Top], deviations: Deviations
) -> Iterator[ImportedBody]:
    """The bodies with tops that are touched where they are drawn; what lies on them is lifted."""
    uneven = {name: top for name, top in tops.items() if abs(top.drawn - top.touched) > SAME}
    for body in bodies:
        top = uneven.get(body.name)
        yield _lifted(body, uneven.values()) if top is None else _plated(body, top, deviations)


def _plated(body: ImportedBody, top: Top, deviations: Deviations) -> ImportedBody:
    """A body with a plate on the lower of both: to touch or to see."""
    thick, seen = abs(top.drawn - top.touched), top.drawn < top.touched
    deviations.changed(
        body.place,
        body.title,
        f"a top that is drawn at {top.drawn:.3f} m and touched at {top.touched:.3f} m",
        "it is drawn where it is touched" if seen else "it is touched where it is drawn",
    )
    plate, middle = Box((*top.size, thick)), top.height - thick / 2
    at = Pose2D(top.pose.x, top.pose.y, top.pose.yaw).transform()
    part = Part(
        plate,
        body.at.inverse() @ Transform((0.0, 0.0, middle)) @ at,
        visual=seen,
        collision=not seen,
        hulls=() if seen else (hull_of(plate),),
    )
    return replace(body, parts=(*body.parts, part))


def _lifted(body: ImportedBody, tops: Iterable[Top]) -> ImportedBody:
    """A body that lies on the lower of both heights of a top, put on the higher one."""
    points = [body.at.apply(p.body_from_part.apply(q)) for p in body.parts for q in _points(p)]
    if not points:
        return body
    low, high = (f(np.concatenate(points), axis=0) for f in (np.min, np.max))
    for top in tops:
        lowest = min(top.drawn, top.touched)
        x, y = (low + high)[:2] / 2
        away = top.pose.inverse() @ Pose2D(float(x), float(y))
        inside = abs(away.x) < top.size[0] / 2 and abs(away.y) < top.size[1] / 2
        if inside and lowest - 5 * SAME < low[2] < top.height:
            return body.lifted(top.height - float(low[2]) + PAPER)
    return body


def _points(part: Part) -> tuple[Array, ...]:
    """Points (n, 3) around a part, piece by piece."""
    if part.hulls or isinstance(part.solid, MeshPart):
        return part.hulls or (() if part.seen is None else (part.seen,))
    return (hull_of(part.solid),)
