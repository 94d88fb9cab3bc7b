"""detect_plane: measure the surface near a tag and find free spots on it."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import PlanningScene
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute

if TYPE_CHECKING:
    from momantu_skills.perception.surfaces import Surroundings
    from momantu_skills.perception.surveys import SurfaceRegion
    from momantu_skills.perception.views import Snapshot

BUDGET = 0.2
"""s granted to making sense of both looks and to finding spots."""
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
    plane: SupportPlane = Out(
        doc="the surface as seen within 0.6 m of `near`, where its frame lies, axes along odom's"
    )
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
        from momantu_skills.perception.surveys import glance, looks_over, place_region

        near = self.frames.lookup(ODOM, self.near.frame).apply(self.near.position)
        corners, region = place_region(near)
        snapshots: list[Snapshot] = []
        for point in looks_over(self, robot, corners, LOOKS):
            snapshot = yield from glance(self, robot, self.planning_scene, point)
            if snapshot is not None:
                snapshots.append(snapshot)
        radius = self._radius()
        found = yield from compute(
            partial(self._measure, snapshots, region, near, radius), budget=BUDGET
        )
        if found is None:
            raise Failure(
                "PLANE_NOT_FOUND",
                f"{len(snapshots)} looks showed no level surface at ({near[0]:.2f}, "
                f"{near[1]:.2f}, {near[2]:.2f}) m in odom",
                looks=len(snapshots),
            )
        if not found.spots:
            raise self._full(found, radius, near)
        self.plane, self.spots = found.plane, found.spots

    def _measure(
        self, snapshots: list[Snapshot], region: SurfaceRegion, near: Array, radius: float
    ) -> Surroundings | None:
        from momantu_skills.perception.surfaces import surroundings
        from momantu_skills.perception.views import see

        views = [see(snapshot, region, self.planning_scene) for snapshot in snapshots]
        if not views:
            return None
        base = snapshots[-1].odom_from_base
        return surroundings(views, region, near, base, radius)

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
