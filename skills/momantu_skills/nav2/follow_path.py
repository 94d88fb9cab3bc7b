"""FollowPath: drive along a path that the tree may replace while the base drives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.claim import BaseAt, Claim
from momantu_bt.failure import FailureValue
from momantu_bt.geometry import Path, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.messages import TrackingFeedback
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Out, Run
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import Nav2Action, known_name
from momantu_skills.navigation.drive.track import Track
from momantu_skills.navigation.drive.vehicle import Vehicle

with lazily():
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import follow, trip

CONTROLLERS = ("FollowPath", "mppi")
"""Names of the one controller: Nav2's usual name, and its own."""
TOLERANCES = {
    "general_goal_checker": (0.25, 0.25),
    "goal_checker": (0.25, 0.25),
    "SimpleGoalChecker": (0.25, 0.25),
    "precise_goal_checker": (0.05, 0.05),
}
"""Largest distance, m, and heading error, rad, at the end of the path, by goal checker."""
PROGRESS_CHECKERS = ("progress_checker", "SimpleProgressChecker")
PATH_HANDLERS = ("PathHandler", "FeasiblePathHandler")
SURVEY = (0.05, 0.03)
"""Accuracy of the map in m and rad, as for `navigate`."""

_CODES = {
    "NO_PROGRESS": "FAILED_TO_MAKE_PROGRESS",
    "NO_WAY": "PATIENCE_EXCEEDED",
    "BLOCKED": "NO_VALID_CONTROL",
    "PATH_BLOCKED": "NO_VALID_CONTROL",
    "NOT_LOCALIZED": "TF_ERROR",
}
"""Nav2's names for the failures of our driving."""


class FollowPath(Nav2Action):
    """Drive along a path to its end; a new path is taken over while the base drives."""

    path: Path = In((), may_be_empty=True, live=True, doc="the path: poses of the map")
    controller_id: str = In(
        "", may_be_empty=True, doc="the controller: FollowPath or mppi, the same"
    )
    goal_checker_id: str = In(
        "",
        may_be_empty=True,
        doc="general_goal_checker: within 0.25 m, 0.25 rad; precise_goal_checker: 0.05",
    )
    progress_checker_id: str = In("", may_be_empty=True, doc="progress_checker")
    path_handler_id: str = In("", may_be_empty=True, doc="PathHandler")
    tracking_feedback: TrackingFeedback = Out(doc="how the base follows the path", live=True)

    failures: ClassVar = {
        "INVALID_CONTROLLER": "there is no controller, or no checker, of this name",
        "TF_ERROR": "the robot is not sure enough where it is",
        "INVALID_PATH": "the path has no poses, or leaves the map",
        "PATIENCE_EXCEEDED": "no way led on along the path for too long",
        "FAILED_TO_MAKE_PROGRESS": "the base has hardly moved for too long",
        "NO_VALID_CONTROL": "the laser kept the base from moving for too long",
    }
    numbers: ClassVar = {
        "UNKNOWN": 100,
        "INVALID_CONTROLLER": 101,
        "TF_ERROR": 102,
        "INVALID_PATH": 103,
        "PATIENCE_EXCEEDED": 104,
        "FAILED_TO_MAKE_PROGRESS": 105,
        "NO_VALID_CONTROL": 106,
    }
    uses: ClassVar = {"base"}
    activities: ClassVar = {Activity.DRIVE: "+2 s"}
    symptoms: ClassVar = {
        "TF_ERROR": {Symptom.NOT_LOCALIZED},
        "PATIENCE_EXCEEDED": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED},
        "FAILED_TO_MAKE_PROGRESS": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED, Symptom.SLOW},
        "NO_VALID_CONTROL": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED},
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short path ahead of the robot."""
        path = tuple(Pose2D(0.1 * k, 0.0, 0.0) for k in range(9))
        return {"inputs": {"path": path}}

    def act(self, robot: Robot) -> Run:
        """Follow the path, until a tree cancels it."""
        tolerance = self._tolerance()
        vehicle = self.vehicle(robot)
        self._check_path(vehicle)
        self._told(vehicle)(Track(self.path, vehicle.pose()), vehicle.pose())
        cancels = self.nav2.cancels("FollowPath")
        driving = self._drive(vehicle, robot, tolerance)
        answer: Any = None
        while True:
            try:
                said = driving.send(answer)
            except StopIteration:
                return
            except Failure as failure:
                code = _CODES.get(failure.value.code, failure.value.code)
                raise Failure(code, failure.value.message, **failure.value.data) from None
            answer = yield said
            self._check_path(vehicle)
            if self.nav2.cancels("FollowPath") != cancels:
                driving.close()
                yield from vehicle.stop("cancelled")
                return

    def _drive(self, vehicle: Vehicle, robot: Robot, tolerance: tuple[float, float]) -> Run:
        yield from trip.be_sure(vehicle)
        vehicle.sense()
        controller = mppi.Mppi(robot.description.base, self.nav2.config, self.random)
        follower = follow.Follower(
            vehicle, controller, lambda: self.path, tolerance, self._told(vehicle)
        )
        yield from follower.follow()

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the base stands at the path's end."""
        if failure is not None or not self.path or self.nav2.cancels("FollowPath"):
            return None
        distance, angle = self._tolerance()
        return BaseAt(self.path[-1], distance + SURVEY[0], angle + SURVEY[1])

    def _tolerance(self) -> tuple[float, float]:
        code = "INVALID_CONTROLLER"
        known_name(self.controller_id, CONTROLLERS, "controller", code)
        known_name(self.goal_checker_id, tuple(TOLERANCES), "goal checker", code)
        known_name(self.progress_checker_id, PROGRESS_CHECKERS, "progress checker", code)
        known_name(self.path_handler_id, PATH_HANDLERS, "path handler", code)
        return TOLERANCES[self.goal_checker_id or "general_goal_checker"]

    def _check_path(self, vehicle: Vehicle) -> None:
        if not self.path:
            raise Failure("INVALID_PATH", "the path has no poses")
        end = self.path[-1]
        if not vehicle.costmap.grid.contains(end.x, end.y):
            raise Failure(
                "INVALID_PATH", f"the path ends at ({end.x:.2f}, {end.y:.2f}), off the map"
            )

    def _told(self, vehicle: Vehicle) -> Any:
        def report(track: Track, pose: Pose2D) -> None:
            left, right = track.errors(pose)
            self.tracking_feedback = TrackingFeedback(
                position_tracking_error=left,
                heading_tracking_error=right,
                current_path_index=track.at,
                robot_pose=pose,
                distance_to_goal=pose.distance_to(track.end),
                speed=vehicle.speed()[0],
                remaining_path_length=track.to_go,
            )

        return report
