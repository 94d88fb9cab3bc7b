"""The toolbox of skills: the arm, the gripper and the camera, for skills of other packages.

It is the code that the installed skills are made of. Everything that takes time is a generator:
`yield from` it. A skill that uses it declares the service and the actuators:

class Wave(Skill):
    \"\"\"Raise the hand, and look at it.\"\"\"

    failures = {**ARM_FAILURES, **LOOK_FAILURES}
    uses = {ARM, CAMERA_CARRIER}
    planning_scene: PlanningScene = Needs()

    def run(self, robot):
        arm = Arm(self, robot)
        yield from arm.move_to("ready")
        yield from arm.move_straight((0.0, 0.0, 0.2))
        yield from look_at(self, robot, arm.hand())

To drive, to find objects and tags, and to measure free space, call the installed skills with
`Skill.call`: they are found by name, on every robot.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.formats.names import valid_names
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import JointTrajectory
from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.service import HeldObject, PlanningScene, Snapshot
from momantu_bt.skill import Run, Skill, compute
from momantu_skills.gaze import look_at as gazing
from momantu_skills.manipulation import arm as arms
from momantu_skills.manipulation.hand import gripper
from momantu_skills.perception.camera import snapshot

with lazily():
    from momantu_skills.gaze import unseen_ways
    from momantu_skills.manipulation.hand import guarded
    from momantu_skills.manipulation.hand.guarded import Contact

__all__ = [
    "ARM",
    "ARM_FAILURES",
    "CAMERA_CARRIER",
    "GRIPPER_FAILURES",
    "LOOK_FAILURES",
    "Arm",
    "Contact",
    "PlanningScene",
    "look_at",
    "picture",
]

ARM_FAILURES: Mapping[str, str] = MappingProxyType(
    {
        "NOT_REACHABLE": "no posture of the arm brings the hand there",
        "NO_PLAN": "no collision-free way was found",
        "START_IN_COLLISION": "the arm touches something and no small motion frees it",
        "ARM_STUCK": "the arm does not follow its trajectory",
    }
)
"""What motions of the arm fail with: `failures = {**ARM_FAILURES, ...}`."""
GRIPPER_FAILURES: Mapping[str, str] = MappingProxyType(
    {"GRIPPER_STUCK": "the gripper does not open"}
)
"""What the gripper fails with."""
LOOK_FAILURES: Mapping[str, str] = MappingProxyType(
    {"OUT_OF_VIEW": "the camera cannot be pointed there"}
)
"""What looking fails with."""

Goal: TypeAlias = "str | Pose | Array"
"""A named pose of the robot, a pose of the hand, or joints (n,) of the arm, rad or m."""

THINKING = 0.4
"""Time that inverse kinematics and planning take, s: twice the median."""
SEEDS = 24
"""Start postures of inverse kinematics for one pose of the hand."""
TRIED = 8
"""Postures to which a way is searched: the quickest to reach."""
LEAST_FORCE = 3.0
"""Least force that is told from noise and from the hand's own inertia, N."""
TOUCH_SPEED = 0.01
"""Speed of the hand towards a contact, m/s: less than 50 N on a rigid wall."""
STEP = 3
"""Every n-th point of a straight line is checked for collisions, 3 cm apart."""


