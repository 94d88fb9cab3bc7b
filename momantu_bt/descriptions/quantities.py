"""Quantities of description files: `15 cm`, `90 deg`, `0.4 kg`; bare numbers are SI already."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import core_schema

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


UNITS_KEY = "x-units"
"""In a JSON Schema: the units that a quantity may be written with, the first that of a number."""
_NUMBER = r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?"


@dataclass(frozen=True, eq=False)
class Quantity:
    """Has pydantic read a field as a quantity: a number in SI, or a text with one of the units.

    what: its name in messages. units: each in SI, the first is that of a bare number. gt, ge:
    what it must be above, or at least, in SI.
    """

    what: str
    units: Mapping[str, float]
    gt: float | None = None
    ge: float | None = None

    def read(self, value: object) -> float:
        """The number in SI; ValueError for anything else than a number or a text with a unit."""
        known = ", ".join(self.units)
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            example = f"2 {next(iter(self.units))}"
            raise ValueError(f"expected {self.what} such as '{example}', found {value!r}")
        if not isinstance(value, str):
            return float(value)
        match = _QUANTITY.fullmatch(value)
        if match is None:
            raise ValueError(f"{value!r} is not {self.what}; write a number and one of: {known}")
        if match[2] not in self.units:
            raise ValueError(f"{match[2]!r} is not a unit of {self.what}; units: {known}")
        return float(match[1]) * self.units[match[2]]

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """How pydantic reads it."""
        number = core_schema.float_schema(allow_inf_nan=False, gt=self.gt, ge=self.ge)
        return core_schema.no_info_before_validator_function(self.read, number)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """What an editor is told of it."""
        names = "|".join(re.escape(unit) for unit in self.units)
        text = {"type": "string", "pattern": rf"^\s*{_NUMBER}\s*({names})\s*$"}
        bounds = {"exclusiveMinimum": self.gt, "minimum": self.ge}
        number = {"type": "number", **{k: v for k, v in bounds.items() if v is not None}}
        return {"anyOf": [number, text], UNITS_KEY: list(self.units)}


Length: TypeAlias = Annotated[float, Quantity("a length", LENGTH)]
Size: TypeAlias = Annotated[float, Quantity("a length", LENGTH, gt=0)]
"""A length above zero."""
Angle: TypeAlias = Annotated[float, Quantity("an angle", ANGLE)]
Mass: TypeAlias = Annotated[float, Quantity("a mass", MASS, gt=0)]
Force: TypeAlias = Annotated[float, Quantity("a force", FORCE, gt=0)]
Time: TypeAlias = Annotated[float, Quantity("a time", TIME, ge=0)]
LinearSpeed: TypeAlias = Annotated[float, Quantity("a speed", LINEAR_SPEED, gt=0)]
AngularSpeed: TypeAlias = Annotated[float, Quantity("a turning speed", ANGULAR_SPEED, gt=0)]
JointSpeed: TypeAlias = Annotated[float, Quantity("a joint's speed", JOINT_SPEED, gt=0)]
"""rad/s of a joint that turns, m/s of one that slides."""
LinearAcceleration: TypeAlias = Annotated[
    float, Quantity("an acceleration", LINEAR_ACCELERATION, gt=0)
]
AngularAcceleration: TypeAlias = Annotated[
    float, Quantity("a turning acceleration", ANGULAR_ACCELERATION, gt=0)
]
JointAcceleration: TypeAlias = Annotated[
    float, Quantity("a joint's acceleration", JOINT_ACCELERATION, gt=0)
]
"""rad/s2 of a joint that turns, m/s2 of one that slides."""
JointPosition: TypeAlias = Annotated[float, Quantity("a joint's position", {**ANGLE, **LENGTH})]
"""rad of a joint that turns, m of one that slides."""
