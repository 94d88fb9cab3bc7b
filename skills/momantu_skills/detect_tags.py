"""detect_tags: every tag and bundle in the camera's picture, with its pose and covariance."""

from __future__ import annotations

from functools import partial

from momantu_bt.claim import Claim, TagAt
from momantu_bt.failure import FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedTag
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_bt.tags import USUAL_FAMILY, TagFamily

with lazily():
    from momantu_skills.perception import light
    from momantu_skills.perception.camera import averaging, snapshot
    from momantu_skills.perception.tags import covariances, recognise

BUDGET = 0.1
"""Time allowed for searching a picture and for all poses, s."""
EXACT, SQUARE, SIGMAS = 0.02, 0.05, 4.0
"""Errors of a claimed pose, m and rad, from the camera's mounting; and standard deviations beside
them."""


class DetectTags(Skill):
    """Measure every tag and bundle in the picture: all that the site knows, and others by size."""

    families: tuple[TagFamily, ...] = In(
        (USUAL_FAMILY,), doc="families of tags that the site does not know"
    )
    edge: float | None = In(
        None,
        unit="m",
        least=0.001,
        most=1,
        doc="edge of tags that the site does not know; None: their poses are not measured",
    )
    tags: tuple[DetectedTag, ...] = Out(doc="what has a pose, the site's first; poses in odom")
    ids: tuple[int, ...] = Out(doc="ids of all tags in the picture, with a pose or not")
    also_called = ("detect_apriltags", "read_tags", "find_all_tags")
    failures = {"TAG_NOT_SEEN": "no tag in the picture has a pose; data lists ids and why"}
    senses = {"camera"}
    activities = {}
    symptoms = {"TAG_NOT_SEEN": {Symptom.NOT_SEEN, Symptom.MARKER_NOT_SEEN}}

    def run(self, robot: Robot) -> Run:
        """Take a picture, or in the dark several, and measure."""
        first = snapshot.take(robot, self.frames)
        seen = light.brightness(first.image.color[..., 1])
        count = 1 if seen.too_dark else seen.pictures
        pictures = yield from averaging.still_pictures(robot, self.frames, first, count)
        shown: recognise.Recognition = yield from compute(
            partial(
                recognise.recognise,
                [each.image for each in pictures],
                self.site.tags,
                self.edge,
                self.families,
            ),
            budget=BUDGET,
        )
        self.ids = tuple(each.tag_id for each in shown.detections)
        if not shown.found:
            raise _not_seen(shown)
        last = pictures[-1]
        odom_from_camera = last.odom_from_camera
        self.tags = tuple(
            DetectedTag(
                each.name,
                each.bundle.family,
                tuple(used.plate.tag_id for used in each.pose.used),
                tuple(used.plate.edge for used in each.pose.used),
                Pose(odom_from_camera @ each.pose.camera_from_bundle, ODOM, last.image.stamp),
                covariances.as_port(
                    covariances.turned(each.pose.covariance, odom_from_camera.rotation)
                ),
            )
            for each in shown.found
        )

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that each single tag is where it was measured."""
        if failure is not None:
            return None
        known = self.site.tags
        return tuple(
            TagAt(
                tag.ids[0],
                tag.pose.transform,
                EXACT + SIGMAS * sum(tag.covariance[at] for at in (0, 7, 14)) ** 0.5,
                SQUARE + SIGMAS * sum(tag.covariance[at] for at in (21, 28, 35)) ** 0.5,
                tag.family,
            )
            for tag in self.tags
            if tag.name not in known or len(known[tag.name].plates) == 1
        )


def _not_seen(shown: recognise.Recognition) -> Failure:
    ids = sorted({each.tag_id for each in shown.detections})
    if not ids:
        return Failure("TAG_NOT_SEEN", "the camera's picture shows no tag", ids=[], refused={})
    why = "; ".join(f"{name}: {reason}" for name, reason in shown.refused.items())
    told = why or "the site knows none of them, and no `edge` is given"
    return Failure(
        "TAG_NOT_SEEN",
        f"the camera's picture shows the tags {', '.join(map(str, ids))}, but none has a pose: "
        f"{told}",
        ids=ids,
        refused=dict(shown.refused),
    )
