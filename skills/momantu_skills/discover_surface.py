"""discover_surface: find a table or shelf that nobody told of, on a map of the robot's own."""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from functools import partial
from typing import Any, ClassVar

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.claim import Claim, PlaneAt
from momantu_bt.descriptions.tunables import configured
from momantu_bt.detector import View
from momantu_bt.failure import FailureValue
from momantu_bt.frames import MAP, ODOM
from momantu_bt.geometry import Pose, Pose2D, Transform
from momantu_bt.lazy import lazily
from momantu_bt.messages import SupportPlane
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.service import Snapshot
from momantu_bt.skill import Compute, Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.mapping.own import Mapping
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.until import until
from momantu_skills.navigation.map.maps import GridMap

with lazily():
    from momantu_skills.gaze import surveys, tucking
    from momantu_skills.mapping import coverage, frontiers, sightings, watching
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import route, trip, vehicle
    from momantu_skills.navigation.plan import goals, lookouts, planner
    from momantu_skills.perception.camera import pictures
    from momantu_skills.perception.geometry import regions
    from momantu_skills.perception.surface import tops

ARRIVED = (0.25, 0.6)
"""How near the base comes to a place to look round from, m and rad: it sees as much beside it."""
BEFORE = (0.15, 0.15)
"""The same of a place to measure a top from."""
CHOOSING = 0.2
"""Time allowed for choosing the next place, s."""
SEEING = 0.1
"""Time allowed for the tops in one picture, s."""
SHOWN = 0.9
"""Share of the camera's view that counts as seen: what lies at its rim may be cut off."""
AWAY = 2.0
"""Distance of the point that the camera looks at, m."""
TABLE = 0.6
"""Height of that point, m: a table's."""
OVER = 0.2
"""Least height of the camera over a top that shows well, m: from lower it is a line from afar."""
LOOKS = 2
"""Fewest pictures of a top that is measured."""
ROUNDS = 3
"""Most times that a top is looked over: until it has not grown."""
GROWN = 0.1
"""By how much an edge grows that is looked at once more, m."""
NEARBY = 1.5
"""Distance from a top's middle within which its parts lie, m."""
NEARLY = 0.02
"""Largest error of a height that was seen from afar, m."""
HEIGHT = 0.03
"""Largest error of the measured height, m."""


