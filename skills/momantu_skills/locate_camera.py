"""locate_camera: where the camera is in the map, from tags whose places the site knows."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from functools import partial
from typing import Any

import numpy as np

from momantu_bt.claim import CameraAt, Claim
from momantu_bt.failure import FailureValue
from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Array, Pose
from momantu_bt.lazy import lazily
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import PlanningScene, Snapshot
from momantu_bt.skill import Compute, Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_bt.tags import TagBundle

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.perception import light
    from momantu_skills.perception.camera import averaging, snapshot
    from momantu_skills.perception.tags import covariances, places

BUDGET = 0.1
"""Time allowed for searching a picture and for the pose, s."""
EXACT, SQUARE, SIGMAS = 0.02, 0.05, 4.0
"""Errors of a claimed pose, m and rad, from the camera's mounting; and standard deviations beside
them."""


class LocateCamera(Skill):
    """Measure where the camera is in the map, from tags whose places the site knows."""

    tag: str | None = In(None, names="tag", doc="from this tag or bundle; None: from all there are")
    look: bool = In(True, doc="point the camera at the tags, then around, until one shows")
    camera_pose: Pose = Out(doc="of the camera's optical frame, in map, stamped")
    camera_covariance: tuple[float, ...] = Out(
        doc="6 x 6, row by row: x, y, z in m, turns about the axes of map in rad"
    )
    seen: tuple[int, ...] = Out(doc="ids of the tags that count")
    also_called = ("localize_camera", "camera_from_tag")
    failures = {
        "TAG_NOT_SEEN": "no picture showed a tag whose place is known; data lists the ids there",
        "TAG_PLACE_UNKNOWN": "the site does not tell the place of such a tag",
        "TAG_UNUSABLE": "tags contradict each other, or are not as large as the site says",
    }
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {}
    symptoms = {
        "TAG_NOT_SEEN": {Symptom.NOT_SEEN, Symptom.MARKER_NOT_SEEN},
        "TAG_UNUSABLE": {Symptom.MARKER_NOT_SEEN},
    }
    planning_scene: PlanningScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Look until a picture shows a known tag, then measure."""
        known = self._known()
        ids: set[int] = set()
        first = snapshot.take(robot, self.frames)
        picture: Snapshot | None = first
        for point in (None, *(self._points(robot, known, first) if self.look else ())):
            if point is not None:
                picture = yield from surveys.glance(self, robot, self.planning_scene, point)
            if picture is None:
                continue
            found = yield from self._measured(robot, picture, known)
            ids.update(found.ids)
            if found.unusable:
                # another picture, with fewer tags in it, would only hide the contradiction
                raise Failure("TAG_UNUSABLE", found.unusable, ids=sorted(ids))
            if found.map_from_camera is not None:
                self.camera_pose = Pose(found.map_from_camera, MAP, found.stamp)
                self.camera_covariance = covariances.as_port(found.covariance)
                self.seen = found.used
                return
        others = f"; other tags there: {', '.join(map(str, sorted(ids)))}" if ids else ""
        raise Failure(
            "TAG_NOT_SEEN", f"no picture shows {', '.join(known)}{others}", ids=sorted(ids)
        )

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the camera is there."""
        if failure is not None:
            return None
        variances = np.diag(np.reshape(self.camera_covariance, (6, 6)))
        return CameraAt(
            robot.description.camera()[1].frame,
            self.camera_pose.transform,
            EXACT + SIGMAS * float(np.sqrt(variances[:3].sum())),
            SQUARE + SIGMAS * float(np.sqrt(variances[3:].sum())),
        )

    def _known(self) -> Mapping[str, TagBundle]:
        """The tags that count, all with their places."""
        tags = self.site.tags
        if self.tag is not None:
            tags = {name: each for name, each in tags.items() if name == self.tag}
        placed = {n: each for n, each in tags.items() if each.map_from_bundle is not None}
        if not placed:
            what = "of any tag" if self.tag is None else f"of the tag {self.tag!r}"
            raise Failure(
                "TAG_PLACE_UNKNOWN",
                f"the site does not tell the place {what}; name it under site.tags in the world "
                "file, with its `place`",
            )
        return placed

    def _points(self, robot: Robot, known: Mapping[str, TagBundle], first: Snapshot) -> list[Array]:
        """Where to look: at the tags as far as the robot knows where it is, then around."""
        points: list[Array] = []
        try:
            odom_from_map = self.frames.lookup(ODOM, MAP)
        except Failure:  # nothing tells where the robot is
            pass
        else:
            points = [
                odom_from_map.apply(each.map_from_bundle.position)
                for each in known.values()
                if each.map_from_bundle is not None
            ]
            camera = first.odom_from_camera.position
            points.sort(key=lambda point: float(np.linalg.norm(point - camera)))
        return [*points, *surveys.around(self, robot)]

    def _measured(
        self, robot: Robot, picture: Snapshot, known: Mapping[str, TagBundle]
    ) -> Generator[str | Compute, Any, places.Place]:
        """Where the camera is by a picture; in the dark by the mean of several."""
        seen = light.brightness(picture.image.color[..., 1])
        count = 1 if seen.too_dark else seen.pictures
        pictures = yield from averaging.still_pictures(robot, self.frames, picture, count)
        found: places.Place = yield from compute(
            partial(places.place_of, [each.image for each in pictures], known), budget=BUDGET
        )
        return found
