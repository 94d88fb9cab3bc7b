"""Reading the parameters of a fault."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError

LASTING = "for"
"""Duration of a fault, s. The caller ends the fault, so every row may have this parameter."""


def only(fault: Fault, *names: str) -> None:
    """Reject parameters with other names, and missing ones.

    Raises:
        FaultError: lists the valid names.
    """
    known = ", ".join(names) or "none"
    for name in fault.parameters:
        if name not in names and name != LASTING:
            raise FaultError(f"{fault.name} has no parameter {name!r}; it has: {known}")
    for name in names:
        if name not in fault.parameters:
            raise FaultError(f"{fault.name} needs the parameter {name!r}; it has: {known}")


def number(fault: Fault, name: str, least: float, most: float, unit: str) -> float:
    """Read a finite number between two bounds, both valid; FaultError if it is not."""
    value = _as_number(fault, name)
    if value is None or not least <= value <= most:
        raise FaultError(
            f"{fault.name}: {name} is {fault.parameters[name]!r}, expected a number from "
            f"{least:g} to {most:g} {unit}"
        )
    return value


def whole(fault: Fault, name: str, least: int, most: int) -> int:
    """Read a whole number between two bounds, both valid; FaultError if it is not."""
    value = _as_number(fault, name)
    if value is None or not value.is_integer() or not least <= value <= most:
        raise FaultError(
            f"{fault.name}: {name} is {fault.parameters[name]!r}, expected a whole number from "
            f"{least} to {most}"
        )
    return int(value)


def _as_number(fault: Fault, name: str) -> float | None:
    value = fault.parameters[name]
    return None if isinstance(value, str | bool) or not math.isfinite(value) else float(value)
