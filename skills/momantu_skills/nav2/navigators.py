"""NavigateToPose, NavigateThroughPoses: whole trips, with the recoveries of `navigate`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.claim import BaseAt, Claim
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Run
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import Nav2Action
from momantu_skills.nav2.goals import Goal, require_on_map, stands_at

with lazily():
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import trip

TOLERANCE = (0.25, 0.25)
"""Nav2's default distance, m, and heading error, rad, at a goal."""
SURVEY = (0.05, 0.03)
"""Accuracy of the map in m and rad, as for `navigate`."""
_TREE = "not here: write a <SubTree> instead"
_WAY = {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED, Symptom.SLOW}
_BLOCKED = (
    "START_KEPT_OUT",
    "GOAL_KEPT_OUT",
    "GOAL_BLOCKED",
    "NO_PATH",
    "PATH_BLOCKED",
    "NO_PROGRESS",
)


class _Navigator(Nav2Action):
    """Drives to goals with all that our navigation can do; it fails when that is used up."""

    failures: ClassVar = {
        "BAD_GOAL": "a goal is neither a pose nor a place, or there is none",
        "FAILED_TO_LOAD_BEHAVIOR_TREE": "`behavior_tree` names a tree; there is no navigator",
        "TF_ERROR": "the robot is not sure enough where it is",
        "UNREACHABLE": "the base cannot get there, after all recoveries",
    }
    uses: ClassVar = {"base"}
    activities: ClassVar = {Activity.DRIVE: "+2 s"}
    symptoms: ClassVar = {"TF_ERROR": {Symptom.NOT_LOCALIZED}, "UNREACHABLE": _WAY}

    behavior_tree: str = In("", doc=_TREE)

    def __init__(self) -> None:
        """Start without a goal."""
        super().__init__()
        self._at: Pose2D | None = None

    def travel(self, robot: Robot, goals: tuple[Goal, ...]) -> Run:
        """Drive to each goal in turn, and stop there."""
        if self.behavior_tree:
            raise Failure(
                "FAILED_TO_LOAD_BEHAVIOR_TREE",
                f"behavior_tree is {self.behavior_tree!r}; write a <SubTree> in its place",
            )
        if not goals:
            raise Failure("BAD_GOAL", "the list of goals is empty")
        working = robot.description.working
        places = [stands_at(goal, self.site, working) for goal in goals]
        vehicle = self.vehicle(robot)
        for stands in places:
            require_on_map(stands[0].pose, vehicle.costmap, "goal", "BAD_GOAL")
        controller = mppi.Mppi(robot.description.base, self.nav2.config, self.random)
        for stands in places:
            destination = trip.Destination(partial(list, stands), TOLERANCE)
            try:
                yield from trip.travel(vehicle, controller, destination, recovery=True)
            except Failure as failure:
                code = "UNREACHABLE" if failure.value.code in _BLOCKED else failure.value.code
                code = "TF_ERROR" if code == "NOT_LOCALIZED" else code
                raise Failure(code, failure.value.message, **failure.value.data) from None
            self._at = destination.chosen

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the base stands at the last goal."""
        if failure is not None or self._at is None:
            return None
        return BaseAt(self._at, TOLERANCE[0] + SURVEY[0], TOLERANCE[1] + SURVEY[1])


class NavigateToPose(_Navigator):
    """Drive to a goal, with recoveries."""

    goal: Goal = In(names="goal", doc="a pose of the map, or a place")

    numbers: ClassVar = {
        "UNKNOWN": 9000,
        "FAILED_TO_LOAD_BEHAVIOR_TREE": 9001,
        "TF_ERROR": 9002,
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A goal ahead of the robot."""
        return {"inputs": {"goal": Pose2D(0.8, 0.0, 0.0)}}

    def act(self, robot: Robot) -> Run:
        """Travel there."""
        yield from self.travel(robot, (self.goal,))


class NavigateThroughPoses(_Navigator):
    """Drive to several goals in turn, with recoveries; unlike Nav2's, the robot stops at each."""

    goals: tuple[Goal, ...] = In(names="goal", doc="poses of the map, or places")

    numbers: ClassVar = {
        "UNKNOWN": 9100,
        "FAILED_TO_LOAD_BEHAVIOR_TREE": 9101,
        "TF_ERROR": 9102,
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Two goals ahead of the robot."""
        return {"inputs": {"goals": (Pose2D(0.5, 0.0, 0.0), Pose2D(0.9, 0.0, 0.0))}}

    def act(self, robot: Robot) -> Run:
        """Travel through all of them."""
        yield from self.travel(robot, self.goals)
