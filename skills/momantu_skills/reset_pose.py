"""reset_pose: bring arm and camera into one of the robot's named poses."""

from __future__ import annotations

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, JointsAt
from momantu_bt.failure import Failure, FailureValue
from momantu_bt.formats.names import nearest
from momantu_bt.lazy import lazily
from momantu_bt.messages import JointPositions
from momantu_bt.robot import ARM, CAMERA_CARRIER, Robot
from momantu_bt.skill import In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.arm import Arm
from momantu_skills.manipulation.scene.arm_scene import ArmScene

with lazily():
    from momantu_skills.gaze import unseen_ways


THINKING = 0.2
"""Time allowed for planning, s: several times its median."""
CLOSE = 0.01
"""Distance from the pose within which the arm need not move, rad or m."""
REACHED = 0.03
"""Distance from the pose at which it counts as reached, rad or m: trajectories end within 0.02, and
encoders have an error."""


class ResetPose(Skill):
    """Move the arm to a named pose around obstacles. A held object stays in the hand.

    The camera looks first at parts of the way that no picture has shown.
    A pose that names only some joints moves only those. Fails with UNKNOWN_POSE, NO_PLAN,
    START_IN_COLLISION or ARM_STUCK.
    """

    pose: str = In(doc="one of the robot's named poses", names="named_pose")
    also_called = ("move_arm", "go_home", "fold_arm", "tuck_arm", "move_to_pose")
    failures = {
        "UNKNOWN_POSE": "the robot has no pose of that name",
        "NO_PLAN": "no collision-free way to the pose was found, or the pose itself collides",
        "START_IN_COLLISION": "the arm touches something and no small motion frees it",
        "ARM_STUCK": "the arm does not follow its trajectory",
    }
    uses = {ARM, CAMERA_CARRIER}
    activities = {Activity.MOVE_ARM: ""}
    symptoms = {
        "NO_PLAN": {Symptom.ARM_OFF_COURSE, Symptom.ARM_WAY_BLOCKED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }
    planning_scene: ArmScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Look, plan, move; turn the camera at the same time."""
        wanted = self._wanted(robot)
        arm = Arm(self, robot, self.planning_scene)
        yield from arm.settle()
        goal = arm.posed(wanted)
        if abs(goal - arm.joints).max() > CLOSE:
            arm.observe()
            for trajectory in (yield from unseen_ways.routed_in_sight(arm, goal, THINKING)):
                for phase in arm.follow(trajectory, "moving"):
                    self._turn_camera(robot, wanted)
                    yield phase
        yield from self._finish_camera(robot, wanted)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the joints of arm and camera are at the pose; a failure denies it."""
        wanted = robot.description.named_poses.get(self.pose)
        if wanted is None or (failure is not None and failure.code not in self.failures):
            return None
        carriers = dict.fromkeys((ARM, robot.description.resolve_use(CAMERA_CARRIER)))
        actuators = [robot.description.actuators[name] for name in carriers if name is not None]
        names = tuple(j for actuator in actuators for j in actuator.joints if j in wanted)
        return JointsAt(names, tuple(wanted[name] for name in names), REACHED)

    def _wanted(self, robot: Robot) -> dict[str, float]:
        poses = robot.description.named_poses
        if self.pose not in poses:
            near = nearest(self.pose, poses)
            hint = f"; did you mean {near!r}" if near else ""
            raise Failure(
                "UNKNOWN_POSE",
                f"{robot.description.name} has no pose {self.pose!r}{hint}; "
                f"its poses: {', '.join(poses)}",
                known=list(poses),
            )
        return poses[self.pose]

    def _head(self, robot: Robot) -> str | None:
        """Return the actuator of the camera; None if the arm carries it or it is fixed."""
        carrier = robot.description.resolve_use(CAMERA_CARRIER)
        return None if carrier == ARM else carrier

    def _camera_goal(self, robot: Robot, wanted: dict[str, float]) -> JointPositions | None:
        """Return the pose's positions of the camera's joints, if they are not joints of the arm."""
        carrier = self._head(robot)
        if carrier is None:
            return None
        names = tuple(j for j in robot.description.actuators[carrier].joints if j in wanted)
        return JointPositions(names, tuple(wanted[n] for n in names)) if names else None

    def _turn_camera(self, robot: Robot, wanted: dict[str, float]) -> None:
        goal, head = self._camera_goal(robot, wanted), self._head(robot)
        if goal is not None and head is not None:
            robot.command(head, goal)

    def _finish_camera(self, robot: Robot, wanted: dict[str, float]) -> Run:
        """Wait for the camera to arrive, at most as long as its slowest joint may need."""
        goal = self._camera_goal(robot, wanted)
        if goal is None:
            return
        limits = robot.description.joint_limits
        state = robot.state()
        travel = max(
            abs(state.position(n) - p) / limits[n].velocity + 1.0
            for n, p in zip(goal.names, goal.positions, strict=True)
        )
        deadline = self.clock.now() + travel
        while self.clock.now() < deadline and self._camera_off(robot, goal):
            self._turn_camera(robot, wanted)
            yield "turning the camera"

    def _camera_off(self, robot: Robot, goal: JointPositions) -> bool:
        state = robot.state()
        pairs = zip(goal.names, goal.positions, strict=True)
        return any(abs(state.position(name) - p) > 2 * CLOSE for name, p in pairs)
