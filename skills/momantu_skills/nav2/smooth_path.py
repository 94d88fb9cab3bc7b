"""SmoothPath: take the corners out of a path, as far as obstacles allow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from momantu_bt.geometry import Array, Path, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import Robot
from momantu_bt.skill import Failure, In, Out, Run, compute
from momantu_bt.symptom import Symptom
from momantu_skills.nav2.action import Nav2Action, known_name
from momantu_skills.navigation.drive.vehicle import Vehicle

with lazily():
    from momantu_skills.navigation.drive import ways

SMOOTHERS = ("simple_smoother", "SmoothPath", "route_smoother")
"""Names of the one smoother: Nav2's usual ones."""
PULL, STAY = 0.3, 0.1
"""Share by which a pose moves to between its neighbours, and back to where it was, each round."""
ROUNDS = 60
"""Rounds: corners are then round on a length of about a metre."""
TIME = 0.05
"""Simulated duration of smoothing, s."""


class SmoothPath(Nav2Action):
    """Smooth a path. Its ends stay; so does every pose that would come too near an obstacle."""

    unsmoothed_path: Path = In((), may_be_empty=True, doc="the path: poses of the map")
    max_smoothing_duration: float = In(3.0, unit="s", least=0, doc="longest time")
    check_for_collisions: bool = In(False, doc="fail when the result touches something")
    smoother_id: str = In(
        "", may_be_empty=True, doc="simple_smoother, or SmoothPath or route_smoother, the same"
    )
    smoothed_path: Path = Out(doc="the smooth path")
    smoothing_duration: float = Out(unit="s", doc="the time that it took")
    was_completed: bool = Out(doc="whether it was finished")

    failures: ClassVar = {
        "INVALID_SMOOTHER": "there is no smoother of this name",
        "TIMEOUT": "smoothing takes longer than it may",
        "SMOOTHED_PATH_IN_COLLISION": "the smooth path touches something",
        "INVALID_PATH": "the path has no poses",
    }
    symptoms: ClassVar = {
        "SMOOTHED_PATH_IN_COLLISION": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED},
    }
    numbers: ClassVar = {
        "UNKNOWN": 500,
        "INVALID_SMOOTHER": 501,
        "TIMEOUT": 502,
        "SMOOTHED_PATH_IN_COLLISION": 503,
        "INVALID_PATH": 505,
    }

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """A path with a corner."""
        path = (*(Pose2D(0.1 * k, 0.0) for k in range(6)), Pose2D(0.5, 0.1), Pose2D(0.5, 0.2))
        return {"inputs": {"unsmoothed_path": path}}

    def act(self, robot: Robot) -> Run:
        """Look, then smooth."""
        known_name(self.smoother_id, SMOOTHERS, "smoother", "INVALID_SMOOTHER")
        if not self.unsmoothed_path:
            raise Failure("INVALID_PATH", "the path has no poses")
        if self.max_smoothing_duration < TIME:
            raise Failure("TIMEOUT", f"smoothing takes {TIME} s")
        vehicle = self.vehicle(robot)
        vehicle.sense()
        begun = self.clock.now()
        self.smoothed_path = yield from compute(lambda: self._smooth(vehicle), TIME)
        self.smoothing_duration = self.clock.now() - begun
        self.was_completed = True
        if self.check_for_collisions:
            self._require_free(vehicle)

    def _smooth(self, vehicle: Vehicle) -> Path:
        path = self.unsmoothed_path
        points = smooth(np.array([(p.x, p.y) for p in path]), lambda at: _is_free(vehicle, at))
        return ways.posed(points, path[-1].yaw)

    def _require_free(self, vehicle: Vehicle) -> None:
        for pose in self.smoothed_path[1:]:
            if not _is_free(vehicle, (pose.x, pose.y)):
                raise Failure(
                    "SMOOTHED_PATH_IN_COLLISION",
                    f"something stands on the path at ({pose.x:.2f}, {pose.y:.2f})",
                )


def _is_free(vehicle: Vehicle, at: Any) -> bool:
    pose = Pose2D(float(at[0]), float(at[1]))
    return vehicle.costmap.grid.contains(pose.x, pose.y) and not ways.occupied(vehicle, pose)


def smooth(points: Array, is_free: Any) -> Array:
    """Smooth points (n, 2); a point that would leave the free space stays where it was."""
    given = points
    for _ in range(ROUNDS):
        between = 0.5 * (points[:-2] + points[2:])
        inner = points[1:-1] + PULL * (between - points[1:-1]) + STAY * (given[1:-1] - points[1:-1])
        points = np.vstack([points[:1], inner, points[-1:]])
    free = np.array([is_free(point) for point in points])
    free[[0, -1]] = True
    return np.where(free[:, None], points, given)
