"""Two detectors that look at the same views and check each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np

from momantu_bt.categories import HANDLED
from momantu_bt.detector import DetectorError, ObjectDetector, View
from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.learned.detector import LearnedDetector
from momantu_skills.perception.objects.geometric import GeometricDetector
from momantu_skills.perception.objects.matching import KNOWN

with lazily():
    from momantu_skills.perception.learned import fusing

ALIKE, ALIKE_LEAST = 0.2, 0.01
"""Sizes agree up to this share of them, or up to so many metres."""
ALONE = 0.75
"""Factor on the score of what one detector alone sees; it then has to match well."""


class BothDetectors:
    """Asks the geometric and the learned detector, and believes most what both say.

    Where they agree on category and sizes the object has the pose and sizes that fit the depth
    (those of the learned one for what has a handle, which it knows), and the better of both scores.
    Where they differ, the learned one's answer stays, with the mean of both scores: it tells
    categories apart better, and knows what lies. What one alone sees has its score lowered. A heap
    that the geometric detector takes for one object gives way to those that the learned one sees
    in it.
    """

    categories: ClassVar[tuple[str, ...]] = KNOWN
    """The categories that they tell apart."""

    def __init__(
        self, measuring: ObjectDetector | None = None, learned: ObjectDetector | None = None
    ) -> None:
        """measuring, learned: detectors in place of the geometric and the learned one."""
        self._measuring: ObjectDetector = measuring or GeometricDetector()
        self._learned: ObjectDetector = learned or LearnedDetector()

    @property
    def accepted(self) -> float:
        """The least score of an object that counts as the requested one."""
        return max(self._measuring.accepted, self._learned.accepted)

    @property
    def budget(self) -> float:
        """Time allowed for one view, s."""
        return self._measuring.budget + self._learned.budget

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        """See `ObjectDetector.detect`.

        Raises:
            DetectorError: the learned detector's weights cannot be used.
        """
        measured = self._measuring.detect(views, low, high, asked)
        try:
            learned = self._learned.detect(views, low, high, asked)
        except DetectorError as error:
            if error.code != "CATEGORY_UNKNOWN":
                raise
            return measured  # which takes a thing of any shape for one of an unknown category
        if measured is None and learned is None:
            return None
        found = _merged(list(measured or ()), list(learned or ()))
        return tuple(sorted(found, key=lambda thing: -thing.score))


def _merged(measured: list[DetectedObject], learned: list[DetectedObject]) -> list[DetectedObject]:
    """What two detectors found, as one list."""
    found = []
    left = list(measured)
    for thing in learned:
        near = [other for other in left if _apart(thing, other) < fusing.SAME]
        if near:
            other = min(near, key=lambda each: _apart(thing, each))
            left.remove(other)
            found.append(_of_two(other, thing))
        else:
            found.append(replace(thing, score=ALONE * thing.score))
    heaps = [thing for thing in left if any(_holds(thing, other) for other in learned)]
    found += [replace(thing, score=ALONE * thing.score) for thing in left if thing not in heaps]
    return found


def _of_two(measured: DetectedObject, learned: DetectedObject) -> DetectedObject:
    """What both see, as they say it together."""
    if measured.category == learned.category and _alike(measured, learned):
        best = learned if learned.category in HANDLED else measured
        return replace(best, score=max(measured.score, learned.score))
    return replace(learned, score=(measured.score + learned.score) / 2)


def _alike(one: DetectedObject, other: DetectedObject) -> bool:
    """Whether two objects have about the same extent along the axes of odom."""
    return np.allclose(_extent(one), _extent(other), rtol=ALIKE, atol=ALIKE_LEAST)


def _extent(thing: DetectedObject) -> Array:
    """Extent (3,) of an object's box along the axes of odom, m."""
    return np.asarray(np.abs(thing.pose.transform.rotation) @ np.array(thing.size))


def _apart(one: DetectedObject, other: DetectedObject) -> float:
    """Distance between the middles of two objects, m."""
    return float(np.linalg.norm(one.pose.position - other.pose.position))


def _holds(heap: DetectedObject, thing: DetectedObject) -> bool:
    """Whether the middle of an object lies in the box of another."""
    own = heap.pose.transform.inverse().apply(thing.pose.position)
    return bool((np.abs(own) < np.array(heap.size) / 2).all())
