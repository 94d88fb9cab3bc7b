"""explore: drive where the map ends until the floor that the robot can reach is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ClassVar

import numpy as np

from momantu_bt.activity import Activity
from momantu_bt.descriptions.tunables import configured
from momantu_bt.frames import MAP
from momantu_bt.geometry import Pose2D, wrap_angle
from momantu_bt.lazy import lazily
from momantu_bt.marker import Points
from momantu_bt.robot import CAMERA_CARRIER, Robot
from momantu_bt.skill import Failure, In, Needs, Out, Run, Skill, compute
from momantu_bt.symptom import Symptom
from momantu_skills.manipulation.scene.arm_scene import ArmScene
from momantu_skills.mapping.own import Mapping
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.drive.until import until
from momantu_skills.navigation.map.maps import GridMap

with lazily():
    from momantu_skills.gaze import tucking
    from momantu_skills.mapping import frontiers, watching
    from momantu_skills.navigation.control import mppi
    from momantu_skills.navigation.drive import moves, route, trip, vehicle
    from momantu_skills.navigation.plan import goals, planner

TOLERANCE = (0.25, 0.6)
"""How near the base comes to a view, m and rad: it sees as much from beside it."""
CHOOSING = 0.1
"""Time allowed for choosing the next view, s."""
LOOK_EVERY = 1.0
"""Time between two looks at whether a view still has something to show, s."""
LEFT = 0.2
"""Share of what a view promised at which the base turns to the next one, on its way."""
BESIDE = math.cos(math.radians(3.0))
"""Cosine of the angle to the nearest beam below which a scan did not look in a direction."""
TRIES = 2
"""Drives to a frontier before it is given up."""
IN_A_ROW = 5
"""Drives that fail one after the other before the base counts as stuck."""


class Explore(Skill):
    """Drive where the map ends, to the nearest places with much to see, until nothing is left.

    SUCCESS: the robot knows the floor that it can get to on known floor, or `share` of it. What it
    cannot get to, and cannot see from where it can, stays unknown: the floor behind a gap that is
    too narrow, for example; so do nooks that show less than 0.04 % of the floor for a metre of way
    and are less than 2 % of it together. It drives on known floor only. What the camera
    shows on the way is noted: `discover_surface` begins with the tops of tables among it.
    """

    share: int = In(
        100,
        least=5,
        most=100,
        doc="enough: known floor over known floor and what could be seen from its edge, per cent",
    )
    known: float = Out(unit="m2", live=True, doc="free floor on the map so far")
    known_share: int = Out(live=True, doc="the share of the floor that is known, per cent")

    also_called: ClassVar = ("frontier_exploration", "map_building", "explore_lite", "slam")
    failures: ClassVar = {
        "NOT_LOCALIZED": "the scans do not fit the map that they made",
        "GOAL_BLOCKED": "unknown floor is left; something stands where it could be seen from",
        "NO_PATH": "unknown floor is left; the way to it that was there has closed",
        "PATH_BLOCKED": "unknown floor is left; obstacles that the sensors see block the way to it",
        "NO_PROGRESS": "unknown floor is left; the base got no nearer to it for too long",
        "ARM_STUCK": "the arm that carries the camera is stretched out and does not fold",
    }
    uses: ClassVar = {"base", CAMERA_CARRIER}
    activities: ClassVar = {Activity.DRIVE: "+2 s"}
    symptoms: ClassVar = {
        "NOT_LOCALIZED": {Symptom.NOT_LOCALIZED},
        "GOAL_BLOCKED": {Symptom.WAY_BLOCKED},
        "NO_PATH": {Symptom.WAY_BLOCKED},
        "PATH_BLOCKED": {Symptom.WAY_BLOCKED},
        "NO_PROGRESS": {Symptom.WAY_BLOCKED, Symptom.NOT_LOCALIZED, Symptom.SLOW},
        "ARM_STUCK": {Symptom.ARM_OFF_COURSE, Symptom.SLOW},
    }

    mapping: Mapping = Needs()
    planning_scene: ArmScene = Needs()

    def run(self, robot: Robot) -> Run:
        """Choose a view, drive there or until nothing is left to see from it, and again."""
        if robot.description.eye_in_hand:
            yield from tucking.take_in(self, robot, self.planning_scene)
        tour = self._tour(robot)
        while True:
            left = yield from compute(tour.outlook, CHOOSING)
            self.known, self.known_share = self.mapping.known, math.floor(100.0 * left.share)
            if self.known_share >= self.share:
                return
            if not left.prospects:
                tour.judge()
                return
            self._show(left)
            yield from tour.visit(left.prospects[0])

    def _tour(self, robot: Robot) -> _Tour:
        given = self.site.services.get("navigate", {})
        config = configured(NavigationConfig, given, "navigate")
        base = vehicle.Vehicle(self, robot, self.mapping, self.planning_scene, config)
        base.caution.unknown_cost = math.inf
        controller = mppi.Mppi(robot.description.base, config, self.random)
        watch = watching.Watch(self, robot, self.mapping, self.planning_scene)
        return _Tour(base, controller, self.mapping, watch)

    def _show(self, left: frontiers.Outlook) -> None:
        best = left.prospects[0]
        x, y = best.frontier
        self.log(
            f"{self.known:.1f} square metres known, {len(left.prospects)} places to look at; next "
            f"({x:.2f}, {y:.2f}), with {best.gain:.1f} unknown square metres, {best.way:.1f} m away"
        )
        if self.host.watched:
            points = [(*prospect.frontier, 0.05) for prospect in left.prospects]
            self.draw(Points("frontiers", np.array(points), frame=MAP, color="orange", seconds=5.0))


class _Tour:
    """The drives of one exploration, and the frontiers that are done with.

    looked: frontiers that were seen from near, in vain; vain: from afar. given_up: those that the
    base did not get near to, with the last failure.
    """

    def __init__(
        self,
        base: vehicle.Vehicle,
        controller: mppi.Mppi,
        mapping: Mapping,
        watch: watching.Watch,
    ) -> None:
        self._base, self._controller, self._mapping = base, controller, mapping
        self._watch = watch
        self._looked: list[tuple[float, float]] = []
        self._vain: list[tuple[float, float]] = []
        self._failed: list[tuple[float, float]] = []
        self._last: Failure | None = None
        self._in_a_row = 0

    def outlook(self) -> frontiers.Outlook:
        """What is left, without frontiers that are done with."""
        return self._without([*self._looked, *self._given_up()])

    def _without(self, done: list[tuple[float, float]]) -> frontiers.Outlook:
        self._mapping.refresh()
        self._base.sense()
        base, costmap, config = self._base, self._base.costmap, self._base.config
        costmap.refresh()
        radius = route.planning_radius(base)
        cost = planner.reach(costmap, base.pose(), radius, config.comfort, config.planner)
        out = np.hypot(base.discs[:, 0], base.discs[:, 1]) + base.discs[:, 2]
        stands = costmap.field > float(out.max()) + config.margin
        return frontiers.outlook(costmap, cost, stands, done, self._vain)

    def _given_up(self) -> list[tuple[float, float]]:
        near = frontiers.SAME
        return [
            place
            for place in self._failed
            if sum(math.dist(place, other) < near for other in self._failed) >= TRIES
        ]

    def visit(self, prospect: frontiers.Prospect) -> Run:
        """Drive to a view, or until it has nothing more to show."""
        try:
            yield from until(self._way(prospect.view), self._seen(prospect))
        except Failure as failure:
            if failure.code not in trip.RECOVERABLE:
                raise
            self._failed.append(prospect.frontier)
            self._last, self._in_a_row = failure, self._in_a_row + 1
            if self._in_a_row == IN_A_ROW:
                self.judge()
            yield from self._base.wait(0.5, "look again")
            return
        self._in_a_row = 0
        self._mapping.refresh()
        near, _ = TOLERANCE
        arrived = self._base.pose().distance_to(prospect.view) <= near
        if arrived and self._gain(prospect) >= frontiers.LEAST_GAIN:
            self._note_vain(prospect)

    def _way(self, view: Pose2D) -> trip.Trip:
        """Drive to a view; where the base is there already, turn to it."""
        near, facing = TOLERANCE
        here = self._base.pose()
        if here.distance_to(view) <= near and abs(wrap_angle(view.yaw - here.yaw)) > facing:
            yield from moves.turn_to(self._base, view.yaw, "turn to the view")
            return
        stand = goals.Stand(view, 0, 0.0)
        to = trip.Destination(lambda: [stand], TOLERANCE)
        yield from trip.travel(self._base, self._controller, to, recovery=False)

    def _note_vain(self, prospect: frontiers.Prospect) -> None:
        """A look was in vain: what the newest scan covered and did not show, it does not show."""
        survey = self._mapping.survey
        pose, rays = survey.mapper.poses[-1], survey.used[-1].rays
        x, y = (float(part) for part in pose.apply(rays.origin[None])[0])
        beams = np.arctan2(rays.directions[:, 1], rays.directions[:, 0]) + pose.yaw
        again = prospect.frontier in self._vain
        (self._looked if again else self._vain).append(prospect.frontier)
        for place in frontiers.in_sight(self._grid(), x, y):
            off = beams - math.atan2(place[1] - y, place[0] - x)
            if float(np.cos(off).max()) > BESIDE:
                from_near = math.dist(place, (x, y)) < frontiers.NEAR
                (self._looked if from_near else self._vain).append(place)

    def _seen(self, prospect: frontiers.Prospect) -> Callable[[], bool]:
        """Whether most of what the view promised is known, asked again and again."""
        asked = self._base.now()

        def seen() -> bool:
            nonlocal asked
            self._watch.look()
            if self._base.now() - asked < LOOK_EVERY:
                return False
            asked = self._base.now()
            enough = max(frontiers.LEAST_GAIN, LEFT * prospect.gain)
            return self._gain(prospect) < enough

        return seen

    def _gain(self, prospect: frontiers.Prospect) -> float:
        grid = self._grid()
        return frontiers.gain_at(grid, *grid.index(prospect.view.x, prospect.view.y))

    def _grid(self) -> GridMap:
        return frontiers.thick(self._base.costmap, self._looked)

    def judge(self) -> None:
        """Nothing is left but what was given up.

        Raises:
            Failure: there is such a thing, and it could still be seen; with the code of the drive.
        """
        if self._last is None:
            return
        left = self._without(self._looked)
        if left.prospects:
            x, y = left.prospects[0].frontier
            raise Failure(
                self._last.code,
                f"about {(1.0 - left.share) * 100:.0f} % of the floor is left to explore, for "
                f"example at ({x:.2f}, {y:.2f}); {self._last.value.message}",
                share=left.share,
                frontier=[x, y],
            ) from self._last
