"""detect_plane: measure the surface near a tag and find free spots on it."""

from __future__ import annotations

import math
from functools import partial

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, PlaneAt, RoomAt
from momantu_bt.failure import FailureValue
from momantu_bt.frames import ODOM
from momantu_bt.geometry import Array, Pose, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import PlanningScene, Snapshot
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom

with lazily():
    from momantu_skills.gaze import surveys
    from momantu_skills.manipulation.hand import resting
    from momantu_skills.perception.camera import pictures
    from momantu_skills.perception.geometry import regions
    from momantu_skills.perception.surface import spots, surfaces


BUDGET = 0.2
"""Time allowed for processing both views and finding spots, s."""
LOOKS = 2
"""Number of views, to the left and right of the place: each shows what is hidden in the other."""
HAND = 0.10
"""Assumed width of the object to place, m, when nothing is held and no size is given."""
LEVEL = 0.01
"""Largest error of the measured height, m; `place` searches for contact over 0.025 m."""


class DetectPlane(Skill):
    """Measure the level surface at a place: height, outline, objects on it and free spots."""

    near: Pose = In(doc="a place on the surface, such as a tag's pose")
    size: tuple[float, ...] | None = In(
        None,
        unit="m",
        least=0.001,
        most=2,
        doc="x, y (and z) of the object to place; default: the held one",
    )
    plane: SupportPlane = Out(
        doc="the surface within 0.6 m of `near`; its frame is there, with axes parallel to odom's"
    )
    spots: tuple[Pose, ...] = Out(
        doc="free spots, best first, on the surface, x away from the robot, z up; odom"
    )
    also_called = ("find_plane", "detect_table", "detect_surface")
    failures = {
        "PLANE_NOT_FOUND": "no level surface was seen there",
        "NO_FREE_SPOT": "no spot on it within reach of `near` has room for the size",
    }
    uses = {CAMERA_CARRIER}
    senses = {"camera"}
    activities = {Activity.MEASURE_SURFACE: ""}
    symptoms = {
        "PLANE_NOT_FOUND": {Symptom.NOT_SEEN},
        "NO_FREE_SPOT": {Symptom.NO_ROOM},
    }
    planning_scene: PlanningScene = Needs()

    def __init__(self) -> None:
        """Start without a size of the object to place."""
        super().__init__()
        self._needed = 0.0

    def run(self, robot: Robot) -> Run:
        """Look, measure, choose the spots."""
        near = self.frames.lookup(ODOM, self.near.frame).apply(self.near.position)
        corners, region = regions.place_region(near)
        snapshots: list[Snapshot] = []
        for point in surveys.looks_over(self, robot, corners, LOOKS):
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, point)
            if snapshot is not None:
                snapshots.append(snapshot)
        radius = self._needed = self._radius()
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

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim a level surface with room at the best spot; a failure denies one of them."""
        if failure is None:
            spot = _point(self.spots[0].position)
            return PlaneAt(self.plane.pose.transform, LEVEL), RoomAt(spot, self._needed, LEVEL)
        if failure.code not in ("PLANE_NOT_FOUND", "NO_FREE_SPOT"):
            return None
        near = self.frames.lookup(ODOM, self.near.frame).apply(self.near.position)
        if failure.code == "PLANE_NOT_FOUND":
            return PlaneAt(Transform(near), LEVEL)

        config = spots.SpotConfig()
        room = self._needed + config.fingers
        return RoomAt(_point(near), room, LEVEL + regions.PLACE_ERROR, config.reach)

    def _measure(
        self,
        snapshots: list[Snapshot],
        region: regions.SurfaceRegion,
        near: Array,
        radius: float,
    ) -> surfaces.Surroundings | None:
        seen = [pictures.see(snapshot, region, self.planning_scene) for snapshot in snapshots]
        if not seen:
            return None
        base = snapshots[-1].odom_from_base
        return surfaces.surroundings(seen, region, near, base, radius)

    def _radius(self) -> float:
        """Return the radius of the circle that the object to place fits in at any yaw, m."""
        held = self.planning_scene.held
        if self.size is not None:
            across = (*self.size[:2], *self.size[:1])[:2]
        elif held is not None:
            across = held.object.size[:2]
            if resting.lies(held.object):
                return math.hypot(max(across), held.object.size[2]) / 2
            if held.object.shape == "cylinder":
                return max(across) / 2
        else:
            return HAND / 2
        return math.hypot(*across) / 2

    def _full(self, found: surfaces.Surroundings, radius: float, near: Array) -> Failure:
        return Failure(
            "NO_FREE_SPOT",
            f"nothing of the surface around ({near[0]:.2f}, {near[1]:.2f}) m has room for a base "
            f"{2 * radius:.2f} m across; {len(found.plane.obstacles)} things stand there",
            radius=radius,
            obstacles=[list(obstacle) for obstacle in found.plane.obstacles],
        )


def _point(position: Array) -> tuple[float, float, float]:
    x, y, z = (float(v) for v in position)
    return x, y, z
