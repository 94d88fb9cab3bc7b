"""detect_object: find the requested object on a surface, or say that it is not there."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, ObjectAt, ObjectOn
from momantu_bt.descriptions.tunables import configured
from momantu_bt.detector import (
    DETECTORS,
    DetectorError,
    ObjectDetector,
    View,
)
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Array
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Localization, PlanningScene, Snapshot
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.perception.camera import pictures
    from momantu_skills.perception.geometry import regions
    from momantu_skills.perception.objects import config, lying, matching


LOOKS = 3
"""Fewest views of a surface before an object is reported as not found."""
UPRIGHT = 0.999
"""Share of an axis along the vertical above which it is upright."""
EXACT = 0.02
"""Position error of a found object that still allows a grasp, m, with the fingers 0.1 m apart."""


class DetectObject(Skill):
    """Look over a surface, measure the objects on it, and find the requested object.

    The camera looks at the surface from its middle outwards until it sees the object, then at the
    object. A match of which the detector is not sure counts only if no look shows a better one.
    The skill measures the surface too: a table may stand up to 0.1 m and 5 degrees away
    from where the site places it, and 3 cm higher or lower.
    """

    object: ObjectClass = In(doc="what to find: its category and the sizes that are known")
    on: str = In(names="surface", doc="the surface that it stands on")
    views: int = In(2, least=1, most=20, doc="number of views that must show the object")
    detector: str | None = In(
        None,
        names=DETECTORS.name,
        doc="the detector that finds it in the pictures; None: the one that the site chooses",
    )
    found: DetectedObject = Out(doc="the best match; pose in odom, stamped")
    also_called = ("find_object", "find", "detect", "search", "look_for", "recognize")
    failures = {
        "OBJECT_NOT_FOUND": "no object on the surface is the requested one; data lists those found",
        "SURFACE_NOT_SEEN": "no picture showed a level surface where the site has one",
        "WEIGHTS_BROKEN": "the detector's weights cannot be read",
        "WEIGHTS_FOREIGN": "the file for the detector's weights holds something else",
        "WEIGHTS_OUTDATED": "the detector's weights are of another version",
        "CATEGORY_UNKNOWN": "the detector's weights do not know the category that is asked for",
    }
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {Activity.FIND_OBJECT: ""}
    symptoms = {
        "OBJECT_NOT_FOUND": {Symptom.NOT_SEEN, Symptom.OBJECT_GONE},
        "SURFACE_NOT_SEEN": {Symptom.NOT_SEEN},
    }
    localization: Localization = Needs()
    planning_scene: PlanningScene = Needs()

    def __init__(self) -> None:
        """Start without views."""
        super().__init__()
        self._views: list[View] = []

    def run(self, robot: Robot) -> Run:
        """Look and measure until enough views show the object, or no view is left."""
        corners = self._corners()
        region = regions.surface_region(corners)
        pending = surveys.looks_over(self, robot, corners, LOOKS)
        snapshots: list[Snapshot] = []
        finder = self._finder()
        result: tuple[DetectedObject, ...] | None = None
        best: DetectedObject | None = None
        while pending:
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, pending.pop(0))
            if snapshot is None:
                continue
            snapshots.append(snapshot)
            work = partial(self._measure, finder, snapshots, region)
            result = yield from compute(work, budget=finder.budget)
            best = None if result is None else _asked_of(result, finder.accepted)
            if best is None or best.score < _sure(finder):
                continue
            if len(snapshots) >= self.views:
                break
            camera = snapshot.odom_from_camera.position
            pending.insert(0, surveys.beside(best.pose.position, camera, len(snapshots)))
        if result is None:
            raise self._unseen(len(snapshots))
        if best is None:
            raise self._not_found(result, finder)
        self.found = best

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the object is where it was found; a failure denies it is on the surface."""
        if failure is None:
            return ObjectAt(self.object, self.found.pose.transform, EXACT)
        return ObjectOn(self.object, self.on) if failure.code == "OBJECT_NOT_FOUND" else None

    def _finder(self) -> ObjectDetector:
        """The detector that the tree names, or else the site."""
        parameters = self.site.services.get("detect_object", {})
        usual = configured(config.DetectionConfig, parameters, "detect_object").detector
        return DETECTORS.load(self.detector or usual)()

    def _measure(
        self,
        finder: ObjectDetector,
        snapshots: list[Snapshot],
        region: regions.SurfaceRegion,
    ) -> tuple[DetectedObject, ...] | None:
        for snapshot in snapshots[len(self._views) :]:
            self._views.append(pictures.see(snapshot, region, self.planning_scene))
        found = self._seen_in(finder, self._views, region)
        if found is None or _asked_of(found, _sure(finder)) or all(map(_upright, found)):
            return found
        # what says how things lie looks at each picture by itself: what it puts together of
        # several may be a part of a thing, beside which another picture shows the whole
        for view in reversed(self._views):
            alone = self._seen_in(finder, [view], region)
            if alone and _asked_of(alone, _sure(finder)):
                return alone
        return found

    def _seen_in(
        self, finder: ObjectDetector, views: Sequence[View], region: regions.SurfaceRegion
    ) -> tuple[DetectedObject, ...] | None:
        """What a detector finds in some views; what lies is measured by the points of all."""
        low, high = region.support_heights
        try:
            found = finder.detect(views, low, high, self.object)
        except DetectorError as error:
            raise Failure(error.code, str(error)) from None
        if found is None:
            return None
        return lying.remeasured(found, views, low, high, self.object, finder.accepted)

    def _corners(self) -> Array:
        surface = self.site.surfaces.get(self.on)
        if surface is None:
            known = ", ".join(self.site.surfaces) or "none"
            raise Failure(
                "SURFACE_NOT_SEEN", f"the site has no surface {self.on!r}; surfaces: {known}"
            )
        return regions.surface_corners(surface, self.frames)

    def _unseen(self, looks: int) -> Failure:
        return Failure(
            "SURFACE_NOT_SEEN",
            f"{looks} looks showed no level surface where {self.on} is said to be: is the robot "
            "in front of it, and is anything in the way?",
            surface=self.on,
            looks=looks,
        )

    def _not_found(self, things: tuple[DetectedObject, ...], finder: ObjectDetector) -> Failure:
        known = tuple(getattr(finder, "categories", matching.KNOWN))
        told_apart = matching.MatchConfig(categories=known)
        seen = [_measured(thing) for thing in things]
        why = [", ".join(matching.misfits(thing, self.object, told_apart)) for thing in things]
        told = (f"{thing}, {reason}" for thing, reason in zip(seen, why, strict=True))
        there = f"there: {'; '.join(told)}" if seen else "nothing stands there"
        return Failure(
            "OBJECT_NOT_FOUND",
            f"no {self.object.category} as asked on {self.on}; {there}",
            seen=seen,
            misfits=why,
        )


def _measured(thing: DetectedObject) -> str:
    """The object in words, such as "bottle 63 x 63 x 200 mm"."""
    return f"{thing.category} {' x '.join(f'{1000 * size:.0f}' for size in thing.size)} mm"


def _asked_of(things: Sequence[DetectedObject], accepted: float) -> DetectedObject | None:
    """Return the object with the best score, if that score is high enough."""
    return next((thing for thing in things if thing.score >= accepted), None)


def _sure(finder: ObjectDetector) -> float:
    """The score from which on a detector's match is worth no further look."""
    return float(getattr(finder, "sure", finder.accepted))


def _upright(thing: DetectedObject) -> bool:
    """Whether an object's z axis is the vertical."""
    return float(thing.pose.transform.rotation[2, 2]) > UPRIGHT
