"""The map of the page: floor plan, places, the robot's path, and objects as it believed them."""

from __future__ import annotations

import json
import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose2D
from momantu_bt.page.markers import marker_shapes
from momantu_bt.page.plan import plan_image
from momantu_bt.record.about import SITE
from momantu_bt.record.codec import CodecError, from_json
from momantu_bt.record.recording import Recording
from momantu_bt.world import Site

_MARGIN = 0.5
"""Margin around the drawing, m."""
_SMALLEST = 4.0
"""Smallest width and height of the picture, m."""


def floor(recording: Recording) -> dict[str, Any]:
    """Lengths in m, angles in rad, in the map's frame, or in odom without a map.

    image: the floor plan and where it lies. path: columns t, x, y, yaw. scenes: columns t and
    items: all objects that the robot believes in from t on; an object in the hand has no x and y.
    markers: what skills drew; see `marker_shapes`.
    bounds: left, bottom, right, top of the drawing; None if there is nothing to draw.
    """
    image = plan_image(recording)
    site = _site(recording)
    path = _path(recording)
    places = [{"name": name, "x": p.x, "y": p.y} for name, p in site.places.items()]
    surfaces = [_surface(name, surface) for name, surface in site.surfaces.items()]
    return {
        "image": image,
        "places": places,
        "surfaces": surfaces,
        "path": path,
        "scenes": _scenes(recording),
        "markers": _markers(recording),
        "bounds": _bounds(image, path, [*places, *surfaces]),
    }


def _site(recording: Recording) -> Site:
    """The site of the run; empty if the record does not have it."""
    text = recording.files.get(SITE)
    try:
        found = None if text is None else from_json(json.loads(text))
    except (CodecError, json.JSONDecodeError):
        found = None
    return found if isinstance(found, Site) else Site("")


def _surface(name: str, surface: Any) -> dict[str, Any]:
    pose = surface.map_from_surface
    return {
        "name": name,
        "x": pose.x,
        "y": pose.y,
        "yaw": pose.yaw,
        "size": list(surface.size),
        "round": getattr(surface, "round", False),
    }


def _path(recording: Recording) -> dict[str, list[float]]:
    """The base over time, from the moment at which odom's pose in the map is known."""
    rows = [(time, message) for time, message in _messages(recording, "/pose")]
    frame = MAP if any(message["frame_id"] == MAP for _, message in rows) else ODOM
    columns: dict[str, list[float]] = {"t": [], "x": [], "y": [], "yaw": []}
    for time, message in rows:
        if message["frame_id"] == frame:
            pose = _planar(message["pose"]["position"], message["pose"]["orientation"])
            for column, number in zip(
                columns.values(), (time, pose.x, pose.y, pose.yaw), strict=True
            ):
                column.append(round(number, 3))
    return columns


def _scenes(recording: Recording) -> dict[str, list[Any]]:
    """The believed objects and their poses, at each change."""
    updates: list[tuple[float, int, Mapping[str, Any]]] = [
        *((time, 0, message) for time, message in _messages(recording, "/tf")),
        *((time, 1, message) for time, message in _messages(recording, "/objects")),
    ]
    updates.sort(key=lambda update: update[:2])
    map_from_odom = Pose2D(0.0, 0.0, 0.0)
    items: dict[str, dict[str, Any]] = {}
    times: list[float] = []
    scenes: list[Any] = []
    for time, is_scene, message in updates:
        if not is_scene:
            map_from_odom = _newest(message["transforms"]) or map_from_odom
            continue
        for gone in message["deletions"]:
            items.pop(gone["id"], None)
        for entity in message["entities"]:
            items[entity["id"]] = _item(entity, map_from_odom)
        times.append(time)
        scenes.append(list(items.values()))
    return {"t": times, "items": scenes}


def _markers(recording: Recording) -> list[dict[str, Any]]:
    """The shapes that skills drew, with odom where it was believed to be at that time."""
    newest = ((time, _newest(m["transforms"])) for time, m in _messages(recording, "/tf"))
    known = [(time, pose) for time, pose in newest if pose is not None]
    times = [time for time, _ in known]
    updates = []
    for time, message in _messages(recording, "/markers"):
        at = max(0, bisect_right(times, time + 1e-6) - 1)
        updates.append((time, message, known[at][1] if known else Pose2D(0.0, 0.0, 0.0)))
    return marker_shapes(updates, recording.ticks[-1].now if recording.ticks else 0.0)


def _newest(transforms: Sequence[Mapping[str, Any]]) -> Pose2D | None:
    """The pose of odom in the map, if the message has it."""
    for each in transforms:
        if each["parent_frame_id"] == MAP and each["child_frame_id"] == ODOM:
            return _planar(each["translation"], each["rotation"])
    return None


def _item(entity: Mapping[str, Any], map_from_odom: Pose2D) -> dict[str, Any]:
    """An object from above; one whose frame is a link's is in the hand."""
    name = next((text["text"] for text in entity["texts"]), entity["id"])
    solids = [*entity["cubes"], *entity["cylinders"]]
    if entity["frame_id"] not in (MAP, ODOM) or not solids:
        return {"name": name}
    at = _planar(solids[0]["pose"]["position"], solids[0]["pose"]["orientation"])
    if entity["frame_id"] == ODOM:
        at = map_from_odom @ at
    size = max(solids[0]["size"]["x"], solids[0]["size"]["y"])
    return {"name": name, "x": round(at.x, 3), "y": round(at.y, 3), "size": size}


def _bounds(
    image: Mapping[str, Any] | None,
    path: Mapping[str, Sequence[float]],
    places: Iterable[Mapping[str, Any]],
) -> list[float] | None:
    """A rectangle around everything."""
    xs, ys = list(path["x"]), list(path["y"])
    for place in places:
        reach = max(place.get("size", (0.0,)))
        xs += [place["x"] - reach, place["x"] + reach]
        ys += [place["y"] - reach, place["y"] + reach]
    if image is not None:
        left, bottom, right, top = image["used"]
        xs += [left, right]
        ys += [bottom, top]
    if not xs:
        return None
    (left, right), (bottom, top) = (_widened(min(v), max(v)) for v in (xs, ys))
    return [round(number, 3) for number in (left, bottom, right, top)]


def _widened(low: float, high: float) -> tuple[float, float]:
    missing = max(2 * _MARGIN, _SMALLEST - (high - low)) / 2
    return low - missing, high + missing


def _messages(recording: Recording, topic: str) -> Iterator[tuple[float, Mapping[str, Any]]]:
    if topic in recording.topics():
        yield from recording.messages(topic)


def _planar(position: Mapping[str, float], rotation: Mapping[str, float]) -> Pose2D:
    """A pose seen from above; yaw as in `Transform.yaw`."""
    x, y, z, w = (rotation[part] for part in "xyzw")
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return Pose2D(position["x"], position["y"], yaw)
