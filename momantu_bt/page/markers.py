"""What skills drew, from above: for the page's map."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose2D, Transform

MOST = 5000
"""Most shapes on the page; later ones are left out, as a browser draws each."""


def marker_shapes(
    updates: Sequence[tuple[float, Mapping[str, Any], Pose2D]], end: float
) -> list[dict[str, Any]]:
    """Each shape with the times between which it is there.

    updates: times, messages of `/markers` and the pose of odom in the map then. Only markers in
    `map` and `odom` are drawn. end: time of the run's end, s.

    A shape has begin, end (s), points (x, y of the map, m), closed, color, and text or size (m);
    with a size, its points are dots.
    """
    shapes: list[dict[str, Any]] = []
    open_: dict[str, list[dict[str, Any]]] = {}
    for time, message, map_from_odom in updates:
        for entity in message["entities"]:
            for shape in open_.pop(entity["id"], ()):
                shape["end"] = min(shape["end"], round(time, 3))
            if entity["frame_id"] not in (MAP, ODOM) or len(shapes) >= MOST:
                continue
            placed = map_from_odom if entity["frame_id"] == ODOM else Pose2D(0.0, 0.0, 0.0)
            lifetime = entity["lifetime"]["sec"] + entity["lifetime"]["nsec"] * 1e-9
            until = time + lifetime if lifetime else end + 1.0
            new = [
                {"begin": round(time, 3), "end": round(until, 3), **shape}
                for shape in _shapes(entity, placed)
            ]
            open_[entity["id"]] = new
            shapes += new
    return shapes


def _shapes(entity: Mapping[str, Any], placed: Pose2D) -> Iterator[dict[str, Any]]:
    spheres = entity["spheres"]
    if spheres:
        points = [each["pose"]["position"] for each in spheres]
        yield _shape(points, placed, spheres[0]["color"], size=spheres[0]["size"]["x"])
    for line in entity["lines"]:
        if line["colors"]:  # the axes of a pose: each pair of points has its own
            for i in range(0, len(line["points"]), 2):
                yield _shape(line["points"][i : i + 2], placed, line["colors"][i])
        else:
            yield _shape(line["points"], placed, line["color"], closed=line["type"] == 1)
    for cube in entity["cubes"]:
        yield _shape(_outline(cube), placed, cube["color"], closed=True)
    for text in entity["texts"]:
        yield _shape([text["pose"]["position"]], placed, text["color"], text=text["text"])


def _outline(cube: Mapping[str, Any]) -> list[dict[str, float]]:
    """The corners of a box's bottom, around."""
    position, turn = cube["pose"]["position"], cube["pose"]["orientation"]
    pose = Transform(tuple(position[part] for part in "xyz"), tuple(turn[part] for part in "wxyz"))
    x, y, z = (cube["size"][part] / 2 for part in "xyz")
    corners = pose.apply([(-x, -y, -z), (x, -y, -z), (x, y, -z), (-x, y, -z)])
    return [{"x": float(each[0]), "y": float(each[1])} for each in corners]


def _shape(
    points: Sequence[Mapping[str, float]],
    placed: Pose2D,
    color: Mapping[str, float],
    **more: Any,
) -> dict[str, Any]:
    c, s = math.cos(placed.yaw), math.sin(placed.yaw)
    found = [
        [
            round(placed.x + c * each["x"] - s * each["y"], 3),
            round(placed.y + s * each["x"] + c * each["y"], 3),
        ]
        for each in points
    ]
    parts = ", ".join(str(round(255 * color[part])) for part in "rgb")
    return {"points": found, "color": f"rgba({parts}, {color['a']:g})", **more}
