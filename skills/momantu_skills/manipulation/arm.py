"""One arm during one run of a skill: its state, its surroundings, its motions."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from functools import partial

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import JointTrajectory, RobotState
from momantu_bt.robot import ARM, CameraSensor, Robot
from momantu_bt.service import HeldObject
from momantu_bt.skill import Skill
from momantu_skills.manipulation.config import HandConfig, PlanningConfig
from momantu_skills.manipulation.motion.following import CODE, STILL, Watch, follow
from momantu_skills.manipulation.motion.recoil import recoil, way_ahead, way_back
from momantu_skills.manipulation.motion.strain import Strain, slow
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.perception.camera.snapshot import take

with lazily():
    from momantu_skills.manipulation.model import collision
    from momantu_skills.manipulation.motion import planner, timing
    from momantu_skills.manipulation.scene import scene

SLOW = 2.0
"""A joint is slow if it needs more than this many scaled rad per rad or m (see Group.scale)."""
SETTLE_TICKS = 20
"""Most ticks to wait for a stop: 1 s, longer than any braking."""
LEAN_PENALTY = 2.0
"""Cost of tilting a held object, s per rad: turning it upside down on the way costs about as much
time."""
BLIND_PENALTY = 6.0
"""Cost of a grasp with the camera below the hand, s: held upright, the object hides the camera's
view down."""
AROUND = 0.08
"""How far from the centre between the pads the grasped object may extend, m beyond half the widest
opening."""

NO_WAY = ("NO_PLAN", "START_IN_COLLISION")
SWING = 0.4
"""How far the hand of an arm with few joints may turn about the vertical on a straight line, rad:
such an arm leaves its plane only with a turn."""


class Arm:
    """State and motions shared by the skills that move the arm. `service` is the planning scene."""

    def __init__(self, skill: Skill, robot: Robot, service: ArmScene) -> None:
        self.skill, self.robot, self.service = skill, robot, service
        self.scene: scene.Scene = service.scene
        self.planning, self.hand = PlanningConfig(), HandConfig()
        self.group = self.scene.model.group
        self.planner = planner.Planner(self.group, skill.random, self.planning)

    @property
    def state(self) -> RobotState:
        """The robot's current state."""
        return self.robot.state()

    @property
    def joints(self) -> Array:
        """The arm's current joint positions (n,), within their limits."""
        return self.scene.model.joints(self.robot.state())

    @property
    def force(self) -> float:
        """The gripper's closing force, N: the configured one, or its largest if that is less."""
        return min(self.hand.force, self.scene.model.description.hand.max_force)

    @property
    def open_width(self) -> float:
        """The widest opening of the gripper, m."""
        return self.scene.model.description.hand.max_width

    def observe(self) -> None:
        """Take a picture now and let the planning scene see the surroundings in it.

        A robot without a camera knows of its surroundings only what the site says.
        """
        if any(isinstance(s, CameraSensor) for s in self.robot.description.sensors.values()):
            self.service.observe(take(self.robot, self.skill.frames))

    def seeds(self, start: Array, count: int) -> Array:
        """Start postures (count, n) for inverse kinematics: the current one, then random ones.

        Every second one keeps slow joints at their current positions, as moving them takes long.
        """
        lower = np.where(self.group.endless, -np.pi, self.group.lower)
        upper = np.where(self.group.endless, np.pi, self.group.upper)
        seeds = self.skill.random.uniform(lower, upper, (count, len(start)))
        slow = self.group.scale > SLOW
        seeds[::2, slow] = start[slow]
        seeds[0] = start
        return np.asarray(seeds)

    def carry_penalty(self, grasp_from_object: Transform) -> float:
        """Extra cost of a grasp, s, if it tilts the object in the carrying pose."""
        pose = self.scene.model.description.named_poses["carry"]
        joints = np.array([pose.get(name, 0.0) for name in self.group.names])
        tip_from_object = self.scene.model.tip_from_grasp @ grasp_from_object
        return LEAN_PENALTY * _lean(self.group.tip_matrix(joints)[:3, :3], tip_from_object)

    def blind_penalty(self, object_from_grasp: Transform, odom_from_object: Transform) -> float:
        """Extra cost of a grasp, s, if it leaves a hand camera below the hand."""
        camera = self.scene.model.grasp_from_camera
        if camera is None:
            return 0.0
        offset = (object_from_grasp @ camera).position - object_from_grasp.position
        above = float(odom_from_object.rotation[2] @ offset)
        return BLIND_PENALTY if above < 0.0 else 0.0

    def posed(self, pose: Mapping[str, float]) -> Array:
        """Joints (n,) of a named pose, turned the short way; joints that it does not name stay."""
        now = self.joints
        names = zip(self.group.names, now, strict=True)
        goal = np.array([pose.get(name, position) for name, position in names])
        return self.group.nearest_turn(goal, now)

    def turned(self, path: Array, reference: Array) -> Array:
        """Shift endless joints of a path (k, n) or joints (n,) by full turns to `reference`."""
        first = path if path.ndim == 1 else path[0]
        return np.asarray(path + (self.group.nearest_turn(first, reference) - first))

    def route(
        self,
        goals: Sequence[Array],
        held: HeldObject | None,
        *,
        width: float | None = None,
        cut: scene.Cut | None = None,
        extra: tuple[collision.Obstacle, ...] = (),
    ) -> list[JointTrajectory]:
        """Plan trajectories, one after the other, from here to the first reachable of `goals`.

        Free motions keep the configured margin. A start that is nearer to obstacles is left first,
        by a short escape motion.

        width, cut, extra: see `Scene.world`. Where the way is only free if what the maps know is no
        taller than pictures show, the arm goes slowly.

        Raises:
            Failure: NO_PLAN or START_IN_COLLISION.
        """
        state, stages = self.state, self.stages
        for supposed in stages:
            judge = partial(self.scene.world, state, held, supposed=supposed)
            transit = partial(judge, width=width, cut=cut, extra=extra)
            bare = partial(judge, 0.0, held_on_support=True)
            try:
                return self._route(transit, bare, held, goals, careful=supposed != stages[0])
            except Failure as failure:
                if failure.code not in NO_WAY or supposed == stages[-1]:
                    raise
        raise AssertionError("the last stage returns or raises")

    @property
    def stages(self) -> tuple[float | None, ...]:
        """What is supposed of the maps, from the most to the least: see `Scene.world`.

        What cannot be done with more is tried with less. At the end only what is known counts.
        """
        return self.planning.supposed if self.scene.near_columns(self.state) else (None,)

    def _route(
        self,
        world: Callable[[float], collision.CollisionWorld],
        bare: Callable[[], collision.CollisionWorld],
        held: HeldObject | None,
        goals: Sequence[Array],
        careful: bool,
    ) -> list[JointTrajectory]:
        """The same in given worlds: with a clearance, m, and for leaving contacts."""
        start = self.joints
        first: list[JointTrajectory] = []
        enclosed: Failure | None = None
        for margin in self.planning.margins:
            transit, enclosed = world(margin), None
            if not transit.free(start) and not first:
                try:
                    path = self._escape(start, transit, bare())
                except Failure as failure:
                    enclosed = failure
                    continue
                first.append(self.trajectory(path, self.hand.approach_speed, careful=careful))
                start = path[-1]
            found = self._path(transit, held, start, goals)
            if found is not None:
                return [*first, *self._checked(found, world(margin / 2), careful)]
        raise enclosed or self._no_plan(transit, goals)

    def _path(
        self,
        world: collision.CollisionWorld,
        held: HeldObject | None,
        start: Array,
        goals: Sequence[Array],
    ) -> Array | None:
        """A path on which the held object stays upright, or any path if there is none."""
        if not world.free(start):
            return None
        found = self.planner.path(start, goals, self._upright(world, held, start, goals))
        if found is None and held is not None:
            found = self.planner.path(start, goals, world.free)
        return found

    def trajectory(
        self, path: Array, tip_speed: float | None = None, *, careful: bool = False
    ) -> JointTrajectory:
        """The fastest trajectory along a path; see `timed`. careful: something may stand there."""
        most = self.planning.careful_speed if careful else None
        return timing.timed(self.group, path, self.planning, tip_speed, joint_speed=most)

    def follow(
        self, trajectory: JointTrajectory, phase: str, until: Watch | None = None
    ) -> Generator[str, None, bool]:
        """See `motion.follow`. An arm that meets something goes back a little before it fails.

        What it met is an obstacle from now on, until a picture shows that nothing is there. Slow
        motions watch the motors too, unless a contact is meant (`until`).
        """
        feels = until is None and slow(trajectory)
        strain = Strain(self.scene.model.efforts) if feels else None
        clock = self.skill.clock
        try:
            return (yield from follow(self.robot, clock, ARM, trajectory, phase, until, strain))
        except Failure as failure:
            if failure.code != CODE:
                raise
            state, here = self.state, self.joints
            timed = partial(self.trajectory, careful=True)
            if (yield from recoil(self.robot, self.skill.clock, ARM, trajectory, timed)):
                passed = way_back(trajectory, here)
                self.scene.met(state, passed, way_ahead(trajectory, here))
            raise

    def settle(self) -> Generator[str, None, None]:
        """Wait until the arm stands still: its last motion may have been aborted."""
        last = self.joints
        for _ in range(SETTLE_TICKS):
            yield "settling"
            now = self.joints
            if float(np.abs(now - last).max()) < STILL:
                return
            last = now

    def reversed(self, trajectory: JointTrajectory, speed: float | None = None) -> JointTrajectory:
        """Return back along a trajectory, from the arm's current position to its start.

        speed: of the hand, m/s; the lifting speed if None.
        """
        back = trajectory.positions[::-1]
        nearest = int(np.argmin(np.abs(back - self.joints).max(axis=1)))
        path = np.vstack([self.joints, back[min(nearest + 1, len(back) - 1) :]])
        return self.trajectory(path, speed or self.hand.lift_speed)

    def line(self, start: Array, base_from_tip: Transform) -> Array | None:
        """Joints (k, n) on the straight line from `start` to a tip pose; None if not reachable."""
        targets = straight_line(
            self.group.tip_matrix(start), base_from_tip.matrix, self.hand.linear_step
        )
        if self.group.few:
            axis = self._upright_axis(start)
            path, reached = self.group.trace_upright(targets, start, axis, SWING)
        else:
            path, reached = self.group.trace(targets, start)
        return np.vstack([start, path]) if reached == len(targets) else None

    def _upright_axis(self, q: Array) -> Array:
        """tip_from_axis (4, 4): z is vertical at joints (n,), through where the hand grasps."""
        base_from_tip = Transform.from_matrix(self.group.tip_matrix(q))
        place = base_from_tip @ self.scene.model.tip_from_grasp
        return (base_from_tip.inverse() @ Transform(place.position)).matrix

    def back_off(self, distance: float) -> Generator[str, None, None]:
        """Retreat the hand along its fingers from its current position, where possible.

        The arm does not move where it would hit an obstacle; objects between the fingers are
        ignored. Raises Failure ARM_STUCK.
        """
        start = self.joints
        path = self.line(start, self.group.tip_pose(start) @ Transform((-distance, 0.0, 0.0)))
        if path is not None and self._way_out(path):
            yield from self.follow(self.trajectory(path, self.hand.lift_speed), "drawing back")

    def rise(self, distance: float) -> Generator[str, None, bool]:
        """Lift the hand straight up, where possible; whether it was.

        What is at the hand is ignored: it may be held. Raises Failure ARM_STUCK.
        """
        start = self.joints
        path = self.line(start, Transform((0.0, 0.0, distance)) @ self.group.tip_pose(start))
        if path is None or not self._way_out(path):
            return False
        yield from self.follow(self.trajectory(path, self.hand.approach_speed), "lifting")
        return True

    def _way_out(self, path: Array) -> bool:
        state, half = self.state, self.open_width / 2 + AROUND
        tip = self.group.tip_pose(self.joints) @ self.scene.model.tip_from_grasp
        cut = scene.Cut(state.odom_from_base @ tip, (half, half, half))
        world = self.scene.world(
            state, None, 0.0, width=self.open_width, cut=cut, supposed=self.stages[-1]
        )
        return world.path_free(path[1:])

    def lean(self, held: HeldObject, q: Array) -> float:
        """Tilt of the held object from upright at joints (n,), rad."""
        tip_from_object = self.scene.model.tip_from_grasp @ held.grasp_from_object
        return _lean(self.group.tip_matrix(q)[:3, :3], tip_from_object)

    def _upright(
        self,
        world: collision.CollisionWorld,
        held: HeldObject | None,
        start: Array,
        goals: Sequence[Array],
    ) -> planner.Valid:
        """Test: no collision, and a tilt of at most the configured one, or start's and goals'."""
        if held is None:
            return world.free
        ends = [self.lean(held, q) for q in (start, *goals)]
        least = math.cos(min(math.pi, max(self.planning.tilt, max(ends) + 0.1)))
        axis = (self.scene.model.tip_from_grasp @ held.grasp_from_object).rotation[:, 2]

        def valid(q: Array) -> bool:
            upward = float(self.group.tip_matrix(q)[2, :3] @ axis)
            return upward >= least and world.free(q)

        return valid

    def _escape(
        self, start: Array, world: collision.CollisionWorld, bare: collision.CollisionWorld
    ) -> Array:
        path = planner.escape(self.group, start, world, bare, self.skill.random)
        if path is None:
            pairs = ", ".join(f"{a} with {b}" for a, b in bare.touching(start)[:3])
            raise Failure(
                "START_IN_COLLISION",
                f"the arm stands where it touches something ({pairs or 'within the margin'}), and "
                "no small motion gets it out",
                touching=pairs,
            )
        return path

    def _checked(
        self, path: Array, world: collision.CollisionWorld, careful: bool
    ) -> list[JointTrajectory]:
        """One trajectory that rounds corners where possible, or one per straight segment."""
        if len(path) == 2:
            return [self.trajectory(path, careful=careful)]
        most = self.planning.careful_speed if careful else None
        for radius in self.planning.rounding:
            whole = timing.timed(self.group, path, self.planning, rounding=radius, joint_speed=most)
            if world.path_free(whole.positions):
                return [whole]
        return [self.trajectory(path[i : i + 2], careful=careful) for i in range(len(path) - 1)]

    def _no_plan(self, world: collision.CollisionWorld, goals: Sequence[Array]) -> Failure:
        touching = [world.touching(goal) for goal in goals]
        if all(touching):
            a, b = touching[0][0]
            text = f"every goal posture collides, the first one {a} with {b}"
        else:
            text = f"no way found to any of {len(goals)} goal postures"
        return Failure("NO_PLAN", text, goals=len(goals), checks=world.checks)


def _lean(base_from_tip: Array, tip_from_object: Transform) -> float:
    """Angle between the object's z axis and the vertical, for the tip's rotation (3, 3), rad."""
    upward = float(base_from_tip[2] @ tip_from_object.rotation[:, 2])
    return math.acos(max(-1.0, min(1.0, upward)))


def straight_line(start: Array, end: Array, step: float) -> Array:
    """Poses (k, 4, 4) from `start` (left out) to `end`, at most `step` m or 0.05 rad apart."""
    first, last = Transform.from_matrix(start), Transform.from_matrix(end)
    length = float(np.linalg.norm(last.position - first.position))
    count = max(1, math.ceil(length / step), math.ceil(first.angle_to(last) / 0.05))
    return np.array([_between(first, last, i / count).matrix for i in range(1, count + 1)])


def _between(first: Transform, last: Transform, share: float) -> Transform:
    """Linear in position; rotation by normalised blending, close to the shortest arc."""
    sign = math.copysign(1.0, float(first.quaternion @ last.quaternion))
    return Transform(
        first.position + share * (last.position - first.position),
        first.quaternion + share * (sign * last.quaternion - first.quaternion),
    )
