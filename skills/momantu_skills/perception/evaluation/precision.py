"""Average precision over pictures, as in the NOCS benchmark."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from momantu_skills.perception.evaluation.boxes import Solid, angle, distance, overlap

Test: TypeAlias = Callable[["Pair"], bool]


@dataclass(frozen=True, slots=True)
class Pair:
    """A found thing beside a true one. overlap: 0..1. angle: degrees. distance: m."""

    overlap: float
    angle: float
    distance: float


@dataclass(frozen=True, slots=True)
class Picture:
    """What one picture shows, and what a detector found in it, each with its score."""

    true: tuple[Solid, ...]
    found: tuple[tuple[Solid, float], ...]


MEASURES: Mapping[str, Test] = MappingProxyType(
    {
        "iou25": lambda pair: pair.overlap >= 0.25,
        "iou50": lambda pair: pair.overlap >= 0.50,
        "iou75": lambda pair: pair.overlap >= 0.75,
        "deg5_cm5": lambda pair: pair.angle <= 5.0 and pair.distance <= 0.05,
        "deg10_cm5": lambda pair: pair.angle <= 10.0 and pair.distance <= 0.05,
        "deg10_cm10": lambda pair: pair.angle <= 10.0 and pair.distance <= 0.10,
    }
)
"""Name -> whether a found thing counts as the true one."""


def average_precisions(
    pictures: Sequence[Picture], categories: Sequence[str]
) -> dict[str, dict[str, float]]:
    """For each category, and as `mean`, the average precision by each of MEASURES, 0..1.

    Categories of which no picture shows a thing are left out.
    """
    found: dict[str, dict[str, float]] = {}
    for category in categories:
        shown = [_of(picture, category) for picture in pictures]
        if any(true for true, _ in shown):
            found[category] = {name: _average(shown, test) for name, test in MEASURES.items()}
    mean = {
        name: float(np.mean([each[name] for each in found.values()])) if found else 0.0
        for name in MEASURES
    }
    return {"mean": mean, **found}


_Shown: TypeAlias = tuple[int, list[tuple[float, list[Pair]]]]


def _of(picture: Picture, category: str) -> _Shown:
    """How many things of a category are there, and the pairs of each found one with all of them."""
    true = [solid for solid in picture.true if solid.category == category]
    found = [(solid, score) for solid, score in picture.found if solid.category == category]
    found.sort(key=lambda each: -each[1])
    pairs = [
        (
            score,
            [Pair(overlap(one, each), angle(one, each), distance(one, each)) for each in true],
        )
        for one, score in found
    ]
    return len(true), pairs


def _average(shown: Sequence[_Shown], test: Test) -> float:
    """Area under the curve of precision over recall; each found thing counts for one true one."""
    total = sum(true for true, _ in shown)
    scores, right = [], []
    for true, pairs in shown:
        free = set(range(true))
        for score, beside in pairs:
            fits = [n for n in free if test(beside[n])]
            scores.append(score)
            right.append(bool(fits))
            if fits:
                free.discard(min(fits, key=lambda n: (beside[n].distance, beside[n].angle)))
    if not scores:
        return 0.0
    order = np.argsort(-np.array(scores), kind="stable")
    hits = np.cumsum(np.array(right)[order])
    precision = hits / np.arange(1, len(hits) + 1)
    recall = hits / total
    precision = np.maximum.accumulate(precision[::-1])[::-1]
    steps = np.diff(np.concatenate([[0.0], recall]))
    return float((steps * precision).sum())
