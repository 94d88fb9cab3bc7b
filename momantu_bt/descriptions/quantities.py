"""Quantities of description files: `15 cm`, `90 deg`, `0.4 kg`; bare numbers are SI already."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Annotated, TypeAlias

from pydantic import BeforeValidator, Field, WithJsonSchema

LENGTH: Mapping[str, float] = {"m": 1.0, "cm": 0.01, "mm": 0.001}
ANGLE: Mapping[str, float] = {"rad": 1.0, "deg": math.pi / 180.0}
MASS: Mapping[str, float] = {"kg": 1.0, "g": 0.001}
FORCE: Mapping[str, float] = {"N": 1.0}
TIME: Mapping[str, float] = {"s": 1.0, "ms": 0.001, "min": 60.0}

LINEAR_SPEED: Mapping[str, float] = {"m/s": 1.0, "cm/s": 0.01}
ANGULAR_SPEED: Mapping[str, float] = {"rad/s": 1.0, "deg/s": math.pi / 180.0}
JOINT_SPEED: Mapping[str, float] = {**ANGULAR_SPEED, **LINEAR_SPEED}
LINEAR_ACCELERATION: Mapping[str, float] = {"m/s2": 1.0, "cm/s2": 0.01}
ANGULAR_ACCELERATION: Mapping[str, float] = {"rad/s2": 1.0, "deg/s2": math.pi / 180.0}
JOINT_ACCELERATION: Mapping[str, float] = {**ANGULAR_ACCELERATION, **LINEAR_ACCELERATION}

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([A-Za-z°%][\w/°%]*)\s*")


def unit_of(value: object) -> str | None:
    """The unit that a value of a file is written with; None for a bare number."""
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
    return None if match is None else match[2]


def reader(what: str, units: Mapping[str, float]) -> Callable[[object], object]:
    """A function that turns a number, or a text with one of these units, into a number in SI."""
    known = ", ".join(units)

    def read(value: object) -> object:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise ValueError(f"expected {what} such as '2 {next(iter(units))}', found {value!r}")
        if not isinstance(value, str):
            return float(value)
        match = _QUANTITY.fullmatch(value)
        if match is None:
            raise ValueError(f"{value!r} is not {what}; write a number and one of: {known}")
        if match[2] not in units:
            raise ValueError(f"{match[2]!r} is not a unit of {what}; units: {known}")
        return float(match[1]) * units[match[2]]

    return read


UNITS_KEY = "x-units"
"""In a JSON Schema: the units that a quantity may be written with, the first that of a number."""
_NUMBER = r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?"


def _written(units: Mapping[str, float], **bounds: float) -> WithJsonSchema:
    """What an editor is told of a quantity: a number in SI, or a text with one of these units."""
    names = "|".join(re.escape(unit) for unit in units)
    text = {"type": "string", "pattern": rf"^\s*{_NUMBER}\s*({names})\s*$"}
    return WithJsonSchema({"anyOf": [{"type": "number", **bounds}, text], UNITS_KEY: list(units)})


Length: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a length", LENGTH)),
    Field(allow_inf_nan=False),
    _written(LENGTH),
]
Angle: TypeAlias = Annotated[
    float, BeforeValidator(reader("an angle", ANGLE)), Field(allow_inf_nan=False), _written(ANGLE)
]
Mass: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a mass", MASS)),
    Field(gt=0),
    _written(MASS, exclusiveMinimum=0),
]
Force: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a force", FORCE)),
    Field(gt=0),
    _written(FORCE, exclusiveMinimum=0),
]
Time: TypeAlias = Annotated[
    float, BeforeValidator(reader("a time", TIME)), Field(ge=0), _written(TIME, minimum=0)
]
Size: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a length", LENGTH)),
    Field(gt=0, allow_inf_nan=False),
    _written(LENGTH, exclusiveMinimum=0),
]
"""A length above zero."""
LinearSpeed: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a speed", LINEAR_SPEED)),
    Field(gt=0),
    _written(LINEAR_SPEED, exclusiveMinimum=0),
]
AngularSpeed: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a turning speed", ANGULAR_SPEED)),
    Field(gt=0),
    _written(ANGULAR_SPEED, exclusiveMinimum=0),
]
JointSpeed: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a joint's speed", JOINT_SPEED)),
    Field(gt=0),
    _written(JOINT_SPEED, exclusiveMinimum=0),
]
"""rad/s of a joint that turns, m/s of one that slides."""
LinearAcceleration: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("an acceleration", LINEAR_ACCELERATION)),
    Field(gt=0),
    _written(LINEAR_ACCELERATION, exclusiveMinimum=0),
]
AngularAcceleration: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a turning acceleration", ANGULAR_ACCELERATION)),
    Field(gt=0),
    _written(ANGULAR_ACCELERATION, exclusiveMinimum=0),
]
JointAcceleration: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a joint's acceleration", JOINT_ACCELERATION)),
    Field(gt=0),
    _written(JOINT_ACCELERATION, exclusiveMinimum=0),
]
"""rad/s2 of a joint that turns, m/s2 of one that slides."""
JointPosition: TypeAlias = Annotated[
    float,
    BeforeValidator(reader("a joint's position", {**ANGLE, **LENGTH})),
    Field(allow_inf_nan=False),
    _written({**ANGLE, **LENGTH}),
]
"""rad of a joint that turns, m of one that slides."""
