"""place: set down the held object on a free spot, and make sure that it stands or lies there."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, Holding, SetDown
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.service import HeldObject
from momantu_bt.skill import Compute, In, Needs, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.gaze.look_at import look_at
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.hand.freshness import check_fresh
from momantu_skills.manipulation.hand.gripper import bump, open_hand, rested_force
from momantu_skills.manipulation.hand.placing import PlacePlan, plan_place
from momantu_skills.manipulation.scene.arm_scene import ArmScene

with lazily():
    from momantu_skills.gaze import unseen_ways
    from momantu_skills.manipulation.hand import (
        evidence,
        lying_down,
        resting,
        rims,
        verification,
        weighing,
    )
    from momantu_skills.manipulation.model import collision, hulls


THINKING = 0.4
"""Time allowed for choosing a spot and planning, s: twice the median."""
BEHIND = 0.05
"""How far before a point of the object something must be to hide it, m: more than the noise."""
HIDDEN = 0.4
"""Share of the object's corners that is hidden if the robot cannot tell how the object stands."""
BESIDE = 0.02
"""Largest distance from its spot at which the object counts as placed, m."""
SEEN = 0.01
"""Distance from the spot, m, beyond which what is seen there is believed: more than its error."""


class Place(Skill):
    """Place the held object on a free spot: look, carry, lower, open, retreat, look again."""

    plane: SupportPlane = In(doc="the measured surface; recent pose in odom")
    spots: tuple[Pose, ...] = In(doc="free spots on it, best first; odom, z up, on the surface")
    upright: bool = In(False, doc="make it stand where it lay when it was picked")
    also_called = ("put", "put_down", "set_down", "drop_off", "place_object", "put_object")
    failures = {
        "NOTHING_HELD": "the hand holds nothing",
        "HELD_UNKNOWN": "the hand holds something, and no pick has said what it is",
        "STALE_POSE": "the surface was measured too long ago, or before the hand last touched it",
        "NO_PLACE_POSE": "the hand cannot set it down on any of the spots from here as it rested",
        "NO_PLAN": "no path leads above a spot",
        "NO_CONTACT": "lowered past the surface's height, nothing was felt",
        "LOST": "it is no longer in the hand, or not where it was set down",
        "TOPPLED": "it was set down, but does not stand upright",
        "ARM_STUCK": "the arm or the gripper does not follow its commands",
    }
    uses = {ARM, "gripper", CAMERA_CARRIER}
    senses = {"camera"}
    activities = {Activity.SET_DOWN: ""}
    symptoms = {
        "NOTHING_HELD": {Symptom.NOT_HELD},
        "STALE_POSE": {Symptom.OUTDATED},
        "NO_PLACE_POSE": {Symptom.CANNOT_SET_DOWN},
        "NO_PLAN": {Symptom.ARM_OFF_COURSE, Symptom.ARM_WAY_BLOCKED},
        "NO_CONTACT": {Symptom.NO_CONTACT},
        "LOST": {Symptom.NOT_HELD},
        "TOPPLED": {Symptom.TOPPLED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.HAND_STUCK, Symptom.SLOW},
    }
    planning_scene: ArmScene = Needs()

    def __init__(self) -> None:
        """Start without a spot."""
        super().__init__()
        self._spot: Transform | None = None

    def run(self, robot: Robot) -> Run:
        """Run all steps; each step is a method below."""
        arm = Arm(self, robot, self.planning_scene)
        held = yield from self._check_start(arm)
        yield from arm.settle()
        self.planning_scene.support(self.plane)
        yield from self._look(arm, self.spots[0].position)
        plan = yield from unseen_ways.planned_in_sight(
            arm, lambda: self._plan(arm, held), lambda plan: plan.transit, THINKING
        )
        self._spot = plan.odom_from_object
        before = arm.scene.surroundings.cells
        for trajectory in plan.transit:
            yield from arm.follow(trajectory, "carrying")
        self._still_held(held)
        yield from self._lower(arm, plan, held)
        yield from self._let_go(arm, held)
        yield from self._draw_back(arm, plan)
        yield from self._look_again(arm, plan, held, before)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the object stands on its spot; a failure denies this, or that it is held."""
        if failure is not None and failure.code == "NOTHING_HELD":
            return Holding(True)
        denied = failure is not None and failure.code in ("LOST", "TOPPLED")
        if self._spot is None or not (failure is None or denied):
            return None
        return SetDown(self._spot, BESIDE)

    def _check_start(self, arm: Arm) -> Generator[str | Compute, Any, HeldObject]:
        held: HeldObject | None = self.planning_scene.held
        if held is None:
            raise (yield from self._not_known(arm))
        last, now = self.planning_scene.last_contact, self.clock.now()
        check_fresh(self.plane.pose, "surface", now, last, arm.hand)
        if not self.spots:
            raise Failure("NO_PLACE_POSE", "the list of free spots is empty", spots=0)
        check_fresh(self.spots[0], "free spot", now, last, arm.hand)
        return held

    def _not_known(self, arm: Arm) -> Generator[str | Compute, Any, Failure]:
        """The failure where no pick has reported what the hand holds, as its senses have it."""
        found = yield from weighing.weigh(self, arm.robot, self.planning_scene)
        said, data = weighing.told(found), weighing.odds(found)
        grip = evidence.weighed(found)
        if grip is evidence.Grip.EMPTY:
            return Failure(
                "NOTHING_HELD", f"there is nothing in the hand to set down: {said}", **data
            )
        if grip is evidence.Grip.UNKNOWN:
            return Failure(
                "NOTHING_HELD",
                f"no pick has reported anything in the hand, and {said}; pick the object, or let "
                "examine_hand find out what the hand holds",
                **data,
            )
        return Failure(
            "HELD_UNKNOWN",
            "the hand holds something, but no pick has reported what it is and how it is held: "
            f"{said}; let it go with release where it may fall a little, then detect and pick it",
            **data,
        )

    def _look(self, arm: Arm, point: Array, around: Sequence[Array] = ()) -> Run:
        """Take a picture of the surroundings of a point, with the camera turned as far as possible.

        around: corners (n, 3) in odom of solids to avoid, for an arm that carries the camera.
        """
        try:
            yield from look_at(self, arm.robot, point, around=around)
        except Failure as failure:
            if failure.code != "OUT_OF_VIEW":
                raise
        arm.observe()

    def _plan(self, arm: Arm, held: HeldObject) -> PlacePlan:
        try:
            return plan_place(arm, held, self.spots, self.upright)
        except Failure as failure:
            if failure.code != "START_IN_COLLISION":
                raise
            raise Failure("NO_PLAN", failure.value.message, **failure.value.data) from None

    def _still_held(self, held: HeldObject) -> None:
        if self.planning_scene.held is None:
            raise Failure("LOST", f"the {held.object.category} slipped out of the hand on the way")

    def _lower(self, arm: Arm, plan: PlacePlan, held: HeldObject) -> Run:
        """Lower until the surface carries part of the weight, if the robot can feel that."""
        rest = yield from rested_force(arm.robot, self.frames, "feeling")
        watch = bump(self.frames, rest, arm.hand.contact_force, vertical=True)
        if watch is None:
            yield from arm.follow(plan.blind, "lowering")
            self._still_held(held)
            return
        reached_end = yield from arm.follow(plan.lower, "lowering", watch)
        self._still_held(held)
        if reached_end:
            yield from arm.follow(arm.reversed(plan.lower), "raising")
            raise Failure(
                "NO_CONTACT",
                f"nothing was felt down to {arm.hand.below * 1000:.0f} mm below the surface that "
                "was measured",
            )

    def _let_go(self, arm: Arm, held: HeldObject) -> Run:
        """Open no wider than needed, as other objects may stand close."""
        hand = arm.hand
        width = min(arm.open_width, arm.state.gripper_width + hand.margin)
        self.planning_scene.touched()
        try:
            yield from open_hand(arm.robot, self.clock, width, arm.force, hand.close_time)
        except Failure as failure:
            raise Failure("ARM_STUCK", failure.value.message, **failure.value.data) from None
        self.planning_scene.released()

    def _draw_back(self, arm: Arm, plan: PlacePlan) -> Run:
        start = arm.joints
        path = arm.line(start, arm.group.tip_pose(start) @ plan.retreat)
        if path is None:
            raise Failure("ARM_STUCK", "the hand cannot draw back along its fingers from here")
        yield from arm.follow(arm.trajectory(path, arm.hand.lift_speed), "drawing back")

    def _look_again(self, arm: Arm, plan: PlacePlan, held: HeldObject, before: Array) -> Run:
        """Check that the object rests as planned on its spot, or close to it if it slipped.

        before: cells (n, 3) in odom that were occupied before; they do not belong to the object.
        """
        pose = plan.odom_from_object
        corners = pose.apply(hulls.object_corners(held.object))
        yield from self._look(arm, pose.position, [corners])
        seen = self._judged(arm, pose, held, before)
        hidden = arm.scene.seen_space.hidden(corners, BEHIND)
        if seen == "about there" or (seen != "there" and hidden.mean() > HIDDEN):
            yield from self._clear_the_view(arm, corners)
            yield from self._look(arm, pose.position, [corners])
            seen = self._judged(arm, pose, held, before)
        what, where = held.object.category, np.round(pose.position, 3).tolist()
        if seen == "toppled":
            raise Failure("TOPPLED", f"the {what} lies where it was set down", position=where)
        if seen == "gone":
            raise Failure("LOST", f"the {what} is not where it was set down", position=where)

    def _judged(self, arm: Arm, pose: Transform, held: HeldObject, before: Array) -> str:
        """Whether the object is "there", "toppled" or "gone"; remember where it is.

        "about there": it was held by its rim, where it may turn between the fingers by centimetres,
        and too little of the rim is seen to tell where it stands.
        """
        thing, points = held.object, arm.scene.points
        bottom = float(pose.position[2]) - resting.rise(thing, pose)
        new = verification.unseen_before(points, before)
        lying, by_rim = abs(float(pose.rotation[2, 2])) < resting.LYING, rims.held_by_rim(held)
        if lying:
            found = lying_down.beside(new, pose, thing, bottom)
        else:
            found = verification.beside(new, pose, thing, bottom, by_rim)
        if found is None and lying:
            return lying_down.at(points, pose, thing, bottom)
        if found is None:
            stands = verification.standing(points, pose, thing, bottom)
            return "about there" if by_rim and stands == "there" else stands
        if lying or float(np.linalg.norm(found.position - pose.position)) > SEEN:
            self._spot = found
        return "there"

    def _clear_the_view(self, arm: Arm, corners: Array) -> Run:
        """Take the hand from before the object (corners (n, 3) in odom), if the arm can.

        In the pose `ready` it does not hide what is before the robot, and a camera on the arm is
        far enough from it to see the whole of it.
        """
        goal = arm.posed(arm.robot.description.named_poses["ready"])
        solid = collision.Obstacle("set down", arm.state.odom_from_base.inverse().apply(corners))
        try:
            way = yield from compute(lambda: arm.route([goal], None, extra=(solid,)), THINKING)
        except Failure:
            return
        for trajectory in way:
            yield from arm.follow(trajectory, "clearing the view")