class DiscoverSurface(Skill):
    """Look round the known floor for a table or shelf that has no name yet, and measure it.

    The robot begins with what its camera saw on the way, as in `explore`. Then it turns the camera
    to all else that stands on its map, from place to place. A level top of the asked height and
    size is measured from near, and the robot stands before it in the end. Give it a name with
    `name_place`: the next call looks for another one. What was looked at is remembered for the rest
    of the run. The camera must be some way above the tops: raise it first if they are high.
    """

    lowest: float = In(0.3, unit="m", least=0.3, most=1.1, doc="least height of a top")
    highest: float = In(1.1, unit="m", least=0.3, most=1.1, doc="largest height of a top")
    least_edge: float = In(0.4, unit="m", least=0.1, most=5, doc="least length of its shorter edge")
    again: bool = In(False, doc="forget what was looked at before, and what was no surface")
    plane: SupportPlane = Out(doc="its top; its frame is in its middle, in the map")
    looked_share: int = Out(
        live=True, doc="how much of what stands on the map was looked at, per cent"
    )
    also_called: ClassVar = ("search_tables", "find_tables", "discover_tables", "semantic_mapping")
    failures: ClassVar = {
        "NO_NEW_SURFACE": "all that stands on the map was looked at; each top seen has a name",
        "NOT_LOCALIZED": "the scans do not fit the map that they made",
        "ARM_STUCK": "the arm that carries the camera is stretched out and does not fold",
    }
    uses: ClassVar = {"base", CAMERA_CARRIER}
    senses: ClassVar = {"camera"}
    activities: ClassVar = {Activity.MEASURE_SURFACE: ""}
    symptoms: ClassVar = {
        "NO_NEW_SURFACE": {Symptom.NOT_SEEN, Symptom.WAY_BLOCKED},
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }
    mapping: Mapping = Needs()
    planning_scene: ArmScene = Needs()

    def __init__(self) -> None:
        """Start without places that were in vain."""
        super().__init__()
        self._done: list[Pose2D] = []

    def run(self, robot: Robot) -> Run:
        """Look round from one place after the other; measure each top that shows."""
        yield from self._fold(robot)
        notes = self.mapping.sightings
        if self.again:
            notes.forget()
        given = self.site.services.get("navigate", {})
        config = configured(NavigationConfig, given, "navigate")
        base = vehicle.Vehicle(self, robot, self.mapping, self.planning_scene, config)
        base.caution.unknown_cost = math.inf
        controller = mppi.Mppi(robot.description.base, config, self.random)
        while True:
            seen = notes.nearest(base.pose(), self.site.surfaces.values(), self._fits)
            if seen is not None:
                found = yield from self._inspect(robot, base, controller, seen)
                if found is not None:
                    self.plane = _plane(found, self.clock.now())
                    self._left(robot, base)
                    return
                continue
            view = yield from compute(partial(self._next, robot, base), CHOOSING)
            if view is None:
                raise self._none_left(robot)
            self.log(
                f"{self.looked_share} % looked at; next ({view.pose.x:.2f}, {view.pose.y:.2f})"
            )
            if (yield from self._go(robot, base, controller, [goals.Stand(view.pose, 0, 0.0)])):
                yield from self._look_round(robot, base)
            else:
                self._done.append(view.pose)

    def claim(self, robot: Robot, failure: FailureValue | None) -> Claim | None:
        """Claim a level top where one was found."""
        if failure is not None:
            return None
        return PlaneAt(self.frames.lookup(ODOM, MAP) @ self.plane.pose.transform, HEIGHT)

    def _fold(self, robot: Robot) -> Run:
        """Fold an arm that carries the camera."""
        if robot.description.eye_in_hand:
            yield from tucking.take_in(self, robot, self.planning_scene)

    def _next(self, robot: Robot, base: vehicle.Vehicle) -> coverage.View | None:
        """The next place to look round from."""
        self.mapping.refresh()
        base.sense()
        costmap, config = base.costmap, base.config
        costmap.refresh()
        cost = planner.reach(
            costmap, base.pose(), route.planning_radius(base), config.comfort, config.planner
        )
        out = np.hypot(base.discs[:, 0], base.discs[:, 1]) + base.discs[:, 2]
        stands = costmap.field > float(out.max()) + config.margin
        grid, remaining = self._left(robot, base)
        return coverage.best_view(grid, remaining, cost, stands, self._done)

    def _left(self, robot: Robot, base: vehicle.Vehicle) -> tuple[GridMap, coverage.Mask]:
        """The map with its obstacles grown, and which of their outlines were not looked at."""
        grid = frontiers.thick(base.costmap)
        remaining = coverage.left(grid, self.mapping.sightings.looks, self._fov(robot))
        share = 1.0 - float(remaining.sum()) / max(float(coverage.outlines(grid).sum()), 1.0)
        self.looked_share = math.floor(100.0 * share)
        return grid, remaining

    def _fov(self, robot: Robot) -> float:
        return SHOWN * robot.description.camera()[1].horizontal_fov

    def _go(
        self,
        robot: Robot,
        base: vehicle.Vehicle,
        controller: mppi.Mppi,
        stands: list[goals.Stand],
        tolerance: tuple[float, float] = ARRIVED,
    ) -> Generator[str | Compute, Any, bool]:
        """Drive to the best of these places; whether the base got there."""
        yield from self._fold(robot)
        to = trip.Destination(lambda: stands, tolerance)
        try:
            way = trip.travel(base, controller, to, recovery=False)
            yield from until(way, self._looking(robot))
        except Failure as failure:
            if failure.code not in trip.RECOVERABLE:
                raise
            return False
        return True

    def _look_round(
        self, robot: Robot, base: vehicle.Vehicle
    ) -> Generator[str | Compute, Any, None]:
        """Turn the camera to what was not looked at yet, as far as it turns."""
        here, fov = base.pose(), self._fov(robot)
        self.mapping.refresh()
        grid, remaining = self._left(robot, base)
        ways = coverage.directions(coverage.in_sight(grid, remaining, here.x, here.y), fov)
        snapshots: list[Snapshot] = []
        for way in sorted(ways, key=lambda way: math.remainder(way - here.yaw, 2 * math.pi)):
            point = [here.x + AWAY * math.cos(way), here.y + AWAY * math.sin(way), TABLE]
            odom = self.frames.lookup(ODOM, MAP).apply(np.array(point))
            snapshot = yield from surveys.glance(self, robot, self.planning_scene, odom)
            if snapshot is not None:
                snapshots.append(snapshot)
        if snapshots:
            yield from compute(partial(self._watch(robot).note, snapshots), SEEING)
        else:
            self._done.append(here)

    def _watch(self, robot: Robot) -> watching.Watch:
        return watching.Watch(self, robot, self.mapping, self.planning_scene)

    def _looking(self, robot: Robot) -> Callable[[], bool]:
        """Watch on the way, to its end."""
        watch = self._watch(robot)

        def over() -> bool:
            watch.look()
            return False

        return over

    def _fits(self, top: tops.Top) -> bool:
        """Whether a top may be one that is looked for, as far as it was seen."""
        low, high = self.lowest - NEARLY, self.highest + NEARLY
        return low < top.height < high and min(top.size) > self.least_edge - tops.ALIKE

    def _inspect(
        self, robot: Robot, base: vehicle.Vehicle, controller: mppi.Mppi, seen: tops.Top
    ) -> Generator[str | Compute, Any, tops.Top | None]:
        """Drive before a top and measure it; None if it is no surface, or nobody gets there."""
        notes = self.mapping.sightings
        surface = sightings.as_surface(seen)
        off = math.hypot(*seen.size) / 2 + robot.description.working.look_off
        base.sense()
        stands = lookouts.lookouts(
            (seen.pose.x, seen.pose.y), off, base.pose(), [], base.costmap, surface
        )
        found: tops.Top | None = None
        if stands and (yield from self._go(robot, base, controller, stands, BEFORE)):
            found = yield from self._measure(robot, seen)
        why = "nobody gets near to it" if not stands else self._why_not(found)
        what = seen if found is None else found
        self.log(
            f"a top {what.size[0]:.2f} x {what.size[1]:.2f} m, {what.height:.2f} m high, at "
            f"({what.pose.x:.2f}, {what.pose.y:.2f}){': ' if why else ''}{why}"
        )
        if why:
            notes.refused += [seen] if found is None else [seen, found]
            return None
        return found

    def _why_not(self, found: tops.Top | None) -> str:
        """Why a measured top is no new surface; "" if it is one."""
        if found is None:
            return "not seen from near"
        if min(found.size) < self.least_edge:
            return "too small"
        if not self.lowest <= found.height <= self.highest:
            return "too low or too high"
        for name, surface in self.site.surfaces.items():
            if sightings.same(found, sightings.as_top(surface)):
                return f"it is {name}"
        return ""

    def _measure(
        self, robot: Robot, seen: tops.Top
    ) -> Generator[str | Compute, Any, tops.Top | None]:
        """Look over a top until it does not grow; None if it does not show."""
        views: list[View] = []
        top: tops.Top | None = None
        now = seen
        for _ in range(ROUNDS):
            surface = sightings.as_surface(now)
            corners = regions.surface_corners(surface, self.frames)
            middle = corners.mean(axis=0)
            low, high = (float(middle[2]) + side * sightings.LEVEL for side in (-1.0, 1.0))
            region = regions.Region(regions.disc(middle[:2], NEARBY), low, high)
            for point in surveys.looks_over(self, robot, corners, LOOKS):
                snapshot = yield from surveys.glance(self, robot, self.planning_scene, point)
                if snapshot is not None:
                    view = pictures.see(snapshot, region, self.planning_scene, stride=1)
                    views.append(view)
            top = yield from compute(partial(self._measured, views, now), SEEING)
            if top is None:
                return None
            if max(top.size) < max(now.size) + GROWN and min(top.size) < min(now.size) + GROWN:
                return top
            now = top
        return top

    def _measured(self, views: list[View], seen: tops.Top) -> tops.Top | None:
        """The top of which a part was seen."""
        if not views:
            return None
        low, high = (seen.height + side * sightings.LEVEL for side in (-1.0, 1.0))
        found = tops.tops_in(views, self.frames.lookup(MAP, ODOM), low, high)
        like = [top for top in found if sightings.same(top, seen)]
        return max(like, key=lambda top: top.area, default=None)

    def _none_left(self, robot: Robot) -> Failure:
        refused = self.mapping.sightings.refused
        left = f"; the base did not get to {len(self._done)} places" if self._done else ""
        camera = self.frames.lookup(ODOM, robot.description.camera()[1].frame)
        height = float(camera.position[2])
        if self.highest > height - OVER and not robot.description.eye_in_hand:
            left += (
                f"; tops above {height - OVER:.2f} m hardly show, as the camera is {height:.2f} m "
                "high: raise it with reset_pose, and look again with `again: true`"
            )
        return Failure(
            "NO_NEW_SURFACE",
            f"{self.looked_share} % of what stands on the map was looked at, from "
            f"{len(self.mapping.sightings.looks)} views; {len(refused)} tops are no surfaces, and "
            f"{len(self.site.surfaces)} have names{left}",
            looked_share=self.looked_share,
            refused=[[top.pose.x, top.pose.y, top.height] for top in refused],
        )


def _plane(top: tops.Top, stamp: float) -> SupportPlane:
    x, y = top.size[0] / 2, top.size[1] / 2
    outline = ((-x, -y), (x, -y), (x, y), (-x, y))
    turned: Transform = top.pose.transform(top.height)
    return SupportPlane(Pose(turned, MAP, stamp), outline)
