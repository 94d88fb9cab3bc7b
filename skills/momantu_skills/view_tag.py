"""view_tag: bring the arm's camera before a tag board, to a view that no earlier view was like."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Pose
from momantu_bt.lazy import lazily
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.skill import In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.perception.tags import view_lines

with lazily():
    from momantu_skills.gaze import tag_views
    from momantu_skills.manipulation.arm import Arm

THINKING = 0.5
"""Time allowed for choosing a view and planning the way, s."""


class ViewTag(Skill):
    """Move the arm until its camera sees a tag board as in no view before."""

    tag: str = In(names="tag", doc="the tag or bundle of the site")
    at: Pose = In(doc="where it is, such as the `tag_pose` of find_apriltag")
    file: str | None = In(None, doc="the earlier views, as record_view writes them")
    turned: float = Out(unit="rad", doc="of the hand, against the earlier view most like this one")
    also_called = ("next_view", "choose_view")
    failures = {
        "NO_NEW_VIEW": "no free posture shows the whole board from another side",
        "CAMERA_NOT_ON_ARM": "the robot's first camera is not carried by its arm",
        "TAG_UNKNOWN": "the site has no such tag",
        "NO_PLAN": "no way for the arm was found",
        "START_IN_COLLISION": "the arm touches something and does not get out",
        "ARM_STUCK": "the arm does not follow its trajectory",
        "VIEW_NOT_READ": "the file of earlier views cannot be read",
    }
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {}
    symptoms = {
        "NO_PLAN": {Symptom.ARM_WAY_BLOCKED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE},
    }
    planning_scene: ArmScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Choose the view, plan, move."""
        if not robot.description.eye_in_hand:
            raise Failure(
                "CAMERA_NOT_ON_ARM",
                f"{robot.description.camera()[0]} is not on the arm; a person moves the board, or "
                "the head, between the views",
            )
        bundle = self.site.tags.get(self.tag)
        if bundle is None:
            known = ", ".join(self.site.tags) or "none"
            raise Failure("TAG_UNKNOWN", f"the site has no tag {self.tag!r}; tags: {known}")
        try:
            earlier = [] if self.file is None else view_lines.hands_of(Path(self.file))
        except ValueError as error:
            raise Failure("VIEW_NOT_READ", str(error)) from None
        arm = Arm(self, robot, self.planning_scene)
        yield from arm.settle()
        arm.observe()
        odom_from_tag = self.frames.lookup(ODOM, self.at.frame) @ self.at.transform
        corners = np.stack([plate.corners() for plate in bundle.plates])
        view: tag_views.BoardView = yield from compute(
            lambda: tag_views.plan_view(arm, odom_from_tag, corners, earlier), THINKING
        )
        for trajectory in view.way:
            yield from arm.follow(trajectory, "to the next view")
        self.turned = view.turned
