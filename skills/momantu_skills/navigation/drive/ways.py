"""Ways as poses: from a start through several stops, for whoever follows them later."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from momantu_bt.geometry import Array, Path, Pose2D
from momantu_skills.navigation.drive.route import (
    choose,
    free_stands,
    no_stand,
    no_way,
    planned,
    planning_radius,
)
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.plan.goals import Stand

SPACING = 0.1
"""Distance between the poses of a way, m."""


def through(vehicle: Vehicle, start: Pose2D, stops: Sequence[list[Stand]]) -> Path:
    """Return the cheapest path from `start` past all stops; it ends at the last one's best stand.

    stops: for each, the stands at which it counts as reached. The path passes the earlier ones
    without regard to their heading.

    Raises:
        Failure: GOAL_BLOCKED, GOAL_KEPT_OUT, PATH_BLOCKED or NO_PATH.
    """
    legs: list[Array] = []
    here = start
    for stands in stops[:-1]:
        free = free_stands(vehicle, stands)
        if not free:
            raise no_stand(vehicle, stands)
        plan = planned(vehicle, free[0].pose, here)
        if plan is None:
            raise no_way(vehicle, free[0].pose, here)
        legs.append(plan.path)
        here = free[0].pose
    route = choose(vehicle, stops[-1], 0, here)
    last = np.array([[route.stand.x, route.stand.y]])
    return posed(np.vstack([*legs, route.plan.path, last]), route.stand.yaw)


def occupied(vehicle: Vehicle, pose: Pose2D) -> bool:
    """Return whether no path can begin at a pose: an obstacle is within the base's width."""
    row, column = vehicle.costmap.grid.index(pose.x, pose.y)
    least = planning_radius(vehicle) - vehicle.config.planner.tight_by
    return bool(vehicle.costmap.field[row, column] < least)


def posed(points: Array, yaw: float) -> Path:
    """Return points (n, 2) as poses `SPACING` apart that look along the path, at its end `yaw`."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    points = points[np.concatenate([[True], steps > 1e-9])]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    end = (float(points[-1, 0]), float(points[-1, 1]))
    count = max(1, math.ceil(float(along[-1]) / SPACING))
    at = np.linspace(0.0, float(along[-1]), count + 1)[:-1]
    x, y = (np.interp(at, along, points[:, k]) for k in (0, 1))
    ahead = np.stack([np.append(x[1:], end[0]) - x, np.append(y[1:], end[1]) - y], axis=1)
    poses = [
        Pose2D(float(px), float(py), math.atan2(float(d[1]), float(d[0])))
        for px, py, d in zip(x, y, ahead, strict=True)
    ]
    return (*poses, Pose2D(*end, yaw)) if along[-1] > 1e-9 else (Pose2D(*end, yaw),)
