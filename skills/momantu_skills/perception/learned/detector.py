"""The learned detector: finds things by category, also those that touch, lie or are hidden."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

from momantu_bt.categories import USUAL
from momantu_bt.detector import DetectorError, View
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.learned import header
from momantu_skills.perception.objects.matching import MatchConfig, score
from momantu_skills.perception.objects.shapes import Shape

with lazily():
    from momantu_skills.perception.learned import (
        completing,
        confidence,
        crops,
        fusing,
        seeing,
        solids,
        weights,
    )
    from momantu_skills.perception.learned import standing as surfaces

WEIGHTS = "MOMANTU_BT_LEARNED_WEIGHTS"
"""Environment variable: a weights file instead of the bundled one."""
TOLERANCES = MatchConfig(relative=0.15, absolute=0.010)
"""Its sizes are less exact than those of a fitted shape."""
UNLIKELY = 0.6
"""Factor on the score of a thing that is hardly right by itself; of a likely one it is 1."""
GUESSED = 0.005
"""Range, above the least accepted score, in which those of completed things lie: other things that
are accepted have higher ones, but for a few."""
SPEAKING = 2
"""Least number of asked sizes by which a thing of a less likely category may be the asked one."""


class _Categories:
    """The categories that a detector's weights tell apart, or the usual ones if nobody can say."""

    def __get__(self, detector: LearnedDetector | None, kind: type) -> tuple[str, ...]:
        path = weights_file() if detector is None else detector.path
        try:
            return tuple(USUAL if path is None else header.categories(path))
        except header.WeightsError:
            return tuple(USUAL)


def weights_file() -> Path | None:
    """The weights file that the environment names, if it names one."""
    told = os.environ.get(WEIGHTS)
    return Path(told) if told else None


class LearnedDetector:
    """Lets a network say what each pixel shows, and fits poses and sizes to the depth.

    torch and the weights are loaded with the first picture.
    """

    categories = _Categories()
    """The categories that it tells apart: those of its weights."""
    budget: ClassVar[float] = 0.15
    """Time allowed for one view, s."""

    def __init__(self, path: Path | None = None) -> None:
        """path: of the weights; None: those of the environment variable, or the bundled ones."""
        self.path = path or weights_file()
        self._seeing: seeing.Seeing | None = None
        self._seen: dict[int, tuple[View, fusing.Look | None]] = {}

    @property
    def accepted(self) -> float:
        """The least score of an object that counts as the requested one."""
        return TOLERANCES.accepted

    @property
    def sure(self) -> float:
        """The score from which on it is worth no further look; what is hidden in part has less."""
        return TOLERANCES.accepted + GUESSED

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        """See `ObjectDetector.detect`.

        Raises:
            DetectorError: the weights cannot be used, or do not know the category.
        """
        self._check(asked.category)
        looks = [look for view in views if (look := self._look(view, low, high)) is not None]
        if not looks:
            return None
        height, stamp = fusing.height(looks), max(look.stamp for look in looks)
        things = fusing.fused(looks)
        found = [self._object(thing, height, stamp, asked) for thing in things]
        if all(one.score < self.accepted for one in found):
            pairs = zip(things, found, strict=True)
            found = [self._whole(thing, one, looks, asked) or one for thing, one in pairs]
        found.sort(key=lambda thing: -thing.score)
        return tuple(found)

    def _whole(
        self,
        thing: solids.Solid,
        found: DetectedObject,
        looks: Sequence[fusing.Look],
        asked: ObjectClass,
    ) -> DetectedObject | None:
        """A thing as the asked one of which a part is hidden; None if it does not fit as such."""
        symmetry = header.categories(self.path or weights.BUNDLED)[asked.category]
        level = found.support_height
        whole = completing.completed(thing, asked, symmetry, looks, level)
        if whole is None:
            return None
        made = self._object(whole[0], level, found.pose.stamp, asked)
        worth = made.score * whole[1] * _alike(thing, asked)
        if worth < self.accepted:
            return None
        return replace(made, score=self.accepted + (self.sure - self.accepted) * worth)

    def _check(self, category: str) -> None:
        """Raise an error if the weights cannot be used, or do not know a category."""
        path = self.path or weights.BUNDLED
        known = header.categories(path)
        if category not in known:
            raise DetectorError(
                "CATEGORY_UNKNOWN",
                f"the weights {path.name} know no {category!r}; they know {', '.join(known)}: ask "
                "for one of these, use the detector `geometric`, or train weights with it and name "
                f"them in {WEIGHTS}",
            )

    def _look(self, view: View, low: float, high: float) -> fusing.Look | None:
        """What one view shows; each view is looked at once."""
        kept = self._seen.get(id(view))
        if kept is not None and kept[0] is view:
            return kept[1]
        look = self._looked(view, low, high)
        self._seen[id(view)] = (view, look)
        return look

    def _looked(self, view: View, low: float, high: float) -> fusing.Look | None:
        snapshot = view.snapshot
        surface = surfaces.standing(view.points, snapshot.odom_from_camera, low, high)
        if surface is None:
            return None
        image = snapshot.image
        crop = crops.cut(image, surface.odom_from_camera, surface.height, surface.outline)
        if crop is None:
            return fusing.Look(surface.height, surface.area, image.stamp, ())
        if self._seeing is None:
            self._seeing = seeing.Seeing(self.path or weights.BUNDLED)
        solids = tuple(thing.moved(crop.odom_from_level) for thing in self._seeing.solids(crop))
        return fusing.Look(
            surface.height,
            surface.area,
            image.stamp,
            solids,
            surface.odom_from_camera.position,
            crop.odom_from_level.apply(crop.shown()),
        )

    def _object(
        self, thing: solids.Solid, height: float, stamp: float, asked: ObjectClass
    ) -> DetectedObject:
        kind = "cylinder" if thing.has_axis else "box"
        pose = thing.frame_from_object
        x, y, _ = pose.position.tolist()
        shape = Shape(kind, thing.category, (x, y), pose.yaw, thing.size, 0.0, 0.0, 0.0)
        known = replace(
            TOLERANCES, categories=self.categories, category_weight=_alike(thing, asked)
        )
        certain = UNLIKELY + (1.0 - UNLIKELY) * confidence.chance(thing)
        worth = certain * score(shape, asked, known)
        return DetectedObject(
            category=asked.category if worth >= TOLERANCES.accepted else thing.category,
            pose=Pose(pose, ODOM, stamp),
            size=thing.size,
            shape=kind,
            score=worth,
            support_height=height,
        )


def _alike(thing: solids.Solid, asked: ObjectClass) -> float:
    """Factor on the score of a thing of another category: 1 if the asked one is as likely.

    That holds if sizes speak for the asked one too, at least SPEAKING of them.
    """
    least = TOLERANCES.category_weight
    sizes = (asked.diameter, asked.width, asked.depth, asked.height)
    if sum(size is not None for size in sizes) < SPEAKING:
        return least
    likely = thing.chances.get(asked.category, 0.0) / max(thing.sure, 1e-9)
    return least + (1.0 - least) * min(1.0, likely)
