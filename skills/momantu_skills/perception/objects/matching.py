"""How well a measured shape matches the requested object."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from momantu_bt.categories import USUAL
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.objects.shapes import Shape

KNOWN = tuple(USUAL)
"""Categories that detectors tell apart unless they say otherwise."""


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
    categories: tuple[str, ...] = KNOWN
    """The categories that are told apart."""


def score(shape: Shape, asked: ObjectClass, config: MatchConfig | None = None) -> float:
    """Score from 0 to 1; 0 if a size is out of tolerance.

    One minus half the root mean square of the sizes' differences in units of their tolerance, times
    `category_weight` if the shape is another. A requested category that is unknown fits any shape.
    """
    config = config or MatchConfig()
    squares: list[float] = []
    for _, measured, told in _sizes(shape.size, shape.kind, asked):
        tolerance = _tolerance(told, config)
        if abs(measured - told) > tolerance:
            return 0.0
        squares.append(((measured - told) / tolerance) ** 2)
    fit = 1.0 - 0.5 * math.sqrt(sum(squares) / len(squares)) if squares else 0.75
    same = same_category(shape, asked, config.categories)
    return fit if same else fit * config.category_weight


def same_category(shape: Shape, asked: ObjectClass, categories: Sequence[str] = KNOWN) -> bool:
    """Whether the shape fits the requested category; an unknown category fits all shapes."""
    return asked.category not in categories or shape.category == asked.category


def misfits(
    thing: DetectedObject, asked: ObjectClass, config: MatchConfig | None = None
) -> list[str]:
    """Why a measured object is not the requested one: "6 mm too wide (asked 57 ± 6 mm)".

    Only sizes that are out of tolerance are told; if none is, the category or the sum of the
    differences decided.
    """
    config = config or MatchConfig()
    found: list[str] = []
    for words, measured, told in _sizes(thing.size, thing.shape, asked):
        tolerance = _tolerance(told, config)
        if abs(measured - told) > tolerance:
            much = f"{1000 * abs(measured - told):.0f} mm {words[measured < told]}"
            found.append(f"{much} (asked {1000 * told:.0f} ± {1000 * tolerance:.0f} mm)")
    if found:
        return list(dict.fromkeys(found))
    if asked.category in config.categories and thing.category != asked.category:
        return [f"no {asked.category} by its shape"]
    return [f"all sizes differ a little: it matches by {100 * thing.score:.0f} %"]


def _tolerance(told: float, config: MatchConfig) -> float:
    return max(config.absolute, config.relative * told)


_WIDE, _HIGH = ("too wide", "too narrow"), ("too high", "too low")


def _sizes(
    size: tuple[float, float, float], kind: str, asked: ObjectClass
) -> Iterator[tuple[tuple[str, str], float, float]]:
    """The words for too much and too little, the measured and the given size, for each size."""
    across = sorted(size[:2])
    if asked.height is not None:
        yield _HIGH, size[2], asked.height
    if asked.diameter is not None:
        yield _WIDE, across[1], asked.diameter
        if kind == "box":
            yield _WIDE, across[0], asked.diameter
    flat = sorted(told for told in (asked.width, asked.depth) if told is not None)
    if len(flat) == 2:
        yield from ((_WIDE, *pair) for pair in zip(across, flat, strict=True))
    elif flat:
        yield _WIDE, min(across, key=lambda side: abs(side - flat[0])), flat[0]
