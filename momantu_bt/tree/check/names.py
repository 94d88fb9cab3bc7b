"""Checks of what literals name: places, surfaces, poses, categories, plug-ins, spots on the map."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import is_dataclass
from typing import Any

from momantu_bt.detector import known_categories
from momantu_bt.formats.names import valid_names
from momantu_bt.formats.places import Place, within
from momantu_bt.geometry import Pose2D
from momantu_bt.skill import Port
from momantu_bt.tree.check.floor import FARTHEST
from momantu_bt.tree.check.signatures import Context
from momantu_bt.values.kinds import parts_of

_KINDS = {
    "place": ("place", "places"),
    "surface": ("surface", "surfaces"),
    "named_pose": ("named pose", "named poses"),
    "tag": ("tag", "tags"),
}


def check_named(context: Context, found: Any, place: Place, port: Port) -> None:
    """Check the names in a converted value, in lists and fields too, and a pose on the map."""
    for name, kind in _names_in(found, port.names):
        check_name(context, name, within(place, name, context.document.source), kind)
    if port.frame == "map" and isinstance(found, Pose2D):
        _check_on_map(context, found, place)


def _names_in(found: Any, kind: str | None) -> Iterator[tuple[str, str]]:
    """Each text that names something, with the kind of what it names."""
    if isinstance(found, str):
        if kind is not None:
            yield found, kind
    elif isinstance(found, tuple):
        for item in found:
            yield from _names_in(item, kind)
    elif is_dataclass(found) and not isinstance(found, type):
        for part in parts_of(type(found)):
            if part.names is not None:
                yield from _names_in(getattr(found, part.name), part.names)


def check_name(context: Context, name: str, place: Place, kind: str) -> None:
    """Check the name of something of the world or robot, or of a plug-in, if these are known."""
    if kind == "category":
        _check_category(context, name, place)
        return
    if kind == "taught":
        return
    also = ""
    if kind in ("goal", "spot"):
        if ";" in name:
            _check_pose_text(context, name, place, stands=kind == "goal")
            return
        kind, also = "place", "; or write a pose of the map as x;y;yaw"
    valid = context.names_of(kind)
    if valid is None or name in valid:
        return
    if kind not in _KINDS:
        message = f"no plug-in of {kind} is called {name!r}"
        hint = valid_names(name, valid, "installed")
        context.problems.error("unknown-plugin", place, message, hint)
        return
    one, several = _KINDS[kind]
    where = "the robot" if kind == "named_pose" else "the world"
    message = f"{where} has no {one} {name!r}"
    code = f"unknown-{one.replace(' ', '-')}"
    hint = context.meant_key(name, place) or valid_names(name, valid, several) + also
    context.problems.error(code, place, message, hint)


def _check_pose_text(context: Context, text: str, place: Place, *, stands: bool) -> None:
    """Check a pose that is written as a text, such as `1.5;2;0`."""
    try:
        pose = Pose2D.from_text(text)
    except ValueError as error:
        context.problems.error("wrong-value", place, str(error))
        return
    _check_on_map(context, pose, place, stands=stands)


def _check_category(context: Context, name: str, place: Place) -> None:
    """Warn of a category that neither the world nor a detector knows.

    A detector that does not say which categories it knows may know any.
    """
    objects = () if context.site is None else context.site.objects.values()
    told = [one.category for one in objects]
    if name in told:
        return
    known = known_categories()
    if known is None or name in known:
        return
    message = f"no detector knows the category {name!r}; anything of the given sizes counts as one"
    hint = valid_names(name, [*told, *known], "categories")
    context.problems.warning("unknown-category", place, message, hint)


def _check_on_map(context: Context, pose: Pose2D, place: Place, *, stands: bool = True) -> None:
    """Check that a pose lies on the map, and, if the robot is to stand there, on free floor."""
    floor = context.floor
    area = floor.area if floor is not None else None
    if context.site is not None and context.site.area is not None:
        area = context.site.area
    if area is None:
        return
    if not (area[0] <= pose.x <= area[2] and area[1] <= pose.y <= area[3]):
        message = f"x {pose.x:g} m, y {pose.y:g} m is outside the map"
        hint = f"it spans x from {area[0]:g} to {area[2]:g} m, y from {area[1]:g} to {area[3]:g} m"
        context.problems.error("outside-map", place, message, hint)
    elif stands and floor is not None and not floor.is_free(pose):
        message = f"the robot cannot stand at x {pose.x:g} m, y {pose.y:g} m, yaw {pose.yaw:g} rad"
        message += ": the map has no free floor there"
        free = floor.nearest_free(pose)
        hint = f"nothing is free within {FARTHEST:g} m of it"
        if free is not None:
            hint = f"the nearest free pose is {{x: {free.x:g}, y: {free.y:g}, yaw: {free.yaw:g}}}"
        context.problems.error("goal-blocked", place, message, hint)
