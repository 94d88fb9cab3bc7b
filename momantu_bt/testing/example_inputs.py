"""Sensible values for the inputs of a skill, made from the types of its ports."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.messages import DetectedObject, ObjectClass, SupportPlane
from momantu_bt.robot import RobotDescription
from momantu_bt.skill import Port, Skill
from momantu_bt.tree.show.skill_example import within
from momantu_bt.values import kinds
from momantu_bt.values.contents import freeze
from momantu_bt.values.kinds import ValueKind, ValueType, kind_of, parts_of, without_none
from momantu_bt.world import Site

_POSE = Pose(Transform((1.8, 0.1, 0.765)), "odom", 0.0)
_KNOWN: Mapping[Any, Any] = {
    bool: True,
    int: 1,
    float: 0.1,
    str: "text",
    kinds.CodeText: kinds.CodeText("NOT_FOUND"),
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
"""Values that are valid in `ExampleWorld`."""


class NoExample(Exception):
    """No example value is known for a port's type; the message names the port."""


def example_inputs(
    skill: type[Skill],
    site: Site,
    description: RobotDescription,
    given: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """`given` and an example value for each other required input.

    If inputs exclude each other, the first one gets a value.

    Raises:
        NoExample: no example is known for the type of an input.
    """
    having = dict(given or {})
    chosen = {group[0] for group in skill.one_of if not having.keys() & set(group)}
    for port in skill.ports.values():
        if port.name not in having and (port.required or port.name in chosen):
            having[port.name] = example_value(port, site, description)
    return having


def example_value(port: Port, site: Site, description: RobotDescription) -> Any:
    """An example value for an input; NoExample if none is known for its type."""
    named = {
        "place": site.known_places(),
        "surface": tuple(site.surfaces),
        "tag": tuple(site.tags),
        "named_pose": tuple(description.named_poses),
    }.get(port.names or "")
    if named:
        return named[0]
    try:
        value = of_type(port.type)
    except NoExample as error:
        raise NoExample(f"no example of the input {port.name!r}: {error}") from None
    return type(value)(within(value, port)) if port.bounded else value


def of_type(type_: ValueType) -> Any:
    """An example value of a type; NoExample if none is known."""
    return _of_kind(kind_of(type_))


def _of_kind(kind: ValueKind) -> Any:
    if isinstance(kind.type, type) and kind.type in _KNOWN:
        return _KNOWN[kind.type]
    match kind:
        case kinds.Anything() | kinds.Unknown():
            return "anything"
        case kinds.Either():
            return _of_kind(without_none(kind)[0])
        case kinds.Choice():
            return kind.values[0]
        case kinds.Enumeration():
            return next(iter(kind.type))
        case kinds.Text():
            return kind.type("text")
        case kinds.Items() | kinds.QueueOf():
            return (_of_kind(kind.item),)
        case kinds.Fixed():
            return tuple(map(_of_kind, kind.items))
        case kinds.Table():
            return MappingProxyType({_of_kind(kind.key): _of_kind(kind.item)})
        case kinds.Array():
            return freeze(np.zeros(3))
        case kinds.Record():
            lacking = [part for part in parts_of(kind.type) if part.required]
            return kind.type(**{part.name: _of_kind(part.kind) for part in lacking})
        case kinds.Nothing():
            return None
        case kinds.Truth() | kinds.Number() | kinds.Instance():
            raise NoExample(f"nothing is known of {kind.type!r}")
