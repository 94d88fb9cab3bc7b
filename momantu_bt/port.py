"""Ports as a skill declares them: `In`, `Out`, and `Needs` for services."""

from __future__ import annotations

import inspect
import sys
from dataclasses import dataclass
from typing import Any


class _Missing:
    def __repr__(self) -> str:
        return "MISSING"


MISSING: Any = _Missing()
"""The default of an input that a tree must give."""

NAMES = ("place", "surface", "named_pose", "category", "goal", "spot", "tag", "taught")
"""What a text input may name, so that the checker knows the valid values.

`goal` is a place, or a pose of the map written as text (see `Pose2D.from_text`), where the robot is
to stand; `spot` is the same, but the robot need not stand there. `taught` is a name that the skill
gives to a place or a surface.
It may also be an entry point group, such as `momantu_bt.detectors`; the input then names a plug-in
of that group.
"""


@dataclass(frozen=True, slots=True)
class Port:
    """One port as declared. type: the resolved annotation. names: see `NAMES`, or None.

    least, most: bounds of a number, in the port's unit. endless: -1 is valid too and means
    "without end". frame: "map" for a pose that must lie on the site's map, or None.
    may_be_empty, ignored: see `In`.
    """

    name: str
    direction: str
    type: Any
    doc: str
    default: Any = MISSING
    unit: str | None = None
    live: bool = False
    names: str | None = None
    least: float | None = None
    most: float | None = None
    endless: bool = False
    frame: str | None = None
    may_be_empty: bool = False
    ignored: bool = False

    @property
    def bounded(self) -> bool:
        """Whether a number may be too small or too large."""
        return self.least is not None or self.most is not None

    def allows(self, number: float) -> bool:
        """Whether a number is within the bounds."""
        if self.endless and number == -1:
            return True
        above = self.least is None or number >= self.least
        return above and (self.most is None or number <= self.most)

    @property
    def bounds(self) -> str:
        """The bounds in words: "at least 1, or -1 for no end"; empty without bounds."""
        words = [] if self.least is None else [f"at least {self.least:g}"]
        words += [] if self.most is None else [f"at most {self.most:g}"]
        return " and ".join(words) + (", or -1 for no end" if self.endless else "")

    @property
    def required(self) -> bool:
        """Whether a tree must give it."""
        return self.direction == "in" and self.default is MISSING


class _PortDescriptor:
    direction = ""

    def __init__(
        self,
        default: Any = MISSING,
        *,
        doc: str,
        unit: str | None = None,
        live: bool = False,
        names: str | None = None,
        least: float | None = None,
        most: float | None = None,
        frame: str | None = None,
        may_be_empty: bool = False,
        ignored: bool = False,
    ) -> None:
        if may_be_empty and default is MISSING:
            raise TypeError("may_be_empty=True needs a default, for a key without a value")
        if names is not None and names not in NAMES and "." not in names:
            valid = f"{', '.join(NAMES)}, or the name of an entry point group"
            raise TypeError(f"names={names!r}; valid: {valid}")
        if least is not None and most is not None and least > most:
            raise TypeError(f"least={least:g} is more than most={most:g}")
        self.default, self.doc, self.unit, self.live = default, doc, unit, live
        self.names, self.least, self.most, self.frame = names, least, most, frame
        self.may_be_empty, self.ignored = may_be_empty, ignored
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        value = instance.port_values.get(self.name, self.default)
        if value is MISSING:
            raise AttributeError(f"port {self.name!r} of {owner.__name__} has no value yet")
        return value

    def __set__(self, instance: Any, value: Any) -> None:
        instance.port_values[self.name] = value


class _InDescriptor(_PortDescriptor):
    direction = "in"


class _OutDescriptor(_PortDescriptor):
    direction = "out"


class NeedsDescriptor:
    """What `Needs` makes. service: its name."""

    def __init__(self, service: str | None) -> None:
        self.service = service or ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.service = self.service or name

    def __get__(self, instance: Any, owner: type) -> Any:
        if instance is None:
            return self
        return instance.services[self.service]


def In(
    default: Any = MISSING,
    *,
    doc: str,
    unit: str | None = None,
    live: bool = False,
    names: str | None = None,
    least: float | None = None,
    most: float | None = None,
    frame: str | None = None,
    may_be_empty: bool = False,
    ignored: bool = False,
) -> Any:
    """Declare an input. Without a default it is required. live: read again on each tick.

    unit: SI unit that numbers in trees are converted to. names: see `NAMES`.
    least, most: bounds of a number, in `unit`; the checker rejects a tree that exceeds them.
    frame: "map" for a pose2d in the map where the robot is to stand; the checker rejects one
    outside the map, and one that the map shows to be occupied.
    may_be_empty: the key that the tree gives may have no value yet; the input then is its default.
    ignored: the skill does not read it; trees made for other systems may give it.
    """
    return _InDescriptor(
        default,
        doc=doc,
        unit=unit,
        live=live,
        names=names,
        least=least,
        most=most,
        frame=frame,
        may_be_empty=may_be_empty,
        ignored=ignored,
    )


def Out(*, doc: str, unit: str | None = None, live: bool = False) -> Any:
    """Declare an output. It is written on SUCCESS, or with `live` on each assignment.

    With `live`, what the skill has assigned is written also when it fails.
    """
    return _OutDescriptor(doc=doc, unit=unit, live=live)


def Needs(service: str | None = None) -> Any:
    """Declare that the skill needs a service. service: its name; by default the attribute's."""
    return NeedsDescriptor(service)


def declared_ports(cls: type) -> dict[str, Port]:
    """The ports that a class declares itself, by name.

    Raises:
        TypeError: a port has no type, its type is not imported, or its default is out of bounds.
    """
    scope = vars(sys.modules[cls.__module__])
    annotations = inspect.get_annotations(cls)
    ports: dict[str, Port] = {}
    for name, value in vars(cls).items():
        if not isinstance(value, _PortDescriptor):
            continue
        if name not in annotations:
            raise TypeError(f"port {cls.__name__}.{name} has no type; write `{name}: text = …`")
        annotation = annotations[name]
        if isinstance(annotation, str):
            try:
                annotation = eval(annotation, dict(scope))
            except NameError as error:
                raise TypeError(
                    f"port {cls.__name__}.{name}: {error}; its type must be imported at run time"
                ) from None
        port = Port(
            name,
            value.direction,
            annotation,
            value.doc,
            value.default,
            value.unit,
            value.live,
            value.names,
            value.least,
            value.most,
            frame=value.frame,
            may_be_empty=value.may_be_empty,
            ignored=value.ignored,
        )
        if isinstance(port.default, int | float) and not port.allows(port.default):
            raise TypeError(f"port {cls.__name__}.{name}: the default is not {port.bounds}")
        ports[name] = port
    return ports
