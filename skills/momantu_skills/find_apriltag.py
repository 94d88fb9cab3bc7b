"""find_apriltag: sweep until the tag is seen, then measure where it lies."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from functools import partial
from typing import Any, cast

import numpy as np

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
from momantu_bt.tags import USUAL_FAMILY, TagBundle, TagFamily, single_tag
from momantu_skills.perception.camera.snapshot import take

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.perception import light
    from momantu_skills.perception.camera import averaging
    from momantu_skills.perception.geometry import regions
    from momantu_skills.perception.tags import covariances, named, single


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
    """Look over a surface (or around) until a tag or a bundle is seen, and measure its pose."""

    tag_id: int | None = In(None, least=0, most=586, doc="which tag of the family")
    edge: float | None = In(
        None, unit="m", least=0.001, most=1, doc="length of the black square's side"
    )
    family: TagFamily = In(USUAL_FAMILY, doc="the family of `tag_id`")
    tag: str | None = In(
        None, names="tag", doc="a tag or bundle of the site, in place of `tag_id` and `edge`"
    )
    on: str | None = In(None, names="surface", doc="the surface it lies on; None: look around")
    tag_pose: Pose = Out(doc="centre of the tag, z out of it, x to its right; odom, stamped")
    tag_sigma: float = Out(unit="m", doc="standard deviation of its position")
    tag_covariance: tuple[float, ...] = Out(
        doc="6 x 6, row by row: x, y, z in m, turns about the axes of odom in rad"
    )
    one_of = (("tag_id", "tag"), ("edge", "tag"))
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
            result = single.average(sightings)
            self.tag_pose = Pose(result.odom_from_tag, ODOM, result.stamp)
            self.tag_sigma = result.sigma
            self.tag_covariance = covariances.as_port(result.covariance)
            return
        raise self._not_seen(looked)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the tag is at the measured pose; a failure denies it is on the surface."""
        bundle = self._bundle()
        if bundle is None:
            return None
        if failure is None:
            pose, family = self.tag_pose.transform, bundle.family
            if self.tag is None:
                return TagAt(bundle.ids[0], pose, EXACT, SQUARE, family)
            return tuple(
                TagAt(each.tag_id, pose @ each.bundle_from_tag, EXACT, SQUARE, family)
                for each in bundle.plates
            )
        unseen = failure.code == "TAG_NOT_SEEN" and self.on in self.site.surfaces
        return TagOn(bundle.ids[0], self.on, bundle.family) if unseen else None

    def _bundle(self) -> TagBundle | None:
        """What is looked for; None for a name that the site does not have."""
        if self.tag is not None:
            return self.site.tags.get(self.tag)
        return single_tag(cast(int, self.tag_id), cast(float, self.edge), self.family)

    def _watch(
        self, robot: Robot, first: single.TagSighting, looked: _Looked
    ) -> Generator[str | Compute, Any, list[single.TagSighting]]:
        """Take more pictures, with the tag in the middle of the view where possible."""
        seen: list[single.TagSighting] = []
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
    ) -> Generator[str | Compute, Any, single.TagSighting | None]:
        """Search a picture; if it is too noisy for the tag, the mean of as many as it takes."""
        sighting = yield from self._read([snapshot], looked)
        if sighting is not None:
            return sighting
        seen = light.brightness(snapshot.image.color[..., 1])
        looked.lights.append(seen)
        if seen.pictures == 1 or seen.too_dark:
            return None
        pictures = yield from averaging.still_pictures(robot, self.frames, snapshot, seen.pictures)
        return (yield from self._read(pictures, looked))

    def _read(
        self, snapshots: list[Snapshot], looked: _Looked
    ) -> Generator[str | Compute, Any, single.TagSighting | None]:
        seek: Callable[[], tuple[set[int], single.TagSighting | None]]
        if self.tag is None:
            tag_id, edge = cast(int, self.tag_id), cast(float, self.edge)
            seek = partial(single.search, snapshots, tag_id, edge, self.family)
        else:
            seek = partial(named.search, snapshots, self.tag, self.site.tags, looked.refused)
        ids, sighting = yield from compute(seek, budget=BUDGET)
        looked.ids.update(ids)
        return sighting

    def _points(self, robot: Robot) -> list[Array]:
        if self.tag is not None and self.tag not in self.site.tags:
            known = ", ".join(self.site.tags) or "none"
            raise Failure("TAG_NOT_SEEN", f"the site has no tag {self.tag!r}; tags: {known}")
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
        bundle = self._bundle()
        own = set() if bundle is None else set(bundle.ids)
        ids = sorted(looked.ids - own)
        beside = f"; other tags there: {', '.join(map(str, ids))}" if ids else ""
        what = self.tag_id if self.tag is None else self.tag
        told = f"no tag {what} was seen {where}{beside}"
        if looked.refused:
            told = f"{what} was seen {where}, but {looked.refused[-1]}{beside}"
        elif own & looked.ids:
            told = (
                f"tag {what} was seen {where}, but its depth was not measured or its edge is"
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
    """What the pictures showed.

    ids: of tags. refused: why a bundle that showed has no pose. lights: of pictures without it.
    """

    ids: set[int] = field(default_factory=set)
    refused: list[str] = field(default_factory=list)
    lights: list[light.Brightness] = field(default_factory=list)
