"""Sensible values for the inputs of a skill, made from the types of its ports."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from enum import Enum
from typing import Any, Literal, get_args

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import DetectedObject, ObjectClass, SupportPlane
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.show.skill_example import within
from momantu_bt.tree.types import is_union, origin, without_none
from momantu_bt.world import Site

_POSE = Pose(Transform((1.8, 0.1, 0.765)), "odom", 0.0)
_KNOWN: Mapping[Any, Any] = {
    bool: True,
    int: 1,
    float: 0.1,
    str: "text",
    object: "anything",
    Any: "anything",
    Transform: Transform(),
    Pose: _POSE,
    Pose2D: Pose2D(0.5, 0.0, 0.0),
    ObjectClass: ObjectClass("can", diameter=0.07, height=0.13),
    DetectedObject: DetectedObject("can", _POSE, (0.07, 0.07, 0.13), "cylinder", 0.9, 0.7),
    SupportPlane: SupportPlane(
        Pose(Transform((2.0, 0.0, 0.7)), "odom", 0.0),
        ((-0.4, -0.6), (0.4, -0.6), (0.4, 0.6), (-0.4, 0.6)),
    ),
}
"""Values that mean something in `ExampleWorld`."""


class NoExample(Exception):
    """No value of a port's type is known; the message says of which port."""


def example_inputs(
    skill: type[Skill],
    site: Site,
    description: RobotDescription,
    given: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """`given`, and a value for each other input that a tree would have to give.

    Of inputs that exclude each other it is the first.

    Raises:
        NoExample: nothing is known of the type of one of them.
    """
    having = dict(given or {})
    chosen = {group[0] for group in skill.one_of if not having.keys() & set(group)}
    for port in skill.ports.values():
        if port.name not in having and (port.required or port.name in chosen):
            having[port.name] = example_value(port, site, description)
    return having


def example_value(port: Port, site: Site, description: RobotDescription) -> Any:
    """A value for one input; NoExample when nothing is known of its type."""
    named = {
        "place": site.known_places(),
        "surface": tuple(site.surfaces),
        "named_pose": tuple(description.named_poses),
    }.get(port.names or "")
    if named:
        return named[0]
    try:
        value = of_type(port.type)
    except NoExample as error:
        raise NoExample(f"no example of the input {port.name!r}: {error}") from None
    return type(value)(within(value, port)) if port.bounded else value


def of_type(type_: Any) -> Any:
    """Some value of a type; NoExample when nothing is known of it."""
    if isinstance(type_, typing.Hashable) and type_ in _KNOWN:
        return _KNOWN[type_]
    if is_union(type_):
        return of_type(without_none(type_)[0])
    if origin(type_) is Literal:
        return get_args(type_)[0]
    if origin(type_) is tuple:
        items = get_args(type_)
        return tuple(of_type(item) for item in items if item is not Ellipsis)
    if isinstance(type_, type) and issubclass(type_, Enum):
        return next(iter(type_))
    if isinstance(type_, type) and issubclass(type_, str):
        return type_("text")
    if dataclasses.is_dataclass(type_) and isinstance(type_, type):
        return _of_dataclass(type_)
    raise NoExample(f"nothing is known of {type_!r}")


def _of_dataclass(type_: type) -> Any:
    hints = typing.get_type_hints(type_)
    lacking = [
        field.name
        for field in dataclasses.fields(type_)
        if field.init
        and field.default is dataclasses.MISSING
        and field.default_factory is dataclasses.MISSING
    ]
    return type_(**{name: of_type(hints[name]) for name in lacking})
