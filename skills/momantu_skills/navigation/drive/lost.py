"""Driving without knowing where: by odometry, among what the sensors see, to where it is decided.

Poses are in odom here; the map is only asked what the places that look alike would look like.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Sequence
from typing import Any

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Pose2D
from momantu_bt.robot import Robot
from momantu_bt.service import Localization
from momantu_bt.skill import Compute, Skill, compute
from momantu_skills.navigation.config import NavigationConfig
from momantu_skills.navigation.control.mppi import Mppi
from momantu_skills.navigation.drive.body import BodyScene
from momantu_skills.navigation.drive.cruise import cruise, leave
from momantu_skills.navigation.drive.route import Route, planned
from momantu_skills.navigation.drive.until import until
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.localize.telling_apart import disagreement
from momantu_skills.navigation.map.heights import Tall
from momantu_skills.navigation.map.maps import GridMap
from momantu_skills.navigation.map.rolling import unmapped

EXTENT = 8.0
"""Distance from where it is lost to which the base may drive, m; farther round an obstacle."""
RINGS = (1.0, 1.8, 2.6, 3.6, 4.8, 6.0)
"""Distances of the spots from which a look may decide, m."""
DIRECTIONS = 24
TRIED = 6
"""Spots to which a path is planned, the best first."""
PER_METRE = 0.03
"""What a metre of way costs, as a share of beams that differ."""
SEEN = 0.8
"""Spots within this distance of an earlier one show nothing new, m."""
TOLERANCE = 0.3
"""Distance from a spot at which the base is there, m."""
SPEED = 0.6
"""Top speed of a robot that does not know what is behind the next corner, m/s."""
DETOUR = 2.0
"""A path may be longer than the straight way by this factor: the rest is unknown."""

Drive = Generator[str | Compute, Any, None]


class Lost(Vehicle):
    """A vehicle whose map is odom: what it sees, and nothing else."""

    def __init__(
        self,
        skill: Skill,
        robot: Robot,
        localization: Localization,
        scene: BodyScene,
        config: NavigationConfig,
    ) -> None:
        at = Pose2D.from_transform(robot.state().odom_from_base)
        slow = config.model_copy(update={"speed": min(config.speed, SPEED)})
        corners = ((at.x - EXTENT, at.y - EXTENT), (at.x + EXTENT, at.y + EXTENT))
        super().__init__(skill, robot, localization, scene, slow, shared=unmapped(corners, slow))

    def map_from_odom(self) -> Pose2D:
        """Return the identity: all poses are in odom."""
        return Pose2D(0.0, 0.0, 0.0)

    def _beware(self) -> None:
        """Take over nothing: it is told in the map."""

    def show(self, path: Array) -> None:
        """Draw nothing: viewers show paths on the map."""

    @property
    def tall(self) -> Tall:
        """What was seen may all be tall."""
        return Tall(self.costmap.field, self.costmap.frame)

    def sense(self, *, depth: bool = True) -> None:
        """Sense as others do. Low things are told in the map, and these would be in odom."""
        kept = self._scene.low_things
        super().sense(depth=depth)
        self._scene.low_things = kept


def look_elsewhere(
    vehicle: Lost,
    mppi: Mppi,
    grid: GridMap,
    places: Callable[[], Sequence[Pose2D]],
    been: list[Pose2D],
    done: Callable[[], bool],
) -> Generator[str | Compute, Any, bool]:
    """Drive to where the places would look most different; False if there is nowhere to go.

    been: spots to which it drove before (odom); this one is added. done: ends the drive early.
    """
    vehicle.sense()
    route: Route | None = yield from compute(
        lambda: _choose(vehicle, grid, places(), been), vehicle.config.planning_time
    )
    if route is None:
        return False
    been.append(route.stand)
    try:
        yield from until(_go(vehicle, mppi, route), done)
    except Failure as failure:
        if failure.code not in ("PATH_BLOCKED", "NO_PATH", "NO_PROGRESS"):
            raise
    yield from vehicle.stop("look")
    return True


def _go(vehicle: Lost, mppi: Mppi, route: Route) -> Drive:
    yield from leave(vehicle, route.heading(vehicle.pose()))
    yield from cruise(vehicle, mppi, route, TOLERANCE)


def _choose(
    vehicle: Lost, grid: GridMap, places: Sequence[Pose2D], been: Sequence[Pose2D]
) -> Route | None:
    here = vehicle.pose()
    spots = _spots(vehicle, here, been)
    if not len(spots):
        return None
    gain = disagreement(grid, places, spots) if places else np.zeros(len(spots))
    away = np.hypot(spots[:, 0], spots[:, 1])
    worth = gain - PER_METRE * away if gain.max() > 0.0 else PER_METRE * away
    for index in np.argsort(-worth, kind="stable")[:TRIED]:
        if gain[index] < 0.0:
            return None
        x, y = (float(each) for each in spots[index])
        goal = here @ Pose2D(x, y, math.atan2(y, x))
        plan = planned(vehicle, goal)
        if plan is not None and plan.length < DETOUR * away[index] + 1.0:
            return Route(goal, goal, plan)
    return None


def _spots(vehicle: Lost, here: Pose2D, been: Sequence[Pose2D]) -> Array:
    """Spots (n, 2) around the base where it has room, in its frame, m."""
    found = []
    for ring in RINGS:
        for k in range(DIRECTIONS):
            angle = 2.0 * math.pi * k / DIRECTIONS
            spot = Pose2D(ring * math.cos(angle), ring * math.sin(angle), angle)
            there = here @ spot
            fresh = all(there.distance_to(each) > SEEN for each in been)
            if fresh and vehicle.room(there, whole=True) > vehicle.config.margin:
                found.append((spot.x, spot.y))
    return np.array(found).reshape(-1, 2)