class Arm:
    """The arm of a robot during one run of a skill.

    Poses of the hand are those of the grasp frame: x points out along the fingers, y is their
    closing direction, the origin lies between the pads. Lengths are in m, forces in N.
    """

    def __init__(self, skill: Skill, robot: Robot) -> None:
        """skill: it needs the planning scene, and has ARM in `uses`.

        Raises:
            TypeError: the skill does not declare `planning_scene: PlanningScene = Needs()`.
        """
        if "planning_scene" not in type(skill).needs:
            raise TypeError(
                f"{type(skill).__name__} moves the arm and has no planning scene; declare "
                "`planning_scene: PlanningScene = Needs()`"
            )
        self._skill, self._robot = skill, robot
        self._arm = arms.Arm(skill, robot, skill.services["planning_scene"])

    @property
    def joints(self) -> Array:
        """The current joints (n,), from the base outwards, rad or m."""
        return self._arm.joints

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints (n,)."""
        return self._arm.group.names

    @property
    def held(self) -> HeldObject | None:
        """The object in the hand, or None."""
        held: HeldObject | None = self._arm.service.held
        return held

    def hand(self, joints: Array | None = None) -> Pose:
        """The pose of the hand in odom, now or at joints (n,)."""
        q = self._arm.joints if joints is None else joints
        state = self._robot.state()
        base_from_hand = self._arm.group.tip_pose(q) @ self._arm.scene.model.tip_from_grasp
        return Pose(state.odom_from_base @ base_from_hand, ODOM, state.stamp)

    def observe(self) -> None:
        """Take a picture now; the planning scene adds the obstacles that it shows.

        Raises:
            Failure: SENSOR_DEAD.
        """
        self._arm.observe()

    def is_free(self, joints: Array, margin: float = 0.0) -> bool:
        """Whether arm and load keep `margin` m from everything known at joints (n,)."""
        state = self._robot.state()
        return self._arm.scene.world(state, self.held, margin).free(joints)

    def solve(self, pose: Pose) -> list[Array]:
        """Inverse kinematics: joints (n,) that bring the hand to a pose, quickest first.

        Each is within the limits; collisions are not checked. Random start postures are drawn from
        the skill's own random numbers. The list is empty if no posture was found.
        """
        arm, start = self._arm, self._arm.joints
        base_from_tip = self._base_from(pose) @ arm.scene.model.tip_from_grasp.inverse()
        found, good = arm.group.solve(base_from_tip.matrix[None], arm.seeds(start, SEEDS))
        solved = arm.group.nearest_turn(found[0][good[0]], start)
        costs = np.max(np.abs(solved - start) / arm.group.velocity, axis=1)
        return [solved[i] for i in np.argsort(costs, kind="stable")]

    def plan(self, goal: Goal, then: Sequence[float] | None = None) -> list[JointTrajectory]:
        """Collision-free trajectories from here to a goal, one after the other; see `follow`.

        It takes a while: `way = yield from compute(lambda: arm.plan(goal), budget=0.4)`.
        then: only postures from which the hand can go straight on by this, as in `line`.

        Raises:
            Failure: NOT_REACHABLE, NO_PLAN, START_IN_COLLISION.
            ValueError: the robot has no such named pose.
        """
        return self._arm.route(self._goals(goal, then), self.held)

    def follow(self, way: Sequence[JointTrajectory], phase: str = "moving") -> Run:
        """Follow trajectories to their end.

        Raises:
            Failure: ARM_STUCK.
        """
        for trajectory in way:
            yield from self._arm.follow(trajectory, phase)

    def move_to(
        self,
        goal: Goal,
        phase: str = "moving",
        *,
        then: Sequence[float] | None = None,
        look: bool = True,
    ) -> Run:
        """Take a picture, plan, and move to a named pose, a pose of the hand, or joints.

        then: the straight move that comes next, as in `line`: a posture is chosen from which the
        arm can do it. look: point the camera at parts of the way that no picture has shown, which
        needs CAMERA_CARRIER in `uses`.

        Raises:
            Failure: NOT_REACHABLE, NO_PLAN, START_IN_COLLISION, ARM_STUCK, SENSOR_DEAD.
            ValueError: the robot has no such named pose.
        """
        yield from self._arm.settle()
        self._arm.observe()
        if look:
            way = yield from unseen_ways.planned_in_sight(
                self._arm, lambda: self.plan(goal, then), lambda way: way, THINKING
            )
        else:
            way = yield from compute(lambda: self.plan(goal, then), THINKING)
        yield from self.follow(way, phase)

    def line(self, by: Sequence[float], *, touching: bool = False) -> Array:
        """Joints (k, n) along a straight line of the hand, 1 cm apart, the current ones first.

        by: (x, y, z) in the hand's frame; (0.1, 0, 0) is 10 cm along the fingers. touching: the
        hand itself may meet something on the way; the rest of the arm may not.

        Raises:
            Failure: NOT_REACHABLE, or NO_PLAN where the arm would hit something.
        """
        start = self._arm.joints
        path = self._arm.line(start, self._shifted(start, by))
        if path is None:
            length = float(np.linalg.norm(by))
            raise Failure(
                "NOT_REACHABLE", f"the hand cannot go straight for {length:.2f} m from here"
            )
        self._check_line(path, touching)
        return path

    def move_straight(
        self, by: Sequence[float], phase: str = "moving", *, speed: float | None = None
    ) -> Run:
        """Move the hand straight, without a turn. by: as in `line`. speed: m/s; 0.15 if None.

        Raises:
            Failure: NOT_REACHABLE, NO_PLAN, ARM_STUCK.
        """
        path = self.line(by)
        yield from self.follow([self._timed(path, speed or self._arm.hand.lift_speed)], phase)

    def move_until_force(
        self,
        by: Sequence[float],
        force: float,
        phase: str = "touching",
        *,
        speed: float | None = None,
    ) -> Generator[str, None, Contact]:
        """Move the hand straight until something pushes back with `force` N, at least 3.

        by: the longest way, as in `line`. speed: m/s; 0.01 if None. The arm brakes within 0.1 s,
        so a stiff obstacle is pushed with more than `force`: a rigid one, in simulation, with 49 N
        at 0.01 m/s, 31 N at 0.005 m/s and 92 N at 0.02 m/s where `force` was 8 N. Then the arm
        rests against it with less than `force`. Nothing felt is no failure; see `Contact.felt`.

        The force is measured at the wrist. A robot without such a sensor estimates it from joint
        efforts: that tells a contact, but not its exact force.

        Raises:
            Failure: NOT_REACHABLE, NO_PLAN, ARM_STUCK, SENSOR_DEAD.
            ValueError: the force is too small to be felt.
        """
        if not force >= LEAST_FORCE:
            raise ValueError(f"force {force} N; expected at least {LEAST_FORCE:g} N, above noise")
        path = self.line(by, touching=True)
        slow = self._timed(path, speed or TOUCH_SPEED)
        return (yield from guarded.until_force(self._arm, slow, force, phase))

    def retreat(self, distance: float) -> Run:
        """Move the hand back along its fingers, out of a contact; at most as far as there is room.

        Raises:
            Failure: ARM_STUCK.
        """
        yield from self._arm.back_off(distance)

    def open_gripper(self, width: float | None = None) -> Run:
        """Open to a width, m; None: fully. The gripper's actuator must be in `uses`.

        Raises:
            Failure: GRIPPER_STUCK.
        """
        wide = self._arm.open_width if width is None else width
        arm = self._arm
        yield from gripper.open_hand(
            self._robot, self._skill.clock, wide, arm.force, arm.hand.close_time
        )

    def close_gripper(
        self, width: float = 0.0, force: float | None = None
    ) -> Generator[str, None, float]:
        """Close to a width, or until the fingers press on something; return the width reached, m.

        force: N; None: 45 N, or the gripper's greatest if that is less.
        """
        arm = self._arm
        limit = arm.force if force is None else min(force, arm.force)
        return (
            yield from gripper.move_gripper(
                self._robot, self._skill.clock, width, limit, arm.hand.close_time, "closing"
            )
        )

    def _goals(self, goal: Goal, then: Sequence[float] | None) -> list[Array]:
        """Joints (n,) of a goal, the quickest first."""
        if isinstance(goal, Pose):
            solved = self.solve(goal)
            if then is not None:
                arm = self._arm
                solved = [q for q in solved if arm.line(q, self._shifted(q, then)) is not None]
            if not solved:
                x, y, z = self._base_from(goal).position
                more = "" if then is None else " and then straight on"
                raise Failure(
                    "NOT_REACHABLE",
                    f"no posture of the arm brings the hand to ({x:.2f}, {y:.2f}, {z:.2f}) m in "
                    f"the base frame with that direction{more}; drive nearer, or turn the hand",
                )
            return solved[:TRIED]
        if not isinstance(goal, str):
            return [np.asarray(goal)]
        poses = self._robot.description.named_poses
        if goal not in poses:
            hint = valid_names(goal, poses, "its poses")
            raise ValueError(f"{self._robot.description.name} has no pose {goal!r}; {hint}")
        return [self._arm.posed(poses[goal])]

    def _base_from(self, pose: Pose) -> Transform:
        odom_from_frame = self._skill.frames.lookup(ODOM, pose.frame)
        odom_from_base = self._robot.state().odom_from_base
        return odom_from_base.inverse() @ odom_from_frame @ pose.transform

    def _shifted(self, joints: Array, by: Sequence[float]) -> Transform:
        """base_from_tip after a move in the hand's frame, whose axes are the tip's."""
        x, y, z = (float(part) for part in by)
        return self._arm.group.tip_pose(joints) @ Transform((x, y, z))

    def _timed(self, path: Array, speed: float) -> JointTrajectory:
        return self._arm.trajectory(path, speed)

    def _check_line(self, path: Array, touching: bool) -> None:
        """Raise NO_PLAN where the arm hits something that it did not touch at the start."""
        hand = set(self._robot.description.hand.touch_links) | {"held"}
        world = self._arm.scene.world(self._robot.state(), self.held, 0.0)
        before = set(world.touching(path[0]))
        for q in (*path[STEP::STEP], path[-1]):
            for pair in world.touching(q):
                links = {name.partition(":")[0] for name in pair}
                if pair in before or (touching and links & hand):
                    continue
                a, b = pair
                raise Failure("NO_PLAN", f"on the straight line {a} would touch {b}")


def look_at(
    skill: Skill, robot: Robot, target: Pose | Sequence[float], *, within: float = 0.10
) -> Run:
    """Point the camera at a pose's origin or a point (x, y, z) in odom, and wait until it rests.

    within: largest angle off the middle of the picture, rad. The skill has CAMERA_CARRIER in
    `uses` and needs the planning scene.

    Raises:
        Failure: OUT_OF_VIEW, FRAME_UNKNOWN.
    """
    point: Any = target
    if isinstance(target, Pose):
        point = skill.frames.lookup(ODOM, target.frame).apply(target.position)
    yield from gazing.look_at(skill, robot, point, within=within)


def picture(skill: Skill, robot: Robot) -> Snapshot:
    """The first camera's picture now, with its pose, the base's pose and the robot's state.

    Raises:
        Failure: SENSOR_DEAD, FRAME_UNKNOWN.
    """
    return snapshot.take(robot, skill.frames)
