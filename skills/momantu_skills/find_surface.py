"""find_surface: look for a surface around the place where it is said to be."""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, PlaneAt
from momantu_bt.descriptions.tunables import configured
from momantu_bt.detector import View
from momantu_bt.failure import FailureValue
from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Array, Pose, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.redrawing import DRAWN, surface_at
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Compute, Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_bt.world import Surface
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.plan.goals import Stand

with lazily():
    from momantu_skills.gaze import surveys, tucking
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import trip
    from momantu_skills.navigation.drive.vehicle import Vehicle
    from momantu_skills.navigation.map import believed
    from momantu_skills.navigation.map import costmap as costmaps
    from momantu_skills.navigation.plan import lookouts
    from momantu_skills.perception.camera import pictures
    from momantu_skills.perception.geometry import regions
    from momantu_skills.perception.surface import tops


FARTHEST = 1.5
"""Largest distance of a surface from where the site says, m: farther away it may be another one."""
VIEWS = 5
"""Most places from which the robot looks."""
CLOSE = 3.0
"""Distance to the place within which it is first looked at from where the robot is, m."""
BUDGET = 0.2
"""Time allowed for processing one place's pictures, s."""
SIDEWAYS = 1
"""Number of pictures to each side of the middle one."""
NEAREST_LOOK, FARTHEST_LOOK = 1.0, 2.0
"""Least and largest distance of the point that the camera looks at, m."""
ARRIVED = (0.15, 0.15)
"""Largest distance from a stand and heading error there, m and rad."""
ELSEWHERE = 0.5
"""Distance from where it looked before from which a stopped base sees something else, m."""
KNOWN = 0.5
"""Share of a top that the map knows as something else, above which it is that."""
HEIGHT = 0.03
"""Largest error of the measured height, m."""
FIT = 0.4
"""Least fit of the newest scan. A table elsewhere fills a share s of it where the map is free, and
a share o goes through where the map has it: (1 - s - o) / (1 - 0.6 s) is left of the fit, as early
beams count 0.4. Close before a table 1.5 m wide, with s = 0.4 and o = 0.25, that is 0.46."""
NO_WAY = (
    "START_KEPT_OUT",
    "GOAL_KEPT_OUT",
    "GOAL_BLOCKED",
    "NO_PATH",
    "PATH_BLOCKED",
    "NO_PROGRESS",
)


@dataclass(frozen=True, slots=True)
class Seen:
    """A level patch: its rectangle in the map, and why it is not the surface; "" if it may be."""

    top: tops.Top
    why: str


