"""ValidatePath, IsPathValid, CheckPoseOccupancy, RemoveInCollisionGoals: ask the costmap."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import numpy as np

from momantu_bt.geometry import Array, Path, Pose2D, nearest_index, path_lengths
from momantu_bt.lazy import lazily
from momantu_bt.messages import WaypointStatus
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Out, Run
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import OnCostmap
from momantu_skills.nav2.goals import Goal, pose_at
from momantu_skills.navigation.drive.vehicle import Vehicle

with lazily():
    from momantu_skills.manipulation.model import hulls
    from momantu_skills.navigation.control import footprint
    from momantu_skills.navigation.drive import ways

LETHAL = 254
"""Nav2's cost of an obstacle."""
_COST = "Nav2's largest cost; what the base would touch is in collision here, whatever the number"


class _Asking(OnCostmap):
    """Looks, then asks the costmap that Nav2's leaves share."""

    service_name: str | None = In(None, ignored=True, doc="Nav2's service")
    server_timeout: int | None = In(None, ignored=True, doc="ms that Nav2 waits for the service")
    consider_unknown_as_obstacle: bool = In(
        False, ignored=True, doc="cells that the map does not know are obstacles here in any case"
    )

    def look(self, robot: Robot) -> Vehicle:
        """The base, with the costmap brought up to date."""
        vehicle = self.vehicle(robot)
        vehicle.sense()
        vehicle.costmap.refresh()
        return vehicle


