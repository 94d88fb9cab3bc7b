"""navigate: drive to a place, before a surface, or to where a pose can be reached."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from momantu_bt.activity import Activity
from momantu_bt.claim import BaseAt, BaseNear, Claim, Holding
from momantu_bt.descriptions.tunables import configured
from momantu_bt.failure import FailureValue
from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose, Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.robot import CAMERA_CARRIER, Robot, Working
from momantu_bt.service import Localization, offers
from momantu_bt.skill import Failure, In, Needs, Run, Skill
from momantu_bt.symptom import Symptom
from momantu_bt.world import Surface
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.until import until
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.localize.confidence import estimate
from momantu_skills.navigation.map.own import OwnMap
from momantu_skills.navigation.plan.clear_view import in_view
from momantu_skills.navigation.plan.goals import Stand, before_surface, surface_at, within_reach

with lazily():
    from momantu_skills.gaze import tucking
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import trip


SURVEY = (0.05, 0.03)
"""Accuracy of the map in m and rad: one cell, and the heading error that a scan can show."""


class Navigate(Skill):
    """Drive to a goal, around unknown obstacles, and stop there within tolerance.

    It stops where the hand loses what it carries, and drivers then keep off where that may lie.
    Without a map poses lie in odom, and what nobody has seen counts as free: `PATH_BLOCKED` where
    what was seen on the way leaves none.
    The site's zones hold: the base keeps out of some, drives slowly in others, and prefers others.
    """

    in_front_of: str | None = In(None, names="place", doc="a place, or a surface to look over")
    goal: Pose2D | None = In(None, frame="map", doc="a pose in the map")
    within_reach_of: Pose | None = In(
        None, doc="drive to where the hand reaches this pose, or as near as its surface allows"
    )
    side: int = In(
        0, least=0, doc="0: the best goal pose; 1, 2, …: the next best, to retry from elsewhere"
    )
    tolerance: float = In(
        0.05, unit="m", least=0.001, most=2, doc="largest distance from the goal pose"
    )
    angle_tolerance: float = In(
        0.05, unit="rad", least=0.001, most=3.15, doc="largest heading error at the end"
    )
    recovery: bool = In(True, doc="when blocked: look again, back up, turn, and retry")

    also_called: ClassVar = ("go_to", "goto", "drive_to", "move_to", "move_base", "nav_to", "go")
    failures: ClassVar = {
        "BAD_GOAL": "the goal is not one place on the map",
        "START_KEPT_OUT": "the base stands in a keep-out zone",
        "GOAL_KEPT_OUT": "every place where the base could stand lies in a keep-out zone",
        "GOAL_BLOCKED": "every place where the base could stand is occupied",
        "NO_PATH": "the map, or its keep-out zones, leave no path that is wide enough",
        "PATH_BLOCKED": "obstacles that the sensors see block the path",
        "NO_PROGRESS": "the base got no nearer for too long",
        "NOT_LOCALIZED": "the robot is not sure enough where it is",
        "ARM_STUCK": "the arm that carries the camera is stretched out and does not fold",
        "LOAD_LOST": "what the hand carried fell out of it on the way; the base stands",
    }
    uses: ClassVar = {"base", CAMERA_CARRIER}
    activities: ClassVar = {Activity.DRIVE: "+2 s"}
    symptoms: ClassVar = {
        "START_KEPT_OUT": {Symptom.NOT_LOCALIZED},
        "GOAL_BLOCKED": {Symptom.WAY_BLOCKED},
        "NO_PATH": {Symptom.WAY_BLOCKED},
        "PATH_BLOCKED": {Symptom.WAY_BLOCKED},
        "NO_PROGRESS": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED, Symptom.SLOW},
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
        "LOAD_LOST": {Symptom.NOT_HELD},
    }
    one_of: ClassVar = (("in_front_of", "goal", "within_reach_of"),)

    localization: Localization = Needs()
    planning_scene: ArmScene = Needs()

    @classmethod
    def rehearsal(cls, seed: int) -> Mapping[str, Any]:
        """Use one of the three kinds of destination."""
        return {"inputs": {"in_front_of": "table_a"}}

    def __init__(self) -> None:
        """Start without a destination."""
        super().__init__()
        self._going: trip.Destination | None = None

    def run(self, robot: Robot) -> Run:
        """Check the goal, then travel."""
        self._check(robot)
        config = self._config()
        if robot.description.eye_in_hand:
            yield from tucking.take_in(self, robot, self.planning_scene)
        surface = self._surface()
        top = 0.0 if surface is None else surface.height
        vehicle = Vehicle(
            self, robot, self.localization, self.planning_scene, config, top, goals=self._goals()
        )
        destination = self._going = self._destination(vehicle, robot.description.working)
        controller = mppi.Mppi(robot.description.base, config, self.random)
        travel = trip.travel(vehicle, controller, destination, recovery=self.recovery)
        yield from self._carrying(vehicle, travel)

    def _carrying(self, vehicle: Vehicle, travel: Run) -> Run:
        """Travel, and stop where the hand loses what it carries: the base could drive onto it."""
        load = self.planning_scene.held

        def is_lost() -> bool:
            return load is not None and self.planning_scene.held is None

        yield from until(travel, is_lost)
        if load is not None and is_lost():
            yield from vehicle.stop("load lost")
            here = vehicle.pose()
            raise Failure(
                "LOAD_LOST",
                f"the {load.object.category} is no longer in the hand; the base stopped at "
                f"({here.x:.2f}, {here.y:.2f}) in the map, so look around there",
                at=[here.x, here.y, here.yaw],
            )

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim that the base is at its goal or in reach.

        NOT_LOCALIZED denies the estimate, LOAD_LOST that the hand holds anything.
        """
        if failure is not None and failure.code == "LOAD_LOST":
            return Holding(True)
        if failure is not None and failure.code == "NOT_LOCALIZED":
            return estimate(self.localization)
        if self._going is None or self._going.chosen is None:
            return None
        own = self.site.map_file is None or offers(self.localization, OwnMap)
        if own and self.within_reach_of is None:
            return None  # nobody else knows where odometry, or the robot's own map, began
        if failure is None and self.within_reach_of is not None:
            target, stand = self.within_reach_of, self._going.chosen
            x, y, _ = self.frames.lookup(ODOM, target.frame).apply(target.position)
            away = stand.distance_to(Pose2D(*self._point(target)))
            farthest = max(away, robot.description.working.reached[2])
            return BaseNear((float(x), float(y)), farthest + self.tolerance)
        if failure is None or (failure.code in self.failures and self.within_reach_of is None):
            distance, turn = SURVEY
            stand, angle = self._going.chosen, self.angle_tolerance
            return BaseAt(stand, self.tolerance + distance, angle + turn)
        return None

    def _config(self) -> NavigationConfig:
        return configured(NavigationConfig, self.site.services.get("navigate", {}), "navigate")

    def _check(self, robot: Robot) -> None:
        given = [
            n for n in ("in_front_of", "goal", "within_reach_of") if getattr(self, n) is not None
        ]
        if len(given) != 1:
            raise Failure(
                "BAD_GOAL",
                "navigate takes exactly one of in_front_of, goal and within_reach_of; "
                f"it got {', '.join(given) or 'none'}",
            )
        if not (self.tolerance > 0.0 and self.angle_tolerance > 0.0 and self.side >= 0):
            raise Failure(
                "BAD_GOAL",
                f"tolerance {self.tolerance} m and angle_tolerance {self.angle_tolerance} rad must "
                f"be above 0, side {self.side} at least 0",
            )
        if self.within_reach_of is not None and robot.description.working.reach is None:
            raise Failure(
                "BAD_GOAL",
                f"within_reach_of needs an arm, and {robot.description.name} has none; give "
                "in_front_of or goal",
            )
        known = self.site.known_places()
        if self.in_front_of is not None and self.in_front_of not in known:
            raise Failure(
                "BAD_GOAL", f"no place {self.in_front_of!r}; places: {', '.join(known) or 'none'}"
            )

    def _surface(self) -> Surface | None:
        """Return the surface that the base drives up to."""
        if self.within_reach_of is not None:
            return surface_at(self._point(self.within_reach_of), self.site.surfaces.values())
        return self.site.surfaces.get(self.in_front_of or "")

    def _goals(self) -> list[tuple[float, float]]:
        """Return the point to drive to, map, m; none if it is no point."""
        place = self.goal
        if self.within_reach_of is not None:
            return [self._point(self.within_reach_of)]
        if self.in_front_of in self.site.surfaces:
            place = self.site.surfaces[str(self.in_front_of)].map_from_surface
        elif self.in_front_of is not None:
            place = self.site.places[self.in_front_of]
        assert place is not None  # `_check` has seen to it
        return [(place.x, place.y)] if math.isfinite(place.x + place.y) else []

    def _point(self, pose: Pose) -> tuple[float, float]:
        """Return (x, y) of a pose in the map, by the current localization."""
        there = pose.position
        if pose.frame != MAP:
            there = self.frames.lookup(MAP, pose.frame).apply(there)
        return float(there[0]), float(there[1])

    def _destination(self, vehicle: Vehicle, working: Working) -> trip.Destination:
        if self.in_front_of in self.site.surfaces:
            return self._before(str(self.in_front_of), vehicle, working)
        if self.within_reach_of is not None:
            return self._in_reach(self.within_reach_of, vehicle, working)
        return self._at(vehicle)

    def _before(self, named: str, vehicle: Vehicle, working: Working) -> trip.Destination:
        """Before a surface, which moves with the map while that is made."""
        surfaces, base = self.site.surfaces, vehicle.pose()
        told, moves = surfaces[named], offers(self.localization, OwnMap)

        def stands() -> list[Stand]:
            surface = surfaces[named] if moves else told
            middle = surface.map_from_surface
            before = before_surface(surface, working, base)
            return in_view(before, (middle.x, middle.y), surface, vehicle.costmap.grid)

        return trip.Destination(
            stands,
            (self.tolerance, self.angle_tolerance),
            side=self.side,
            thing=(lambda: surfaces[named].map_from_surface) if moves else None,
        )

    def _in_reach(self, target: Pose, vehicle: Vehicle, working: Working) -> trip.Destination:
        """Where the hand reaches a pose."""

        def stands() -> list[Stand]:
            point, surface = self._point(target), self._surface()
            near = within_reach(point, self.site.surfaces.values(), vehicle.pose(), working)
            return near if surface is None else in_view(near, point, surface, vehicle.costmap.grid)

        tolerance = (self.tolerance, self.angle_tolerance)
        return trip.Destination(stands, tolerance, side=self.side, in_odom=True)

    def _at(self, vehicle: Vehicle) -> trip.Destination:
        """At a pose, or at a place, which moves with the map while that is made."""
        places, named = self.site.places, str(self.in_front_of)
        pose = self.goal if self.goal is not None else places[named]
        if not all(map(math.isfinite, (pose.x, pose.y, pose.yaw))) or not (
            vehicle.costmap.grid.contains(pose.x, pose.y)
        ):
            width, height = vehicle.costmap.grid.size
            x, y = vehicle.costmap.grid.origin
            where = "on the map, which" if vehicle.mapped else "in reach without a map, which"
            raise Failure(
                "BAD_GOAL",
                f"({pose.x}, {pose.y}) is not {where} spans x {x:.1f} to {x + width:.1f} and "
                f"y {y:.1f} to {y + height:.1f} m",
            )
        tolerance = (self.tolerance, self.angle_tolerance)
        if self.goal is None:
            return trip.Destination(
                lambda: [Stand(places[named], 0, 0.0)], tolerance, thing=lambda: places[named]
            )
        return trip.Destination(lambda: [Stand(pose, 0, 0.0)], tolerance)