class FindSurface(Skill):
    """Look for a table or shelf around its place, when it is not where the site says.

    The robot looks from where it is, then from up to four places around, for a level top of the
    told size and height that neither the map nor the site knows as another. From then on all skills
    of this run believe that the surface is there.
    """

    surface: str = In(names="surface", doc="which one")
    top: Pose = Out(doc="the middle of its top, x and y along its edges; map")
    moved: float = Out(unit="m", doc="its distance from where the site says")
    also_called: ClassVar = ("find_table", "search_surface", "search_table")
    failures: ClassVar = {
        "SURFACE_NOT_FOUND": "no top like it was seen around its place; data say from where",
        "NOT_LOCALIZED": "the robot is not sure enough where it is",
        "ARM_STUCK": "the arm that carries the camera is stretched out and does not fold",
    }
    uses: ClassVar = {"base", CAMERA_CARRIER}
    senses: ClassVar = {"camera"}
    activities: ClassVar = {Activity.MEASURE_SURFACE: ""}
    symptoms: ClassVar = {
        "SURFACE_NOT_FOUND": {Symptom.NOT_SEEN, Symptom.WAY_BLOCKED},
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }
    localization: Localization = Needs()
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Look for a surface of the example."""
        return {"inputs": {"surface": "table_a"}}

    def __init__(self) -> None:
        """Start without views."""
        super().__init__()
        self._views: list[View] = []
        self._from: list[Pose2D] = []
        self._seen: tuple[Seen, ...] = ()

    def run(self, robot: Robot) -> Run:
        """Look from one place after the other until the surface is seen."""
        surface = self._told()
        if robot.description.eye_in_hand:
            yield from tucking.take_in(self, robot, self.planning_scene)
        config = configured(NavigationConfig, self.site.services.get("navigate", {}), "navigate")
        vehicle = Vehicle(
            self, robot, self.localization, self.planning_scene, config, surface.height
        )
        yield from trip.be_sure(vehicle, FIT)
        controller = mppi.Mppi(robot.description.base, config, self.random)
        for number in range(VIEWS):
            here = number == 0 and vehicle.pose().distance_to(surface.map_from_surface) < CLOSE
            if not here and not (yield from self._go(robot, vehicle, controller, surface)):
                break
            self._from.append(vehicle.pose())
            yield from self._look(robot, surface)
            self._seen = yield from compute(
                partial(self._judged, vehicle.costmap, surface), budget=BUDGET
            )
            found = tops.nearest([s.top for s in self._seen if not s.why], surface.map_from_surface)
            if found is not None:
                self._believe(found, surface)
                return
        raise self._not_found(surface)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim a level top where the surface was found."""
        if failure is not None:
            return None
        return PlaneAt(self.frames.lookup(ODOM, MAP) @ self.top.transform, HEIGHT)

    def _told(self) -> Surface:
        surface = self.site.surfaces.get(self.surface)
        if surface is None:
            known = ", ".join(self.site.surfaces) or "none"
            raise Failure(
                "SURFACE_NOT_FOUND",
                f"the site has no surface {self.surface!r}; surfaces: {known}",
            )
        return surface

    def _go(
        self, robot: Robot, vehicle: Vehicle, controller: mppi.Mppi, surface: Surface
    ) -> Generator[str | Compute, Any, bool]:
        """Drive to where what may be a part of it is seen, else its place; False: no way."""
        across = math.hypot(*surface.size) / 2
        off = across + robot.description.working.look_off
        at = surface.map_from_surface
        part = tops.nearest([s.top for s in self._seen if s.why == PART], at)
        for middle in ([] if part is None else [part.pose]) + [at]:
            vehicle.sense()
            stands = lookouts.lookouts(
                (middle.x, middle.y), off, vehicle.pose(), self._from, vehicle.costmap, surface
            )
            if stands and (yield from _went(vehicle, controller, stands)):
                return True
        return False

    def _look(self, robot: Robot, surface: Surface) -> Generator[str | Compute, Any, None]:
        """Take pictures of the surroundings of the surface's place, from the middle outwards."""
        middle = (self.frames.lookup(ODOM, MAP)).apply(
            surface.map_from_surface.transform(surface.height).position
        )
        region = self._region(middle, surface)
        sensor = robot.description.camera()[1]
        base = self.frames.lookup(ODOM, robot.description.base_frame).position
        ahead = math.atan2(middle[1] - base[1], middle[0] - base[0])
        away = float(np.hypot(*(middle[:2] - base[:2])))
        away = min(max(away, NEAREST_LOOK), FARTHEST_LOOK)
        step = surveys.OVERLAP * sensor.horizontal_fov
        for side in sorted(range(-SIDEWAYS, SIDEWAYS + 1), key=abs):
            way = ahead + side * step
            point = base + away * np.array([math.cos(way), math.sin(way), 0.0])
            point[2] = middle[2]
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, point)
            if snapshot is not None:
                self._views.append(pictures.see(snapshot, region, self.planning_scene))

    def _region(self, middle: Array, surface: Surface) -> regions.Region:
        around = regions.disc(middle[:2], FARTHEST + math.hypot(*surface.size) / 2)
        low, high = (float(middle[2]) + side * regions.HEIGHT_ERROR for side in (-1.0, 1.0))
        return regions.Region(around, low, high)

    def _judged(self, costmap: costmaps.Costmap, surface: Surface) -> tuple[Seen, ...]:
        """All level patches that the views show around the place, in the map."""
        if not self._views:
            return ()
        low = surface.height - regions.HEIGHT_ERROR
        high = surface.height + regions.HEIGHT_ERROR
        map_from_odom = self.frames.lookup(MAP, ODOM)
        points = map_from_odom.apply(np.concatenate([view.points for view in self._views]))
        found = tops.tops_among(points, low, high)
        return tuple(Seen(top, self._why_not(top, costmap, surface)) for top in found)

    def _why_not(self, top: tops.Top, costmap: costmaps.Costmap, surface: Surface) -> str:
        """Why a patch is not the surface; "" if it is like it."""
        if not tops.may_be_part(top, surface):
            return "larger"
        if self._known_share(top, costmap, surface) > KNOWN:
            return "on the map as something else"
        distance = top.pose.distance_to(surface.map_from_surface)
        if distance > FARTHEST:
            return "too far away"
        for name, other in self.site.surfaces.items():
            nearer = top.pose.distance_to(other.map_from_surface) < distance
            if name != self.surface and nearer and tops.may_be_part(top, other):
                return f"rather {name}"
        return "" if tops.is_whole(top, surface) else PART

    def _known_share(self, top: tops.Top, costmap: costmaps.Costmap, surface: Surface) -> float:
        """The share of a patch that the map knows, where the surface is not drawn itself."""
        cells = believed.raster(costmap.grid)
        patch = cells.on(replace(surface, map_from_surface=top.pose, size=top.size))
        other = costmap.known & ~cells.on(surface, DRAWN)
        return float((patch & other).sum()) / max(int(patch.sum()), 1)

    def _believe(self, top: tops.Top, surface: Surface) -> None:
        before = surface.map_from_surface
        now = tops.turned_as(top, surface, before.yaw)
        found = replace(surface_at(surface, now), height=top.height)
        self.planning_scene.surface_found(self.surface, found)
        self.top = Pose(now.transform(top.height), MAP, self.clock.now())
        self.moved = now.distance_to(before)

    def _not_found(self, surface: Surface) -> Failure:
        at = surface.map_from_surface
        places = ", ".join(f"({p.x:.1f}, {p.y:.1f})" for p in self._from) or "nowhere: no way there"
        seen = [
            f"a top {s.top.size[0]:.2f} x {s.top.size[1]:.2f} m at ({s.top.pose.x:.2f}, "
            f"{s.top.pose.y:.2f}), {s.why}"
            for s in self._seen
        ]
        return Failure(
            "SURFACE_NOT_FOUND",
            f"no top {surface.size[0]:.2f} x {surface.size[1]:.2f} m, {surface.height:.2f} m high, "
            f"within {FARTHEST} m of ({at.x:.2f}, {at.y:.2f}), where {self.surface} is said to be; "
            f"looked from {places}; there: {'; '.join(seen) or 'no level top'}",
            surface=self.surface,
            looked_from=[[p.x, p.y, p.yaw] for p in self._from],
            seen=seen,
        )


PART = "of another size"
"""Why a patch is not the surface, if it may be a part of it."""


def _went(
    vehicle: Vehicle, controller: mppi.Mppi, stands: list[Stand]
) -> Generator[str | Compute, Any, bool]:
    """Drive to the best of these stands that can be reached; whether there is a new view.

    That is so at the stand, and where something stopped the base on its way.
    """
    start = vehicle.pose()
    to = trip.Destination(lambda: stands, ARRIVED)
    try:
        yield from trip.travel(vehicle, controller, to, recovery=False, quality=FIT)
    except Failure as failure:
        if failure.code not in NO_WAY:
            raise
        return start.distance_to(vehicle.pose()) > ELSEWHERE
    return True