class _CheckingPath(_Asking):
    """Checks whether the base could drive along a path."""

    failures: ClassVar = {
        "PATH_INVALID": "something stands on the path, or the path has no poses",
        "BAD_FOOTPRINT": "the footprint is not a list of corners",
    }
    symptoms: ClassVar = {"PATH_INVALID": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED}}

    path: Path = In((), may_be_empty=True, doc="the path: poses of the map")
    max_cost: int = In(LETHAL, ignored=True, doc=_COST)
    layer_name: str = In("", ignored=True, doc="Nav2's layer; all layers count here")
    footprint: str = In("", doc="other corners [[x, y], …] in the base frame, m")
    stop_at_first_collision: bool = In(True, doc="false: find all poses in collision")
    max_lookahead_distance: float = In(
        -1.0, unit="m", doc="how far ahead of the robot; below 0: the whole path"
    )

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A short path ahead of the robot."""
        return {"inputs": {"path": tuple(Pose2D(0.1 * k, 0.0, 0.0) for k in range(5))}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        hit = self.collisions(robot)
        self.found(hit)
        if hit:
            raise Failure(
                "PATH_INVALID",
                f"something stands on the path at ({hit[0].x:.2f}, {hit[0].y:.2f})",
                poses=[[pose.x, pose.y, pose.yaw] for pose in hit],
            )
        return
        yield ""

    def found(self, hit: Path) -> None:
        """Report the poses in collision."""

    def collisions(self, robot: Robot) -> Path:
        """The poses of the path at which the base would touch something.

        Raises:
            Failure: PATH_INVALID: there is no path. BAD_FOOTPRINT.
        """
        self.found(())
        if not self.path:
            raise Failure("PATH_INVALID", "the path has no poses")
        outline = _corners(self.footprint)
        vehicle = self.look(robot)
        touches = _touching(vehicle, outline)
        hit: list[Pose2D] = []
        for pose in self._ahead(vehicle.pose()):
            if touches(pose):
                hit.append(pose)
                if self.stop_at_first_collision:
                    break
        return tuple(hit)

    def _ahead(self, here: Pose2D) -> Path:
        if self.max_lookahead_distance < 0.0:
            return self.path
        along = path_lengths(self.path)
        first = nearest_index(self.path, here)
        last = along[first] + self.max_lookahead_distance
        return tuple(
            pose for pose, at in zip(self.path, along, strict=True) if along[first] <= at <= last
        )


def _touching(vehicle: Vehicle, outline: Array | None) -> Callable[[Pose2D], bool]:
    """Whether the base touches something at a pose: as for the planner, or with other corners."""
    if outline is None:
        return lambda pose: (
            not vehicle.costmap.grid.contains(pose.x, pose.y) or ways.occupied(vehicle, pose)
        )
    shape = footprint.discs(outline)
    return lambda pose: vehicle.costmap.room(pose, shape) < 0.0


def _corners(text: str) -> Array | None:
    if not text:
        return None
    try:
        corners = np.array(json.loads(text), dtype=np.float64)
    except (ValueError, TypeError):
        corners = np.zeros(0)
    if corners.ndim != 2 or corners.shape[0] < 3 or corners.shape[1] != 2:
        raise Failure("BAD_FOOTPRINT", f"{text!r} is not a list of corners [[x, y], …] in m")
    return hulls.floor_outline(corners)


class ValidatePath(_CheckingPath):
    """Succeed when the base could drive along a path: nothing that is known stands on it."""

    collision_poses: Path = Out(doc="poses of the path in collision", live=True)

    def found(self, hit: Path) -> None:
        """Report the poses in collision."""
        self.collision_poses = hit


class IsPathValid(_CheckingPath):
    """Succeed when the base could drive along a path; the name that ValidatePath had before."""


class _AtPoses(_Asking):
    """Asks whether the base could stand at poses."""

    failures: ClassVar = {
        "BAD_GOAL": "it is neither a pose nor a place",
        "POSE_OCCUPIED": "something stands there, or it is off the map",
    }
    symptoms: ClassVar = {"POSE_OCCUPIED": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED}}

    cost_threshold: int | float = In(float(LETHAL), ignored=True, doc=_COST)
    use_footprint: bool = In(True, doc="false: only a point must be free")

    def free(self, vehicle: Vehicle, pose: Pose2D) -> bool:
        """Whether the base, or a point, is free at a pose."""
        costmap = vehicle.costmap
        if not costmap.grid.contains(pose.x, pose.y):
            return False
        if self.use_footprint:
            return costmap.room(pose, vehicle.base_discs) >= 0.0
        row, column = costmap.grid.index(pose.x, pose.y)
        return bool(costmap.field[row, column] > 0.0)


class CheckPoseOccupancy(_AtPoses):
    """Succeed when the base could stand at a pose."""

    pose: Goal = In(names="spot", doc="a pose of the map, or a place")

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A pose ahead of the robot."""
        return {"inputs": {"pose": Pose2D(0.5, 0.0, 0.0)}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        pose = pose_at(self.pose, self.site, robot.description.working)
        if not self.free(self.look(robot), pose):
            raise Failure("POSE_OCCUPIED", f"something stands at ({pose.x:.2f}, {pose.y:.2f})")
        return
        yield ""


class RemoveInCollisionGoals(_AtPoses):
    """Keep the goals at which the base could stand."""

    failures: ClassVar = {
        **_AtPoses.failures,
        "POSE_OCCUPIED": "something stands at every goal",
    }

    input_goals: tuple[Goal, ...] = In(
        (), names="spot", may_be_empty=True, doc="poses of the map, or places"
    )
    input_waypoint_statuses: tuple[WaypointStatus, ...] | None = In(
        None, may_be_empty=True, doc="Nav2's; passed on as it is"
    )
    output_goals: tuple[Goal, ...] = Out(doc="the goals that are free")
    output_waypoint_statuses: tuple[WaypointStatus, ...] = Out(doc="what came in")

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A goal ahead of the robot."""
        return {"inputs": {"input_goals": (Pose2D(0.5, 0.0, 0.0),)}}

    def run(self, robot: Robot) -> Run:
        """Answer at once."""
        vehicle, working = self.look(robot), robot.description.working
        kept = tuple(
            goal
            for goal in self.input_goals
            if self.free(vehicle, pose_at(goal, self.site, working))
        )
        if self.input_goals and not kept:
            raise Failure(
                "POSE_OCCUPIED", f"something stands at each of {len(self.input_goals)} goals"
            )
        self.output_goals = kept
        self.output_waypoint_statuses = self.input_waypoint_statuses or ()
        return
        yield ""
