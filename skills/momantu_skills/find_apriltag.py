"""find_apriltag: sweep until the tag is seen, then measure where it lies."""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, TagAt, TagOn
from momantu_bt.failure import FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose
from momantu_bt.lazy import lazily
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Localization, PlanningScene, Snapshot
from momantu_bt.skill import Compute, Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.perception.camera.snapshot import take

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.perception import tags
    from momantu_skills.perception.geometry import regions


BUDGET = 0.05
"""Time allowed for searching one picture, s."""
PICTURES = 4
"""Pictures to average once the tag is in the middle of the view."""
LOOKS = 4
"""Fewest views of a surface after the view of its middle. A camera that turns also moves a little,
so that it may see past what hid the tag."""
EXACT, SQUARE = 0.02, 0.05
"""Largest errors of a measured tag, m and rad: twice the largest error from the camera's
mounting."""


class FindAprilTag(Skill):
    """Look over a surface (or around) until a tag36h11 tag is seen, and measure its pose."""

    tag_id: int = In(least=0, most=586, doc="which tag of the family 36h11")
    edge: float = In(unit="m", least=0.001, most=1, doc="length of the black square's side")
    on: str | None = In(None, names="surface", doc="the surface it lies on; None: look around")
    tag_pose: Pose = Out(doc="centre of the tag, z out of it, x to its right; odom, stamped")
    tag_sigma: float = Out(unit="m", doc="standard deviation of its position")
    also_called = ("find_tag", "detect_tag", "find_marker", "detect_marker")
    failures = {"TAG_NOT_SEEN": "no picture of the sweep showed the tag; data lists other tags"}
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {Activity.FIND_MARKER: ""}
    symptoms = {
        "TAG_NOT_SEEN": {Symptom.NOT_SEEN, Symptom.MARKER_NOT_SEEN},
    }
    localization: Localization = Needs()
    planning_scene: PlanningScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Sweep until the tag is seen, look at it, average the measurements."""
        others: set[int] = set()
        for point in self._points(robot):
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, point)
            first = None
            if snapshot is not None:
                first = yield from self._search(snapshot, others)
            if first is None:
                continue
            sightings = [first, *(yield from self._watch(robot, first, others))]
            result = tags.average(sightings)
            self.tag_pose = Pose(result.odom_from_tag, ODOM, result.stamp)
            self.tag_sigma = result.sigma
            return
        raise self._not_seen(others)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the tag is at the measured pose; a failure denies it is on the surface."""
        if failure is None:
            return TagAt(self.tag_id, self.tag_pose.transform, EXACT, SQUARE)
        unseen = failure.code == "TAG_NOT_SEEN" and self.on in self.site.surfaces
        return TagOn(self.tag_id, self.on) if unseen else None

    def _watch(
        self, robot: Robot, first: tags.TagSighting, others: set[int]
    ) -> Generator[str | Compute, Any, list[tags.TagSighting]]:
        """Take more pictures, with the tag in the middle of the view where possible."""
        seen: list[tags.TagSighting] = []
        snapshot = yield from surveys.glance(
            self, robot, self.planning_scene, first.odom_from_tag.position
        )
        for _ in range(PICTURES):
            sighting = yield from self._search(snapshot or take(robot, self.frames), others)
            snapshot = None
            if sighting is not None:
                seen.append(sighting)
        return seen

    def _search(
        self, snapshot: Snapshot, others: set[int]
    ) -> Generator[str | Compute, Any, tags.TagSighting | None]:
        ids, sighting = yield from compute(
            partial(tags.search, snapshot, self.tag_id, self.edge), budget=BUDGET
        )
        others.update(ids - {self.tag_id})
        return sighting

    def _points(self, robot: Robot) -> list[Array]:
        if self.on is None:
            return surveys.around(self, robot)
        surface = self.site.surfaces.get(self.on)
        if surface is None:
            known = ", ".join(self.site.surfaces) or "none"
            raise Failure("TAG_NOT_SEEN", f"the site has no surface {self.on!r}; surfaces: {known}")
        corners = regions.surface_corners(surface, self.frames)
        return [corners.mean(axis=0), *surveys.looks_over(self, robot, corners, LOOKS)]

    def _not_seen(self, others: set[int]) -> Failure:
        where = f"on {self.on}" if self.on is not None else "around"
        ids = sorted(others)
        beside = f"; other tags there: {', '.join(map(str, ids))}" if ids else ""
        return Failure(
            "TAG_NOT_SEEN", f"no tag {self.tag_id} was seen {where}{beside}", other_tags=ids
        )
