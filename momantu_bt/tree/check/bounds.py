"""Bounds of quantities for which a node declares none: what no robot can be asked for."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from momantu_bt.skill import Port
from momantu_bt.values.convert import convert

LARGEST: Mapping[str, float] = {
    "s": 1e7,
    "m": 1e4,
    "m/s": 30.0,
    "rad": 30.0,
    "rad/s": 100.0,
    "m/s2": 1e3,
    "Hz": 1e4,
    "N": 1e5,
    "kg": 1e4,
}
"""The largest size of a quantity in a tree, by its SI unit: 1e7 s are 116 days, 30 rad 5 turns."""


MOST_MILLISECONDS = 1e10
"""The same as in seconds, for inputs that count milliseconds."""


def with_bounds(port: Port) -> Port:
    """The port with bounds on both sides, if its unit has some; declared ones stay.

    A port whose default is infinite keeps its own: there, too large has a meaning.
    """
    largest = MOST_MILLISECONDS if port.name == "msec" else LARGEST.get(port.unit or "")
    endless = isinstance(port.default, float) and math.isinf(port.default)
    if largest is None or endless or (port.least is not None and port.most is not None):
        return port
    least = -largest if port.least is None else port.least
    return replace(port, least=least, most=largest if port.most is None else port.most)


def converted(value: Any, port: Port) -> Any:
    """What the tree writes, as the port takes it; ConversionError also for what is too large.

    A bound that the port declares is told first, alone.
    """
    found, bounded = convert(value, port), with_bounds(port)
    if bounded is not port:
        convert(value, bounded)
    return found


__all__ = ["LARGEST", "MOST_MILLISECONDS", "converted", "with_bounds"]
