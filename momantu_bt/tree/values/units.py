"""Quantities as people write them: `66 mm`, `2 min`, `90 deg`, `1 min 30 s`; everything to SI."""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass

_SCALE: dict[str, tuple[str, float, float]] = {
    "ms": ("s", 1.0, 1000.0),
    "s": ("s", 1.0, 1.0),
    "min": ("s", 60.0, 1.0),
    "h": ("s", 3600.0, 1.0),
    "mm": ("m", 1.0, 1000.0),
    "cm": ("m", 1.0, 100.0),
    "m": ("m", 1.0, 1.0),
    "deg": ("rad", math.pi, 180.0),
    "rad": ("rad", 1.0, 1.0),
    "Hz": ("Hz", 1.0, 1.0),
    "N": ("N", 1.0, 1.0),
    "kg": ("kg", 1.0, 1.0),
    "m/s": ("m/s", 1.0, 1.0),
    "cm/s": ("m/s", 1.0, 100.0),
    "rad/s": ("rad/s", 1.0, 1.0),
    "deg/s": ("rad/s", math.pi, 180.0),
}
# unit -> SI unit, times, divided by: two numbers, because 66 / 1000 rounds better than 66 * 0.001

_WHAT = {
    "s": "a time",
    "m": "a length",
    "rad": "an angle",
    "Hz": "a rate",
    "N": "a force",
    "kg": "a mass",
    "m/s": "a speed",
    "rad/s": "a turning speed",
}

_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_PART = re.compile(rf"\s*({_NUMBER})\s*([A-Za-z°%µ/]+[0-9]?)\s*")


class UnitError(ValueError):
    """A text is a number with a unit, but not a right one; the message says what would be."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number in an SI unit."""

    value: float
    unit: str


def units_of(unit: str) -> tuple[str, ...]:
    """What may be written where this SI unit is expected, such as ("mm", "cm", "m") for "m"."""
    return tuple(name for name, (si, _, _) in _SCALE.items() if si == unit)


def quantity(text: str) -> Quantity | None:
    """A text that is wholly a quantity, in SI; None when it does not look like one.

    Several parts are added when they are of one kind: `1 min 30 s`.

    Raises:
        UnitError: it looks like one, but a unit is unknown, the kinds differ or it is too large.
    """
    parts = _parts(text)
    if not parts:
        return None
    total, kind = 0.0, ""
    for number, name in parts:
        if name not in _SCALE:
            raise UnitError(_unknown(name))
        si, times, divided = _SCALE[name]
        if kind and si != kind:
            raise UnitError(f"{text!r} adds {_WHAT[kind]} and {_WHAT[si]}")
        kind = si
        total += number * times / divided
    if not math.isfinite(total):
        raise UnitError(f"{text!r} is too large for a number")
    return Quantity(total, kind)


def in_unit(text: str, unit: str) -> float | None:
    """A text as a number in the SI unit `unit`; None when it does not look like a quantity.

    Raises:
        UnitError: the unit is unknown, or of another kind than `unit`.
    """
    found = quantity(text)
    if found is None:
        return None
    if found.unit != unit:
        valid = ", ".join(units_of(unit)) or unit
        raise UnitError(
            f"{text!r} is {_WHAT[found.unit]}; expected {_WHAT.get(unit, unit)}, in: {valid}"
        )
    return found.value


def _parts(text: str) -> list[tuple[float, str]]:
    parts: list[tuple[float, str]] = []
    position = 0
    while position < len(text):
        match = _PART.match(text, position)
        if match is None:
            return []
        parts.append((float(match[1]), match[2]))
        position = match.end()
    return parts


def _unknown(name: str) -> str:
    folded = {known.lower(): known for known in _SCALE}
    near = folded.get(name.lower()) or _SPELLED_OUT.get(name.lower().rstrip("s"))
    near = near or next(iter(difflib.get_close_matches(name, _SCALE, n=1)), None)
    if near:
        return f"unknown unit {name!r}, did you mean {near!r}?"
    return f"unknown unit {name!r}. Units: {', '.join(_SCALE)}"


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
}
