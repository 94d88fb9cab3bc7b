"""detect_object: find the asked thing on a surface, or say that it is not there."""

from __future__ import annotations

from momantu_bt.geometry import Array
from momantu_bt.messages import DetectedObject, ObjectClass
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Localization, PlanningScene
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute

BUDGET = 0.1
"""s granted to making sense of one look, and again to comparing them."""


class DetectObject(Skill):
    """Look over a surface from several angles, measure what stands on it, and pick the asked one.

    The surface is measured too: tables stand up to 0.1 m and 5 degrees from where the site says,
    and 3 cm higher or lower.
    """

    object: ObjectClass = In(doc="what to find: its category and the sizes that are known")
    on: str = In(names="surface", doc="the surface that it stands on")
    views: int = In(2, doc="how many looks at least; a wide surface takes more")
    found: DetectedObject = Out(doc="the best match; pose in odom, stamped")
    failures = {
        "OBJECT_NOT_FOUND": "nothing on the surface is the asked thing; data lists what is there",
        "SURFACE_NOT_SEEN": "no look showed a level surface where the site has one",
    }
    uses = {CAMERA_CARRIER}
    localization: Localization = Needs()
    planning_scene: PlanningScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Sweep, measure, choose."""
        from momantu_skills.perception.detector import GeometricDetector, ObjectDetector
        from momantu_skills.perception.surveys import surface_region, survey

        detector: ObjectDetector = GeometricDetector()
        corners = self._corners()
        region = surface_region(corners)
        views = yield from survey(
            self,
            robot,
            corners,
            region,
            at_least=self.views,
            budget=BUDGET,
            unseen="SURFACE_NOT_SEEN",
        )
        low, high = region.support_heights
        result = yield from compute(
            lambda: detector.detect(views, low, high, self.object), budget=BUDGET
        )
        if result is None:
            raise Failure(
                "SURFACE_NOT_SEEN",
                f"{len(views)} looks showed no level surface within {high - low:.2f} m around the "
                f"height of {self.on}: is the robot in front of it?",
                surface=self.on,
                points=[len(view.points) for view in views],
            )
        best = next((t for t in result.things if t.score >= detector.accepted), None)
        if best is None:
            raise self._not_found(result.things)
        self.found = best

    def _corners(self) -> Array:
        from momantu_skills.perception.regions import surface_corners

        surface = self.site.surfaces.get(self.on)
        if surface is None:
            known = ", ".join(self.site.surfaces) or "none"
            raise Failure(
                "SURFACE_NOT_SEEN", f"the site has no surface {self.on!r}; surfaces: {known}"
            )
        return surface_corners(surface, self.frames)

    def _not_found(self, things: tuple[DetectedObject, ...]) -> Failure:
        seen = [
            f"{t.category} {' x '.join(f'{1000 * size:.0f}' for size in t.size)} mm" for t in things
        ]
        there = f"there: {', '.join(seen)}" if seen else "nothing stands there"
        return Failure(
            "OBJECT_NOT_FOUND",
            f"no {self.object.category} as asked on {self.on}; {there}",
            seen=seen,
        )
