"""Quantities as people write them (`66 mm`, `2 min`, `90 deg`, `1 min 30 s`), converted to SI.

Decimal units are converted exactly and rounded once, so `66 mm` gives the same float as `0.066 m`
(66 * 0.001 gives another one). Degrees are converted as in `math.radians`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal

from momantu_bt.errors import InputError
from momantu_bt.formats.names import nearest

_DEGREE = math.pi / 180.0

_SCALE: dict[str, tuple[str, Decimal | float]] = {
    "ms": ("s", Decimal("0.001")),
    "s": ("s", Decimal(1)),
    "min": ("s", Decimal(60)),
    "h": ("s", Decimal(3600)),
    "mm": ("m", Decimal("0.001")),
    "cm": ("m", Decimal("0.01")),
    "m": ("m", Decimal(1)),
    "deg": ("rad", _DEGREE),
    "rad": ("rad", Decimal(1)),
    "Hz": ("Hz", Decimal(1)),
    "N": ("N", Decimal(1)),
    "g": ("kg", Decimal("0.001")),
    "kg": ("kg", Decimal(1)),
    "m/s": ("m/s", Decimal(1)),
    "cm/s": ("m/s", Decimal("0.01")),
    "rad/s": ("rad/s", Decimal(1)),
    "deg/s": ("rad/s", _DEGREE),
    "m/s2": ("m/s2", Decimal(1)),
    "cm/s2": ("m/s2", Decimal("0.01")),
    "rad/s2": ("rad/s2", Decimal(1)),
    "deg/s2": ("rad/s2", _DEGREE),
}
"""For each unit: its SI unit and the factor to it; the factor is a float if it is irrational."""

_WHAT = {
    "s": "a time",
    "m": "a length",
    "rad": "an angle",
    "Hz": "a rate",
    "N": "a force",
    "kg": "a mass",
    "m/s": "a speed",
    "rad/s": "a turning speed",
    "m/s2": "an acceleration",
    "rad/s2": "a turning acceleration",
}

NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
"""Regular expression for a number before a unit; it is also valid in JSON Schemas (ECMA 262)."""
_PART = re.compile(rf"\s*({NUMBER})\s*([A-Za-z°%µ/]+[0-9]?)\s*")
_EXACT = Context(prec=60, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
"""Decimal arithmetic with ample digits; a number that is too large becomes infinite."""


class UnitError(ValueError):
    """A text looks like a number with a unit but is not valid; the message says what would be."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in an SI unit."""

    value: float
    unit: str


def units_of(unit: str) -> tuple[str, ...]:
    """The units that are valid for an SI unit, such as ("mm", "cm", "m") for "m"."""
    return tuple(name for name, (si, _) in _SCALE.items() if si == unit)


def quantity(text: str) -> Quantity | None:
    """Read a text as a quantity, in SI; None if it does not look like one.

    Several parts of the same kind are added: `1 min 30 s`.

    Raises:
        UnitError: the text looks like a quantity, but a unit is unknown, the parts are of different
            kinds, or the number is too large.
    """
    return _sum(text, _SCALE)


def _sum(text: str, valid: Iterable[str]) -> Quantity | None:
    """As `quantity`; the message about an unknown unit lists the valid ones."""
    parts = _parts(text)
    if not parts:
        return None
    total, kind = Decimal(0), ""
    turned = 0.0
    for number, name in parts:
        if name not in _SCALE:
            raise UnitError(_unknown(name, valid))
        si, scale = _SCALE[name]
        if kind and si != kind:
            raise UnitError(f"{text!r} adds {_WHAT[kind]} and {_WHAT[si]}")
        kind = si
        if isinstance(scale, Decimal):
            total = _EXACT.fma(_EXACT.create_decimal(number), scale, total)
        else:
            turned += float(number) * scale
    value = turned if not total else float(total) + turned
    if not math.isfinite(value):
        raise UnitError(f"{text!r} is too large for a number")
    return Quantity(value, kind)


def in_unit(text: str, unit: str) -> float | None:
    """Read a text as a number in the SI unit `unit`; None if it does not look like a quantity.

    Raises:
        UnitError: the unit is unknown, or of another kind than `unit`.
    """
    found = in_one_of(text, (unit,))
    return None if found is None else found.value


def option_in_unit(option: str, text: str, unit: str, such_as: str) -> float:
    """What an option of the command line gives, as a number in the SI unit `unit`.

    such_as: a valid text, for the message.

    Raises:
        InputError: the text has no unit, or a wrong one; names the option.
    """
    try:
        value = in_unit(text, unit)
    except UnitError as error:
        raise InputError(f"{option}: {error}") from None
    if value is None:
        expected = f"{_WHAT[unit]} with its unit, such as {such_as}"
        raise InputError(f"{option} {text!r}; expected {expected}")
    return value


def in_one_of(text: str, units: Iterable[str]) -> Quantity | None:
    """Read a text as a quantity in one of some SI units; None if it does not look like one.

    Raises:
        UnitError: the unit is unknown, or of another kind.
    """
    wanted = tuple(units)
    found = _sum(text, [name for unit in wanted for name in units_of(unit)])
    if found is None:
        return None
    if found.unit not in wanted:
        what = " or ".join(_WHAT.get(unit, unit) for unit in wanted)
        valid = ", ".join(name for unit in wanted for name in units_of(unit) or (unit,))
        raise UnitError(f"{text!r} is {_WHAT[found.unit]}; expected {what}, in: {valid}")
    return found


def _parts(text: str) -> list[tuple[str, str]]:
    parts: list[tuple[str, str]] = []
    position = 0
    while position < len(text):
        match = _PART.match(text, position)
        if match is None:
            return []
        parts.append((match[1], match[2]))
        position = match.end()
    return parts


def _unknown(name: str, valid: Iterable[str]) -> str:
    folded = {known.lower(): known for known in _SCALE}
    near = folded.get(name.lower()) or _SPELLED_OUT.get(name.lower().rstrip("s"))
    near = near or nearest(name, _SCALE)
    if near:
        return f"unknown unit {name!r}, did you mean {near!r}?"
    return f"unknown unit {name!r}. Units: {', '.join(valid)}"


_SPELLED_OUT = {
    "sec": "s",
    "second": "s",
    "m": "ms",
    "msec": "ms",
    "millisecond": "ms",
    "minute": "min",
    "hour": "h",
    "hr": "h",
    "meter": "m",
    "metre": "m",
    "millimeter": "mm",
    "millimetre": "mm",
    "centimeter": "cm",
    "centimetre": "cm",
    "degree": "deg",
    "°": "deg",
    "radian": "rad",
    "newton": "N",
    "hertz": "Hz",
    "gram": "g",
    "kilogram": "kg",
}
