"""Goals of Nav2's leaves: poses of the map, poses written as text, and names of places."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from momantu_bt.geometry import Pose2D
from momantu_bt.robot import Working
from momantu_bt.skill import Failure
from momantu_bt.world import Site
from momantu_skills.navigation.plan.goals import Stand, before_surface

if TYPE_CHECKING:
    from momantu_skills.navigation.map.costmap import Costmap

Goal: TypeAlias = Pose2D | str
"""A pose of the map, a text such as `1.5;2;0` (see `Pose2D.from_text`), or a place's name."""


def stands_at(goal: Goal, site: Site, working: Working) -> list[Stand]:
    """Where the base stands at a goal, best first: one pose, or the stands before a surface.

    Raises:
        Failure: BAD_GOAL.
    """
    if isinstance(goal, str) and goal in site.surfaces:
        return before_surface(site.surfaces[goal], working)
    return [Stand(_pose(goal, site), 0, 0.0)]


def pose_at(goal: Goal, site: Site, working: Working) -> Pose2D:
    """The pose of a goal; of a surface, the best stand before it.

    Raises:
        Failure: BAD_GOAL.
    """
    return stands_at(goal, site, working)[0].pose


def _pose(goal: Goal, site: Site) -> Pose2D:
    if isinstance(goal, Pose2D):
        pose = goal
    elif goal in site.places:
        return site.places[goal]
    else:
        known = ", ".join(site.known_places()) or "none"
        try:
            pose = Pose2D.from_text(goal)
        except ValueError as error:
            text = str(error) if ";" in goal else f"no place {goal!r}; places: {known}"
            raise Failure("BAD_GOAL", text) from None
    if not all(map(math.isfinite, (pose.x, pose.y, pose.yaw))):
        raise Failure("BAD_GOAL", f"the goal ({pose.x}, {pose.y}, {pose.yaw}) is not a pose")
    return pose


def require_on_map(pose: Pose2D, costmap: Costmap, what: str, code: str) -> None:
    """Raise Failure `code` when a pose is off the map."""
    grid = costmap.grid
    if not grid.contains(pose.x, pose.y):
        x, y = grid.origin
        width, height = grid.size
        raise Failure(
            code,
            f"the {what} ({pose.x:.2f}, {pose.y:.2f}) is not on the map, which spans x {x:.1f} to "
            f"{x + width:.1f} and y {y:.1f} to {y + height:.1f} m",
        )
