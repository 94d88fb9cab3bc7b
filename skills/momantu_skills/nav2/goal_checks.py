"""GoalReached, ArePosesNear, GetCurrentPose, RemovePassedGoals: goals, and where the robot is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from momantu_bt.claim import BaseNear, Claim
from momantu_bt.failure import FailureValue
from momantu_bt.frames import MAP
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import WaypointStatus
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.goals import Goal, pose_at

REACHED = 0.25
"""Nav2's default distance at which a goal counts as reached, m."""
COMPLETED = 1
"""Nav2's status of a goal that was passed."""
_BASE = "Nav2's; it is always the robot's base here"
_FRAME = "Nav2's; poses here are in the map"


class GoalReached(Skill):
    """Succeed when the robot is within 0.25 m of a goal."""

    goal: Goal = In(names="spot", doc="a pose of the map, or a place")
    robot_base_frame: str | None = In(None, ignored=True, doc=_BASE)

    failures: ClassVar = {
        "NOT_REACHED": "the robot is farther away",
        "BAD_GOAL": "the goal is neither a pose nor a place",
    }
    symptoms: ClassVar = {"NOT_REACHED": {Symptom.NOT_LOCALIZED}}
    localization: Localization = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A goal where the robot starts."""
        return {"inputs": {"goal": Pose2D(0.1, 0.0, 0.0)}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        goal = pose_at(self.goal, self.site, robot.description.working)
        away = self.localization.map_from_base.distance_to(goal)
        if away > REACHED:
            raise Failure("NOT_REACHED", f"the goal is {away:.2f} m away", distance=away)
        return
        yield ""

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the base is near the goal."""
        if failure is not None:
            return None
        goal = pose_at(self.goal, self.site, robot.description.working)
        return BaseNear((goal.x, goal.y), REACHED + 0.1)


class ArePosesNear(Skill):
    """Succeed when two poses are near each other, without regard to their headings."""

    ref_pose: Goal = In(names="spot", doc="a pose of the map, or a place")
    target_pose: Goal = In(names="spot", doc="the other pose")
    tolerance: float = In(0.5, unit="m", least=0, doc="what counts as near")
    global_frame: str | None = In(None, ignored=True, doc=_FRAME)

    failures: ClassVar = {
        "NOT_NEAR": "the poses are farther apart",
        "BAD_GOAL": "one of them is neither a pose nor a place",
    }
    symptoms: ClassVar = {}

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Two poses that are near each other."""
        return {"inputs": {"ref_pose": Pose2D(0.5, 0.0), "target_pose": Pose2D(0.6, 0.0)}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        working = robot.description.working
        one, other = (
            pose_at(pose, self.site, working) for pose in (self.ref_pose, self.target_pose)
        )
        away = one.distance_to(other)
        if away > self.tolerance:
            raise Failure("NOT_NEAR", f"the poses are {away:.2f} m apart", distance=away)
        return
        yield ""


class GetCurrentPose(Skill):
    """Write where the robot believes to be."""

    robot_base_frame: str | None = In(None, ignored=True, doc=_BASE)
    global_frame: str = In(MAP, doc=_FRAME)
    current_pose: Pose2D = Out(doc="the robot's pose in the map")

    failures: ClassVar = {"WRONG_FRAME": "the frame is not the map"}
    symptoms: ClassVar = {}
    localization: Localization = Needs()

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        if self.global_frame != MAP:
            raise Failure("WRONG_FRAME", f"{self.global_frame!r} is not {MAP}")
        self.current_pose = self.localization.map_from_base
        return
        yield ""


class RemovePassedGoals(Skill):
    """Drop the first goals of a list while the robot is near them; the last one always stays."""

    radius: float = In(0.5, unit="m", least=0, doc="what counts as near")
    robot_base_frame: str | None = In(None, ignored=True, doc=_BASE)
    input_goals: tuple[Goal, ...] = In(
        (), names="spot", may_be_empty=True, doc="poses of the map, or places"
    )
    input_waypoint_statuses: tuple[WaypointStatus, ...] | None = In(
        None, may_be_empty=True, doc="the statuses so far; made from the goals if there are none"
    )
    output_goals: tuple[Goal, ...] = Out(doc="the goals that are left")
    output_waypoint_statuses: tuple[WaypointStatus, ...] = Out(doc="with passed goals marked")

    failures: ClassVar = {
        "BAD_GOAL": "a goal is neither a pose nor a place",
        "NO_STATUS": "a goal that was passed has no status",
    }
    symptoms: ClassVar = {}
    localization: Localization = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A goal at the robot, and one farther on."""
        return {"inputs": {"input_goals": (Pose2D(0.0, 0.0), Pose2D(3.0, 0.0))}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        goals = list(self.input_goals)
        statuses = list(self.input_waypoint_statuses or _pending(self.input_goals))
        here = self.localization.map_from_base
        while len(goals) > 1:
            goal = pose_at(goals[0], self.site, robot.description.working)
            if here.distance_to(goal) > self.radius:
                break
            _complete(statuses, goals.pop(0))
        self.output_goals = tuple(goals)
        self.output_waypoint_statuses = tuple(statuses)
        return
        yield ""


def _pending(goals: tuple[Goal, ...]) -> list[WaypointStatus]:
    return [WaypointStatus(0, index, goal) for index, goal in enumerate(goals)]


def _complete(statuses: list[WaypointStatus], goal: Goal) -> None:
    for index, status in enumerate(statuses):
        if status.waypoint_status == 0 and status.waypoint_pose == goal:
            statuses[index] = replace(status, waypoint_status=COMPLETED)
            return
    raise Failure("NO_STATUS", f"no waypoint status belongs to the goal {goal}")
