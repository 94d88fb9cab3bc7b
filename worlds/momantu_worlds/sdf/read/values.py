"""Numbers, vectors, poses and colours of an SDF file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from momantu_bt.formats.places import Place
from momantu_bt.geometry import Transform
from momantu_worlds.sdf.read.document import Element

FARTHEST = 1e5
"""Largest length or coordinate, m; a larger one is a mistake."""
COUNT_OF_POSE = 6
_TRUE, _FALSE = ("true", "1"), ("false", "0", "")


@dataclass(frozen=True, slots=True)
class Pose:
    """A pose as written: relative to the frame `relative_to`, or to the usual one if that is empty.

    old: the frame is given as before SDF 1.7, when Gazebo accepted missing frames.
    """

    place: Place
    transform: Transform = field(default_factory=Transform)
    relative_to: str = ""
    old: bool = False


def numbers(element: Element, count: int | None = None) -> tuple[float, ...]:
    """The finite numbers in an element's text.

    Raises:
        SdfError: something else stands there, or another count of them.
    """
    values = []
    for word in element.text.split():
        try:
            value = float(word)
        except ValueError:
            raise element.error(f"<{element.tag}> has {word!r}; expected a number") from None
        if not math.isfinite(value):
            raise element.error(f"<{element.tag}> has {word!r}; expected a finite number")
        values.append(value)
    if count is not None and len(values) != count:
        raise element.error(f"<{element.tag}> has {len(values)} numbers; expected {count}")
    return tuple(values)


def number(parent: Element, path: str, default: float) -> float:
    """The number in a child, or the default when there is none."""
    element = parent.find(path)
    return default if element is None or not element.text else numbers(element, 1)[0]


def vector(parent: Element, path: str, default: Sequence[float]) -> tuple[float, ...]:
    """The numbers in a child, as many as the default has."""
    element = parent.find(path)
    if element is None or not element.text:
        return tuple(default)
    return numbers(element, len(default))


def length(parent: Element, tag: str) -> float:
    """A length above zero that has to be there."""
    return lengths(parent, tag, 1)[0]


def lengths(parent: Element, tag: str, count: int) -> tuple[float, ...]:
    """Lengths above zero that have to be there.

    Raises:
        SdfError: the child is missing, or a length is not possible.
    """
    element = parent.child(tag)
    if element is None:
        raise parent.error(f"<{parent.tag}> needs a <{tag}>")
    values = numbers(element, count)
    wrong = [value for value in values if not 0.0 < value < FARTHEST]
    if wrong:
        raise element.error(f"<{tag}> has {wrong[0]:g}; expected a length above 0, in m")
    return values


def flag(parent: Element, path: str, default: bool = False) -> bool:
    """The truth value in a child.

    Raises:
        SdfError: something else stands there.
    """
    element = parent.find(path)
    if element is None:
        return default
    text = element.text.lower()
    if text not in (*_TRUE, *_FALSE):
        raise element.error(f"<{element.tag}> has {element.text!r}; expected true or false")
    return text in _TRUE


def name_of(element: Element) -> str:
    """The element's name.

    Raises:
        SdfError: it has none.
    """
    name = element.attributes.get("name", "").strip()
    if not name:
        raise element.error(f"<{element.tag}> needs a name='…'")
    return name


def pose_of(parent: Element) -> Pose:
    """The pose of an element; the identity when there is none.

    Raises:
        SdfError: it has not six numbers (seven as a quaternion), or they are not finite.
    """
    element = parent.child("pose")
    if element is None:
        return Pose(parent.place)
    attributes = element.attributes
    old = "relative_to" not in attributes
    frame = attributes.get("frame" if old else "relative_to", "")
    if not element.text:
        return Pose(element.place, relative_to=frame, old=old)
    form = attributes.get("rotation_format", "euler_rpy")
    if form == "quat_xyzw":
        x, y, z, qx, qy, qz, qw = numbers(element, 7)
        if math.hypot(qx, qy, qz, qw) < 1e-6:
            raise element.error("<pose> has a quaternion without length")
        transform = Transform((x, y, z), (qw, qx, qy, qz))
    elif form == "euler_rpy":
        x, y, z, *turn = numbers(element, COUNT_OF_POSE)
        if attributes.get("degrees", "false").lower() in _TRUE:
            turn = [math.radians(angle) for angle in turn]
        transform = Transform.from_rpy((x, y, z), turn)
    else:
        raise element.error(
            f"<pose> has rotation_format {form!r}; expected 'euler_rpy' or 'quat_xyzw'"
        )
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        raise element.error(f"<pose> is more than {FARTHEST:g} m away")
    return Pose(element.place, transform, frame, old)


def color_of(parent: Element, tag: str) -> tuple[float, float, float, float] | None:
    """A colour (red, green, blue, alpha) in 0..1; None when there is none.

    Raises:
        SdfError: it has neither three nor four numbers.
    """
    element = parent.child(tag)
    if element is None or not element.text:
        return None
    values = [min(max(value, 0.0), 1.0) for value in numbers(element)]
    if len(values) == 3:
        values.append(1.0)
    if len(values) != 4:
        raise element.error(f"<{tag}> has {len(values)} numbers; expected red green blue alpha")
    return values[0], values[1], values[2], values[3]
