"""ComputePathToPose, ComputePathThroughPoses: plan paths with Nav2's shared costmap."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import Any, ClassVar

from momantu_bt.geometry import Path, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot, Working
from momantu_bt.skill import Compute, Failure, In, Out, Run, compute
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import Nav2Action, known_name
from momantu_skills.nav2.goals import Goal, require_on_map, stands_at
from momantu_skills.navigation.drive.vehicle import Vehicle

with lazily():
    from momantu_skills.navigation.drive import ways

PLANNERS = ("GridBased", "fast_marching")
"""Names of the one planner: Nav2's usual name, and its own."""
_PLANNER = "the planner's name: GridBased or fast_marching, which are the same"


def _numbers(first: int) -> dict[str, int]:
    return {
        "UNKNOWN": first,
        "INVALID_PLANNER": first + 1,
        "START_OUTSIDE_MAP": first + 3,
        "GOAL_OUTSIDE_MAP": first + 4,
        "BAD_GOAL": first + 4,
        "START_OCCUPIED": first + 5,
        "GOAL_OCCUPIED": first + 6,
        "NO_VALID_PATH": first + 8,
    }


FAILURES = {
    "BAD_GOAL": "the goal is neither a pose nor a place",
    "INVALID_PLANNER": "there is no planner of this name",
    "START_OUTSIDE_MAP": "the start is not on the map",
    "GOAL_OUTSIDE_MAP": "a goal is not on the map",
    "START_OCCUPIED": "something stands where the path would begin",
    "GOAL_OCCUPIED": "something stands where the base would stand",
    "NO_VALID_PATH": "no way that is wide enough leads to the goal",
}
_BLOCKED = {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED}
_SYMPTOMS = {
    "START_OCCUPIED": _BLOCKED,
    "GOAL_OCCUPIED": _BLOCKED,
    "NO_VALID_PATH": _BLOCKED,
    "START_OUTSIDE_MAP": {Symptom.NOT_LOCALIZED},
}
_CODES = {"GOAL_BLOCKED": "GOAL_OCCUPIED", "GOAL_KEPT_OUT": "GOAL_OCCUPIED"}
"""Nav2's codes for those of our planning."""


class _Planning(Nav2Action):
    """Plans the shortest path that keeps clear of what the map and the sensors show."""

    failures: ClassVar = FAILURES
    symptoms: ClassVar = _SYMPTOMS

    planner_id: str = In("", may_be_empty=True, doc=_PLANNER)
    start: Goal | None = In(None, names="spot", doc="where the path begins; the robot's pose")
    path: Path = Out(doc="the path: poses of the map")

    def plan(
        self, robot: Robot, goals: Sequence[Goal], *, start: Goal | None
    ) -> Generator[Compute, Any, Path]:
        """Return the path from `start` through all goals; the last one is where the base stops."""
        known_name(self.planner_id, PLANNERS, "planner", "INVALID_PLANNER")
        vehicle, working = self.vehicle(robot), robot.description.working
        vehicle.sense()
        begin = vehicle.pose() if start is None else self._one(start, working)
        require_on_map(begin, vehicle.costmap, "start", "START_OUTSIDE_MAP")
        stops = [stands_at(goal, self.site, working) for goal in goals]
        for stands in stops:
            require_on_map(stands[0].pose, vehicle.costmap, "goal", "GOAL_OUTSIDE_MAP")
        return (
            yield from compute(
                lambda: self._through(vehicle, begin, stops), vehicle.config.planning_time
            )
        )

    def _one(self, goal: Goal, working: Working) -> Pose2D:
        return stands_at(goal, self.site, working)[0].pose

    def _through(self, vehicle: Vehicle, start: Pose2D, stops: Sequence[Any]) -> Path:
        vehicle.costmap.refresh()
        try:
            return ways.through(vehicle, start, stops)
        except Failure as failure:
            code = _CODES.get(failure.value.code, "NO_VALID_PATH")
            if code == "NO_VALID_PATH" and ways.occupied(vehicle, start):
                code = "START_OCCUPIED"
            raise Failure(code, failure.value.message, **failure.value.data) from None


class ComputePathToPose(_Planning):
    """Plan a path to a goal, around all that the map and the sensors show."""

    goal: Goal = In(names="goal", doc="a pose of the map, or a place")
    use_start: bool | None = In(None, doc="false: ignore `start`")
    viapoints: tuple[Goal, ...] | None = In(
        None, may_be_empty=True, doc="poses that the path passes on its way"
    )

    numbers: ClassVar = _numbers(200)

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A goal a little ahead of the robot."""
        return {"inputs": {"goal": Pose2D(0.5, 0.0, 0.0)}}

    def act(self, robot: Robot) -> Run:
        """Look, then plan."""
        start = None if self.use_start is False else self.start
        goals = (*(self.viapoints or ()), self.goal)
        self.path = yield from self.plan(robot, goals, start=start)


class ComputePathThroughPoses(_Planning):
    """Plan one path through several goals, in their order."""

    failures: ClassVar = {**FAILURES, "NO_VIAPOINTS_GIVEN": "there are no goals"}

    goals: tuple[Goal, ...] = In(names="goal", doc="poses of the map, or places")
    last_reached_index: int = Out(doc="-1: the path reaches all goals")

    numbers: ClassVar = {**_numbers(300), "NO_VIAPOINTS_GIVEN": 309}

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Two goals a little ahead of the robot."""
        return {"inputs": {"goals": (Pose2D(0.3, 0.0, 0.0), Pose2D(0.6, 0.0, 0.0))}}

    def act(self, robot: Robot) -> Run:
        """Look, then plan all parts of the path."""
        if not self.goals:
            raise Failure("NO_VIAPOINTS_GIVEN", "the list of goals is empty")
        self.path = yield from self.plan(robot, self.goals, start=self.start)
        self.last_reached_index = -1
