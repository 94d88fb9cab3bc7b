"""detect_plane: measure the surface near a tag and find free spots on it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import PlanningScene
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute

if TYPE_CHECKING:
    from momantu_skills.perception.surfaces import Surroundings

BUDGET = 0.1
"""s granted to making sense of one look, and again to finding spots."""
LOOKS = 2
"""Looks to the left and right of the place: each sees behind what hides from the other."""
HAND = 0.10
"""m; breadth of what is to be set down where nothing is held and no size is given."""


class DetectPlane(Skill):
    """Measure the level surface at a place: its height, outline, what stands on it, free spots."""

    near: Pose = In(doc="a place on the surface, such as a tag's pose")
    size: tuple[float, ...] | None = In(
        None, unit="m", doc="x, y (and z) of what needs room; default: what is held"
    )
    plane: SupportPlane = Out(doc="the surface; its frame lies at `near`, axes along odom's")
    spots: tuple[Pose, ...] = Out(
        doc="free spots, best first, on the surface, x away from the robot, z up; odom"
    )
    failures = {
        "PLANE_NOT_FOUND": "no level surface was seen there",
        "NO_FREE_SPOT": "nothing on it within reach of `near` has room for the size",
    }
    uses = {CAMERA_CARRIER}
    planning_scene: PlanningScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Look, measure, choose."""
        from momantu_skills.perception.surfaces import surroundings
        from momantu_skills.perception.surveys import place_region, survey

        near = self.frames.lookup(ODOM, self.near.frame).apply(self.near.position)
        corners, region = place_region(near)
        views = yield from survey(
            self, robot, corners, region, at_least=LOOKS, budget=BUDGET, unseen="PLANE_NOT_FOUND"
        )
        base = self.frames.lookup(ODOM, robot.description.base_frame)
        radius = self._radius()
        found = yield from compute(
            lambda: surroundings(views, region, near, base, radius), budget=BUDGET
        )
        if found is None:
            raise Failure(
                "PLANE_NOT_FOUND",
                f"{len(views)} looks showed no level surface at ({near[0]:.2f}, {near[1]:.2f}, "
                f"{near[2]:.2f}) m in odom",
                points=[len(view.points) for view in views],
            )
        if not found.spots:
            raise self._full(found, radius, near)
        self.plane, self.spots = found.plane, found.spots

    def _radius(self) -> float:
        """Of the circle that what needs room fits in, whichever way it is turned, m."""
        held = self.planning_scene.held
        if self.size is not None:
            across = (*self.size[:2], *self.size[:1])[:2]
        elif held is not None:
            across = held.object.size[:2]
            if held.object.shape == "cylinder":
                return max(across) / 2
        else:
            return HAND / 2
        return math.hypot(*across) / 2

    def _full(self, found: Surroundings, radius: float, near: Array) -> Failure:
        return Failure(
            "NO_FREE_SPOT",
            f"nothing of the surface around ({near[0]:.2f}, {near[1]:.2f}) m has room for a base "
            f"{2 * radius:.2f} m across; {len(found.plane.obstacles)} things stand there",
            radius=radius,
            obstacles=[list(obstacle) for obstacle in found.plane.obstacles],
        )
