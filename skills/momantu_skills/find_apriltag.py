"""find_apriltag: sweep until the tag is seen, then measure where it lies."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, TagAt, TagOn
from momantu_bt.failure import FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.lazy import lazily
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Localization, PlanningScene, Snapshot
from momantu_bt.skill import Compute, Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.perception.camera.snapshot import take

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.perception import light, tags
    from momantu_skills.perception.geometry import regions


BUDGET = 0.05
"""Time allowed for searching one picture, s."""
PICTURES = 4
"""Pictures to average once the tag is in the middle of the view."""
HELD = (0.002, 0.002)
"""Largest movement of the camera between pictures that are averaged, m and rad: about a pixel."""
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
        looked = _Looked()
        for point in self._points(robot):
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, point)
            first = None
            if snapshot is not None:
                first = yield from self._search(robot, snapshot, looked)
            if first is None:
                continue
            sightings = [first, *(yield from self._watch(robot, first, looked))]
            result = tags.average(sightings)
            self.tag_pose = Pose(result.odom_from_tag, ODOM, result.stamp)
            self.tag_sigma = result.sigma
            return
        raise self._not_seen(looked)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the tag is at the measured pose; a failure denies it is on the surface."""
        if failure is None:
            return TagAt(self.tag_id, self.tag_pose.transform, EXACT, SQUARE)
        unseen = failure.code == "TAG_NOT_SEEN" and self.on in self.site.surfaces
        return TagOn(self.tag_id, self.on) if unseen else None

    def _watch(
        self, robot: Robot, first: tags.TagSighting, looked: _Looked
    ) -> Generator[str | Compute, Any, list[tags.TagSighting]]:
        """Take more pictures, with the tag in the middle of the view where possible."""
        seen: list[tags.TagSighting] = []
        snapshot = yield from surveys.glance(
            self, robot, self.planning_scene, first.odom_from_tag.position
        )
        for _ in range(PICTURES):
            picture = snapshot or take(robot, self.frames)
            sighting = yield from self._search(robot, picture, looked)
            snapshot = None
            if sighting is not None:
                seen.append(sighting)
        return seen

    def _search(
        self, robot: Robot, snapshot: Snapshot, looked: _Looked
    ) -> Generator[str | Compute, Any, tags.TagSighting | None]:
        """Search a picture; if it is too noisy for the tag, the mean of as many as it takes."""
        sighting = yield from self._read([snapshot], looked)
        if sighting is not None:
            return sighting
        seen = light.brightness(snapshot.image.color[..., 1])
        looked.lights.append(seen)
        if seen.pictures == 1 or seen.too_dark:
            return None
        pictures = [snapshot]
        while len(pictures) < seen.pictures:
            yield f"averages {seen.pictures} dark pictures"
            pictures.append(take(robot, self.frames))
            if not _still(pictures[0].odom_from_camera, pictures[-1].odom_from_camera):
                pictures = pictures[-1:]
        return (yield from self._read(pictures, looked))

    def _read(
        self, snapshots: list[Snapshot], looked: _Looked
    ) -> Generator[str | Compute, Any, tags.TagSighting | None]:
        ids, sighting = yield from compute(
            partial(tags.search, snapshots, self.tag_id, self.edge), budget=BUDGET
        )
        looked.ids.update(ids)
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

    def _not_seen(self, looked: _Looked) -> Failure:
        where = f"on {self.on}" if self.on is not None else "around"
        ids = sorted(looked.ids - {self.tag_id})
        beside = f"; other tags there: {', '.join(map(str, ids))}" if ids else ""
        told = f"no tag {self.tag_id} was seen {where}{beside}"
        if self.tag_id in looked.ids:
            told = (
                f"tag {self.tag_id} was seen {where}, but its depth was not measured or its edge is"
                f" not {self.edge:g} m{beside}"
            )
        dark = sum(seen.too_dark for seen in looked.lights)
        if looked.lights and 2 * dark > len(looked.lights):
            level, grain = (
                float(np.mean([getattr(seen, name) for seen in looked.lights]))
                for name in ("mean", "noise")
            )
            told += (
                f": it was too dark (mean brightness {level:.0f} of 255, noise {grain:.0f}, in"
                f" {dark} of {len(looked.lights)} pictures): light the place, or give the camera a"
                " longer exposure or more gain"
            )
        return Failure("TAG_NOT_SEEN", told, other_tags=ids, dark_pictures=dark)


@dataclass
class _Looked:
    """What the pictures showed: ids of tags, and the light of pictures without the tag."""

    ids: set[int] = field(default_factory=set)
    lights: list[light.Brightness] = field(default_factory=list)


def _still(one: Transform, other: Transform) -> bool:
    shift = float(np.linalg.norm(one.position - other.position))
    return shift <= HELD[0] and one.angle_to(other) <= HELD[1]
