"""The geometric detector: finds objects on a surface from several views, best match first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from momantu_bt.detector import View
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform, quaternion_from_axis_angle
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.objects.matching import KNOWN, MatchConfig, score
from momantu_skills.perception.objects.shapes import Shape, describe
from momantu_skills.perception.objects.splitting import split
from momantu_skills.perception.surface.planes import PlaneConfig, Support, measure_support
from momantu_skills.perception.surface.segment import SegmentConfig, Thing, things_on

SIMPLE_MISFIT = 0.003
"""Median distance up to which one shape explains an object, m: twice the noise at 1.2 m."""
SIMPLE_BEYOND = 0.15
"""Share of points outside the shape up to which it is one object: a mug's handle has a tenth."""


@dataclass(frozen=True)
class GeometricDetector:
    """Measures the plane, groups the points above it, and fits cylinders and boxes to them."""

    planes: PlaneConfig = field(default_factory=PlaneConfig)
    segments: SegmentConfig = field(default_factory=SegmentConfig)
    matches: MatchConfig = field(default_factory=MatchConfig)

    categories: ClassVar[tuple[str, ...]] = KNOWN
    """The shapes that it tells apart."""
    budget: ClassVar[float] = 0.1
    """Time allowed for processing one view together with the earlier ones, s."""

    @property
    def accepted(self) -> float:
        """The least score of an object that counts as the requested one."""
        return self.matches.accepted

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        """See `ObjectDetector.detect`."""
        support = measure_support(views, low, high, self.planes)
        if support is None:
            return None
        eyes = support.cameras - np.array([0.0, 0.0, support.height])
        things = _whole(things_on(support, self.segments), eyes)
        shapes = [shape for thing in things for shape in self._shapes(thing, eyes, asked)]
        found = [self._object(shape, support, asked) for shape in shapes]
        found.sort(key=lambda thing: -thing.score)
        return tuple(found)

    def _shapes(self, thing: Thing, eyes: Array, asked: ObjectClass) -> list[Shape]:
        """The object as a whole, or its parts if several objects touch."""
        radius = None if asked.diameter is None else asked.diameter / 2
        whole = describe(thing, eyes, radius)
        if whole.misfit <= SIMPLE_MISFIT and whole.beyond <= SIMPLE_BEYOND:
            return [whole]
        parts = [describe(part, eyes, radius) for part in split(thing, self.segments)]
        if max(part.misfit for part in parts) < max(SIMPLE_MISFIT, 0.5 * whole.misfit):
            return parts
        return [whole]

    def _object(self, shape: Shape, support: Support, asked: ObjectClass) -> DetectedObject:
        middle = np.array([*shape.centre, support.height + shape.size[2] / 2])
        turn = quaternion_from_axis_angle((0.0, 0.0, 1.0), shape.yaw)
        worth = score(shape, asked, self.matches)
        return DetectedObject(
            category=asked.category if worth >= self.accepted else shape.category,
            pose=Pose(Transform(middle, turn), ODOM, support.stamp),
            size=shape.size,
            shape=shape.kind,
            score=worth,
            support_height=support.height,
        )


def _whole(things: list[Thing], eyes: Array) -> list[Thing]:
    """Objects, with pieces merged that lie inside the round shape of a larger one.

    A view over the near rim of a bowl shows its far wall as a separate piece.
    """
    whole: list[Thing] = []
    forms: list[Shape] = []
    for thing in sorted(things, key=lambda thing: -len(thing.points)):
        form = describe(thing, eyes)
        inside = [n for n, other in enumerate(forms) if _within(form, other)]
        if inside:
            whole[inside[0]] = whole[inside[0]].joined_with(thing)
            forms[inside[0]] = describe(whole[inside[0]], eyes)
        else:
            whole.append(thing)
            forms.append(form)
    return whole


def _within(form: Shape, other: Shape) -> bool:
    apart = math.dist(form.centre, other.centre)
    return other.kind == "cylinder" and apart < 0.5 * other.size[0]
