"""record_view: write what the camera sees of tags into a file, for calibrations."""

from __future__ import annotations

import json
from collections.abc import Generator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np

from momantu_bt.geometry import Array, Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import CameraImage, RobotState
from momantu_bt.robot import Robot, read_camera
from momantu_bt.skill import Compute, Failure, In, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.perception.camera.standing import until_standing

with lazily():
    from momantu_skills.perception.tags import detector, recognise, view_lines

BUDGET = 0.05
"""Time allowed for searching one picture, s."""
Shown: TypeAlias = tuple[list[tuple[int, float, Array]], Transform | None]
"""Tags with their edges, m, and corners (4, 2), px; and the target's pose, if one is asked."""


class RecordView(Skill):
    """Add a line to a file of views: the tags that the camera sees, the joints, the odometry."""

    file: str = In(doc="the file; it is made if it does not exist")
    edge: float | None = In(
        None, unit="m", least=0.001, most=1, doc="length of the black squares' sides"
    )
    target: str | None = In(
        None,
        names="tag",
        doc="in place of `edge`: a bundle of the site, whose pose and the hand's are added",
    )
    seen: int = Out(doc="how many tags the line has")
    also_called = ("collect_view", "save_view", "capture_view")
    failures = {
        "TAG_NOT_SEEN": "no tag is in the picture",
        "STILL_MOVING": "the robot does not come to rest",
        "VIEW_NOT_WRITTEN": "the file cannot be written, or it holds the views of another run",
    }
    senses = {"camera"}
    one_of = (("edge", "target"),)
    activities = {}
    symptoms = {"TAG_NOT_SEEN": {Symptom.NOT_SEEN, Symptom.MARKER_NOT_SEEN}}

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """The usual name; where no tag is in view nothing is written."""
        return {"inputs": {"file": "views.jsonl", "edge": 0.06}}

    def run(self, robot: Robot) -> Run:
        """Wait until the robot stands, take a picture, add the line."""
        yield from until_standing(robot)
        image, state = read_camera(robot), robot.state()
        tags, poses = yield from (self._any(image) if self.target is None else self._its(image))
        line = _line(robot.description.camera()[0], image, state, tags)
        if poses is not None:
            base, hand = robot.description.base_frame, robot.description.hand.frame
            line[view_lines.HAND] = view_lines.numbers_of(
                self.frames.lookup(base, hand, image.stamp)
            )
            line[view_lines.TARGET] = view_lines.numbers_of(poses)
        _append(Path(self.file), json.dumps(line) + "\n", state.stamp)
        self.seen = len(tags)

    def _any(self, image: CameraImage) -> Generator[str | Compute, Any, Shown]:
        """Every tag of the usual family."""
        found: dict[int, Array] = yield from compute(
            partial(detector.find_tags, [image]), budget=BUDGET
        )
        if not found:
            raise Failure("TAG_NOT_SEEN", "the camera's picture shows no tag")
        edge = cast(float, self.edge)
        return [(tag, edge, corners) for tag, corners in sorted(found.items())], None

    def _its(self, image: CameraImage) -> Generator[str | Compute, Any, Shown]:
        """The tags of the target that count, and its pose in the camera's frame."""
        name = cast(str, self.target)
        if name not in self.site.tags:
            known = ", ".join(self.site.tags) or "none"
            raise Failure("TAG_NOT_SEEN", f"the site has no tag {name!r}; tags: {known}")
        shown: recognise.Recognition = yield from compute(
            partial(recognise.recognise, [image], {name: self.site.tags[name]}), budget=BUDGET
        )
        found = shown.named(name)
        if found is None:
            why = shown.refused.get(name, "none of its tags is in the picture")
            raise Failure("TAG_NOT_SEEN", f"the camera's picture does not show {name}: {why}")
        used = sorted(found.pose.used, key=lambda each: each.plate.tag_id)
        tags = [(each.plate.tag_id, each.plate.edge, each.corners) for each in used]
        return tags, found.pose.camera_from_bundle


def _line(
    camera: str, image: CameraImage, state: RobotState, tags: Sequence[tuple[int, float, Array]]
) -> dict[str, Any]:
    matrix, base = image.intrinsics, Pose2D.from_transform(state.odom_from_base)
    return {
        "stamp": state.stamp,
        "camera": camera,
        "intrinsics": [float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))],
        "joints": state.joints(),
        "odometry": [base.x, base.y, base.yaw],
        "tags": [
            {"id": tag, "edge": edge, "corners": np.round(corners, 4).tolist()}
            for tag, edge, corners in tags
        ],
    }


def _append(file: Path, line: str, stamp: float) -> None:
    """Add a line to a file of this run; raises Failure VIEW_NOT_WRITTEN."""
    try:
        last = file.read_text(encoding="utf-8").splitlines()[-1:] if file.exists() else []
        if last and not json.loads(last[0])["stamp"] < stamp:
            raise Failure(
                "VIEW_NOT_WRITTEN",
                f"{file} ends at a later time than now, {stamp:.2f} s: it is another run's; "
                "name another file, or remove it",
            )
        with file.open("a", encoding="utf-8") as out:
            out.write(line)
    except OSError as error:
        raise Failure("VIEW_NOT_WRITTEN", f"{file}: {error.strerror or error}") from None
    except (ValueError, TypeError, KeyError):
        raise Failure("VIEW_NOT_WRITTEN", f"{file} is no file of views; name another one") from None
