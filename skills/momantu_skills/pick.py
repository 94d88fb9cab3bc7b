"""pick: grasp a detected object and lift it, and make sure that it really is in the hand."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, Holding, ObjectAt
from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import DetectedObject, GripperCommand, ObjectClass
from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.service import HeldObject
from momantu_bt.skill import Compute, In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.gaze.look_at import look_at
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.config import GraspConfig, Hold
from momantu_skills.manipulation.hand.freshness import check_fresh
from momantu_skills.manipulation.hand.gripper import bump, move_gripper, open_hand, rested_force
from momantu_skills.manipulation.hand.resting import held_level, lies, put_right
from momantu_skills.manipulation.scene.arm_scene import ArmScene

with lazily():
    from momantu_skills.gaze import unseen_ways
    from momantu_skills.manipulation.hand import reaching, verification


THINKING = 0.4
"""Time allowed for choosing a grasp and planning, s: twice the median."""
LEAST_WEIGHT = 0.5
"""Least increase of the load on the wrist with the object in the hand, N: four times the noise of
the force sensor."""
SQUEEZE = 0.03
"""The fingers are commanded to close to the object's width less this, m. That is enough to reach
the full force and to notice a missed object; closing completely would make opening slower."""
BUMP = 25.0
"""Contact force on the wrist that stops the approach, N: enough to push a can aside, too little to
cause damage."""
THERE = 0.03
"""Largest distance from the detected position at which the object counts as seen there, m."""


class Pick(Skill):
    """Grasp a detected object and lift it: look, reach, close, check, lift, look again.

    After a failure the hand is open and retreated, unless another skill controlled the arm.
    """

    object: DetectedObject = In(doc="the detected object to grasp; recent pose in odom")
    lift: float = In(0.12, unit="m", least=0, most=1, doc="height to lift it, straight up")
    by: Hold | None = In(
        None,
        doc="the part to hold it by; any: the body, or else rim or handle; None: the site chooses",
    )
    also_called = ("grab", "grasp", "take", "pick_up", "lift", "get", "grip")
    failures = {
        "STALE_POSE": "the pose is too old, or something was touched since it was seen",
        "NOTHING_THERE": "the camera sees nothing where the object should stand",
        "NO_GRASP": "no grasp can be approached, held and lifted from here",
        "NO_PLAN": "the grasps can be reached, but no path to them was found",
        "GRASP_MISSED": "the fingers closed on nothing, or on something of another size",
        "SLIPPED": "it was between the fingers and no longer is",
        "HAND_FULL": "the hand holds something already",
        "ARM_STUCK": "the arm or the gripper does not follow its commands",
    }
    uses = {ARM, "gripper", CAMERA_CARRIER}
    senses = {"camera"}
    activities = {Activity.GRASP: "", Activity.REACH: "/reaching"}
    symptoms = {
        "STALE_POSE": {Symptom.OUTDATED},
        "NOTHING_THERE": {Symptom.NOT_SEEN},
        "NO_GRASP": {Symptom.NO_GRASP},
        "NO_PLAN": {Symptom.ARM_OFF_COURSE, Symptom.ARM_WAY_BLOCKED},
        "GRASP_MISSED": {Symptom.NOT_HELD, Symptom.HAND_STUCK},
        "SLIPPED": {Symptom.NOT_HELD},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.HAND_STUCK, Symptom.SLOW},
    }
    planning_scene: ArmScene = Needs()

    def __init__(self) -> None:
        """Start without an object."""
        super().__init__()
        self._seen: DetectedObject | None = None

    @property
    def _thing(self) -> DetectedObject:
        """The object, in a pose in which it can rest."""
        if self._seen is None:
            self._seen = put_right(self.object)
        return self._seen

    def run(self, robot: Robot) -> Run:
        """Run all steps; each step is a method below."""
        arm = Arm(self, robot, self.planning_scene)
        self._check_start(arm)
        yield from arm.settle()
        yield from self._look(arm)
        plan = yield from unseen_ways.planned_in_sight(
            arm, lambda: self._plan(arm), lambda plan: plan.transit, THINKING
        )
        yield from self._reach(arm, plan)
        rest = yield from self._close(arm, plan)
        yield from self._lift(arm, plan, rest)
        yield from self._look_again(arm)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the object is in the hand; a failure denies this, or that it stood there.

        A failure that says nothing about the hand or the table (no plan, an old pose) claims
        nothing.
        """
        if failure is None or failure.code in ("GRASP_MISSED", "SLIPPED"):
            return Holding(True)
        if failure.code == "HAND_FULL":
            return Holding(False)
        if failure.code == "NOTHING_THERE":
            thing = ObjectClass(self._thing.category)
            return ObjectAt(thing, self._thing.pose.transform, THERE)
        return None

    def _check_start(self, arm: Arm) -> None:
        held = self.planning_scene.held
        if held is not None:
            raise Failure("HAND_FULL", f"the hand already holds a {held.object.category}")
        last = self.planning_scene.last_contact
        check_fresh(self._thing.pose, self._thing.category, self.clock.now(), last, arm.hand)

    def _look(self, arm: Arm) -> Run:
        """Observe the surroundings and check that something stands where the object should be."""
        yield from self._turn_camera(arm)
        arm.observe()
        arm.scene.support_below(self._thing)
        thing = self._thing
        pose, support = thing.pose.transform, thing.support_height
        if not verification.stands_there(arm.scene.points, pose, thing, support):
            x, y, z = pose.position
            raise Failure(
                "NOTHING_THERE",
                f"the camera sees no {thing.category} at ({x:.2f}, {y:.2f}, {z:.2f}) m in odom",
                position=[float(x), float(y), float(z)],
            )

    def _turn_camera(self, arm: Arm) -> Run:
        """Point the camera at the object as closely as its joints allow."""
        try:
            yield from look_at(self, arm.robot, self._thing.pose.position)
        except Failure as failure:
            if failure.code != "OUT_OF_VIEW":
                raise

    def _plan(self, arm: Arm) -> reaching.PickPlan:
        try:
            return reaching.plan_pick(arm, self._thing, self.lift, self._part())
        except Failure as failure:
            if failure.code != "START_IN_COLLISION":
                raise
            raise Failure("NO_PLAN", failure.value.message, **failure.value.data) from None

    def _part(self) -> Hold:
        """The part that the tree names, or else the site."""
        parameters = self.site.services.get("pick", {})
        return self.by or configured(GraspConfig, parameters, "pick").by

    def _reach(self, arm: Arm, plan: reaching.PickPlan) -> Run:
        """Open the hand on the way to the pre-grasp, then approach in a straight line."""
        effector = arm.robot.description.hand
        opened = GripperCommand(effector.max_width, arm.force)
        for trajectory in plan.transit:
            for phase in arm.follow(trajectory, "reaching"):
                arm.robot.command(effector.actuator, opened)
                yield phase
        yield from self._gripper_or_stuck(
            open_hand(arm.robot, self.clock, effector.max_width, arm.force, arm.hand.close_time)
        )
        rest = yield from rested_force(arm.robot, self.frames, "feeling", 3)
        watch = bump(self.frames, rest, BUMP)
        arrived = yield from arm.follow(plan.approach, "approaching", watch)
        if not arrived:
            self.planning_scene.touched()
            yield from arm.settle()
            yield from arm.follow(arm.reversed(plan.approach), "drawing back")
            raise Failure("GRASP_MISSED", "the hand met something before it was around the object")

    def _close(
        self, arm: Arm, plan: reaching.PickPlan
    ) -> Generator[str | Compute, Any, Array | None]:
        """Close with limited force and check the opening; measure the wrist's force first."""
        hand = arm.hand
        rest = yield from rested_force(arm.robot, self.frames, "feeling")
        squeezed = max(0.0, plan.grasp.width - SQUEEZE)
        expected = HeldObject(self._thing, self._grasp_from_object(arm, plan))
        self.planning_scene.holding.expect(expected, arm.state.gripper_width)
        width = yield from move_gripper(
            arm.robot, self.clock, squeezed, arm.force, hand.close_time, "closing"
        )
        self.planning_scene.touched()
        effort = arm.state.gripper_effort
        fits = plan.grasp.fits(width, hand.width_tolerance)
        if not fits or effort < arm.scene.config.least_effort:
            yield from self._give_up(arm, plan)
            raise Failure(
                "GRASP_MISSED",
                f"the fingers closed to {width * 1000:.0f} mm with {effort:.0f} N; "
                f"the {self._thing.category} measures {plan.grasp.width * 1000:.0f} mm there",
                width=width,
                expected=plan.grasp.width,
                effort=effort,
            )
        self.planning_scene.grasped(self._thing, self._grasp_from_object(arm, plan))
        return rest

    def _grasp_from_object(self, arm: Arm, plan: reaching.PickPlan) -> Transform:
        """Return the object's pose in the hand: as detected, but centred between the fingers.

        What lay has been turned along the pads too.
        """
        state = arm.state
        base_from_grasp = arm.group.tip_pose(arm.joints) @ arm.scene.model.tip_from_grasp
        odom_from_grasp = state.odom_from_base @ base_from_grasp
        seen = odom_from_grasp.inverse() @ self._thing.pose.transform
        planned = plan.grasp.object_from_grasp.inverse()
        centre = (seen.position[0], planned.position[1], seen.position[2])
        held = Transform(centre, seen.quaternion)
        return held_level(held) if lies(self._thing) else held

    def _lift(self, arm: Arm, plan: reaching.PickPlan, rest: Array | None) -> Run:
        """Lift, then check that the object is still in the hand and adds weight."""
        yield from arm.follow(plan.lift, "lifting")
        loaded = yield from rested_force(arm.robot, self.frames, "weighing")
        weight = None if rest is None or loaded is None else float(rest[2] - loaded[2])
        if self.planning_scene.held is None or (weight is not None and weight < LEAST_WEIGHT):
            text = (
                "the fingers lost it" if weight is None else f"the hand is {weight:.1f} N heavier"
            )
            yield from self._set_back(arm, plan, loaded)
            yield from self._let_go(arm)
            raise Failure("SLIPPED", f"after lifting, {text}", weight=weight)

    def _set_back(self, arm: Arm, plan: reaching.PickPlan, rest: Array | None) -> Run:
        """Lower the hand before it opens, while the object still seems to be in it."""
        gap = abs(arm.state.gripper_width - plan.grasp.width)
        if gap <= arm.hand.width_tolerance:
            watch = bump(self.frames, rest, BUMP)
            down = arm.reversed(plan.lift, arm.hand.approach_speed)
            yield from arm.follow(down, "setting back", watch)

    def _look_again(self, arm: Arm) -> Run:
        """Check that the place where the object stood is empty, unless the hand hides it."""
        yield "looking"
        arm.observe()
        thing = self._thing
        pose, support = thing.pose.transform, thing.support_height
        if verification.stands_there(arm.scene.points, pose, thing, support):
            yield from self._let_go(arm)
            raise Failure("SLIPPED", f"the {thing.category} still stands where it stood")
        arm.scene.taken(thing, reaching.CUT)

    def _give_up(self, arm: Arm, plan: reaching.PickPlan) -> Run:
        """Open the hand and retreat along the approach."""
        yield from self._let_go(arm)
        yield from arm.follow(plan.retreat, "drawing back")

    def _let_go(self, arm: Arm) -> Run:
        effector, hand = arm.robot.description.hand, arm.hand
        yield from self._gripper_or_stuck(
            open_hand(arm.robot, self.clock, effector.max_width, arm.force, hand.close_time)
        )
        self.planning_scene.released()

    def _gripper_or_stuck(self, opening: Run) -> Run:
        """Move the gripper; report a gripper that does not move as ARM_STUCK."""
        try:
            yield from opening
        except Failure as failure:
            raise Failure("ARM_STUCK", failure.value.message, **failure.value.data) from None
