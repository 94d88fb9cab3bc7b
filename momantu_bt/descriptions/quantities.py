"""Fields of description files that are quantities: `15 cm`, `90 deg`; bare numbers are SI."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import core_schema

from momantu_bt.formats.units import NUMBER, in_one_of, units_of

UNITS_KEY = "x-units"
"""Key in a JSON Schema for the valid units of a quantity; the first is that of a bare number."""


@dataclass(frozen=True, eq=False)
class Measured:
    """Makes pydantic read a field as a quantity: a number in SI, or a text with a unit.

    what: its name in messages. si: its valid SI units; the first is that of a bare number.
    gt: it must be greater than this, ge: at least this, both in SI.
    """

    what: str
    si: tuple[str, ...]
    gt: float | None = None
    ge: float | None = None

    @property
    def units(self) -> list[str]:
        """All valid units; the first is that of a bare number."""
        return [
            unit
            for si in self.si
            for unit in (si, *(other for other in reversed(units_of(si)) if other != si))
        ]

    def read(self, value: object) -> float:
        """The number in SI; ValueError if the value is neither a number nor a text with a unit."""
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise ValueError(f"expected {self.what} such as '2 {self.si[0]}', found {value!r}")
        if not isinstance(value, str):
            return float(value)
        found = in_one_of(value, self.si)
        if found is None:
            known = ", ".join(self.units)
            raise ValueError(f"{value!r} is not {self.what}; write a number and one of: {known}")
        return found.value

    def __get_pydantic_core_schema__(
        self, source: type, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """How pydantic reads the field; the field's own range narrows that of the quantity."""
        number = core_schema.float_schema(allow_inf_nan=False, gt=self.gt, ge=self.ge)
        narrowed = core_schema.chain_schema([number, handler(source)])
        return core_schema.no_info_before_validator_function(self.read, narrowed)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The JSON Schema of the quantity, for editors."""
        one = rf"{NUMBER}\s*(?:{'|'.join(map(re.escape, self.units))})"
        text = {"type": "string", "pattern": rf"^\s*{one}(?:\s*{one})*\s*$"}
        bounds = {"exclusiveMinimum": self.gt, "minimum": self.ge}
        number = {"type": "number", **{k: v for k, v in bounds.items() if v is not None}}
        return {"anyOf": [number, text], UNITS_KEY: self.units}


LENGTH = Measured("a length", ("m",))
ANGLE = Measured("an angle", ("rad",))

Length: TypeAlias = Annotated[float, LENGTH]
Size: TypeAlias = Annotated[float, Measured("a length", ("m",), gt=0)]
"""A length above zero."""
Angle: TypeAlias = Annotated[float, ANGLE]
Mass: TypeAlias = Annotated[float, Measured("a mass", ("kg",), gt=0)]
Force: TypeAlias = Annotated[float, Measured("a force", ("N",), gt=0)]
Rate: TypeAlias = Annotated[float, Measured("a rate", ("Hz",), gt=0)]
Time: TypeAlias = Annotated[float, Measured("a time", ("s",), ge=0)]
LinearSpeed: TypeAlias = Annotated[float, Measured("a speed", ("m/s",), gt=0)]
AngularSpeed: TypeAlias = Annotated[float, Measured("a turning speed", ("rad/s",), gt=0)]
JointSpeed: TypeAlias = Annotated[float, Measured("a joint's speed", ("rad/s", "m/s"), gt=0)]
"""rad/s of a joint that turns, m/s of one that slides."""
LinearAcceleration: TypeAlias = Annotated[float, Measured("an acceleration", ("m/s2",), gt=0)]
AngularAcceleration: TypeAlias = Annotated[
    float, Measured("a turning acceleration", ("rad/s2",), gt=0)
]
JointAcceleration: TypeAlias = Annotated[
    float, Measured("a joint's acceleration", ("rad/s2", "m/s2"), gt=0)
]
"""rad/s2 of a joint that turns, m/s2 of one that slides."""
JointPosition: TypeAlias = Annotated[float, Measured("a joint's position", ("rad", "m"))]
"""rad of a joint that turns, m of one that slides."""
