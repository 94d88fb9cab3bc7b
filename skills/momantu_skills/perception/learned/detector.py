"""The learned detector: finds things by category, also those that touch, lie or are hidden."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

from momantu_bt.detector import View
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_skills.perception.objects.matching import KNOWN, MatchConfig, score
from momantu_skills.perception.objects.shapes import Shape

with lazily():
    from momantu_skills.perception.learned import crops, fusing, seeing, solids, weights
    from momantu_skills.perception.learned import standing as surfaces

WEIGHTS = "MOMANTU_BT_LEARNED_WEIGHTS"
"""Environment variable: a weights file instead of the bundled one."""
TOLERANCES = MatchConfig(relative=0.15, absolute=0.010)
"""Its sizes are less exact than those of a fitted shape."""


class LearnedDetector:
    """Lets a network say what each pixel shows, and fits poses and sizes to the depth.

    torch and the weights are loaded with the first picture.
    """

    categories: ClassVar[tuple[str, ...]] = KNOWN
    """The categories that it tells apart."""
    budget: ClassVar[float] = 0.15
    """Time allowed for one view, s."""

    def __init__(self, path: Path | None = None) -> None:
        """path: of the weights; None: those of the environment variable, or the bundled ones."""
        told = os.environ.get(WEIGHTS)
        self._path = path or (Path(told) if told else None)
        self._seeing: seeing.Seeing | None = None
        self._seen: dict[int, tuple[View, fusing.Look | None]] = {}

    @property
    def accepted(self) -> float:
        """The least score of an object that counts as the requested one."""
        return TOLERANCES.accepted

    def detect(
        self, views: Sequence[View], low: float, high: float, asked: ObjectClass
    ) -> tuple[DetectedObject, ...] | None:
        """See `ObjectDetector.detect`.

        Raises:
            WeightsError: the weights cannot be used.
        """
        looks = [look for view in views if (look := self._look(view, low, high)) is not None]
        if not looks:
            return None
        stamp = max(look.stamp for look in looks)
        height = fusing.height(looks)
        found = [self._object(thing, height, stamp, asked) for thing in fusing.fused(looks)]
        found.sort(key=lambda thing: -thing.score)
        return tuple(found)

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
            self._seeing = seeing.Seeing(self._path or weights.BUNDLED)
        solids = tuple(thing.moved(crop.odom_from_level) for thing in self._seeing.solids(crop))
        return fusing.Look(surface.height, surface.area, image.stamp, solids)

    @staticmethod
    def _object(
        thing: solids.Solid, height: float, stamp: float, asked: ObjectClass
    ) -> DetectedObject:
        kind = "box" if thing.category == "box" else "cylinder"
        pose = thing.frame_from_object
        x, y, _ = pose.position.tolist()
        shape = Shape(kind, thing.category, (x, y), pose.yaw, thing.size, 0.0, 0.0, 0.0)
        worth = score(shape, asked, TOLERANCES) * (0.5 + 0.5 * thing.sure)
        return DetectedObject(
            category=asked.category if worth >= TOLERANCES.accepted else thing.category,
            pose=Pose(pose, ODOM, stamp),
            size=thing.size,
            shape=kind,
            score=worth,
            support_height=height,
        )
