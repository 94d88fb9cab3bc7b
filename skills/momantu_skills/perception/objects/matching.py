"""How well a measured shape matches the requested object."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from momantu_bt.messages import ObjectClass
from momantu_skills.perception.objects.shapes import Shape

KNOWN = ("can", "bottle", "mug", "bowl", "box")
"""Categories that can be recognised by shape."""


@dataclass(frozen=True)
class MatchConfig:
    """Tolerances: given sizes are right to a few mm; similar objects differ by 20 % in one."""

    relative: float = 0.10
    """Largest relative difference of a size: half the difference between similar objects."""
    absolute: float = 0.006
    """Difference that measurement errors alone may cause, m."""
    accepted: float = 0.5
    """The least score of an object that counts as the requested one."""
    category_weight: float = 0.6
    """Factor on the score of an object of another shape; with it the score reaches `accepted` only
    if all sizes are nearly exact."""


def score(shape: Shape, asked: ObjectClass, config: MatchConfig | None = None) -> float:
    """Score from 0 to 1; 0 if a size is out of tolerance.

    One minus half the root mean square of the sizes' differences in units of their tolerance, times
    `category_weight` if the shape is another. A requested category that is unknown fits any shape.
    """
    config = config or MatchConfig()
    squares: list[float] = []
    for measured, told in _sizes(shape, asked):
        tolerance = max(config.absolute, config.relative * told)
        if abs(measured - told) > tolerance:
            return 0.0
        squares.append(((measured - told) / tolerance) ** 2)
    fit = 1.0 - 0.5 * math.sqrt(sum(squares) / len(squares)) if squares else 0.75
    return fit if same_category(shape, asked) else fit * config.category_weight


def same_category(shape: Shape, asked: ObjectClass) -> bool:
    """Whether the shape fits the requested category; an unknown category fits all shapes."""
    return asked.category not in KNOWN or shape.category == asked.category


def _sizes(shape: Shape, asked: ObjectClass) -> Iterator[tuple[float, float]]:
    """Pairs of (measured, given) for the given sizes."""
    across = sorted(shape.size[:2])
    if asked.height is not None:
        yield shape.size[2], asked.height
    if asked.diameter is not None:
        yield across[1], asked.diameter
        if shape.kind == "box":
            yield across[0], asked.diameter
    flat = sorted(size for size in (asked.width, asked.depth) if size is not None)
    if len(flat) == 2:
        yield from zip(across, flat, strict=True)
    elif flat:
        yield min(across, key=lambda size: abs(size - flat[0])), flat[0]
