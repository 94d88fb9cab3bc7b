"""Choosing a goal pose among candidates, and keeping a path that leads to it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.failure import Failure
from momantu_bt.geometry import Array, Pose2D
from momantu_skills.navigation.drive.vehicle import Vehicle
from momantu_skills.navigation.map.fields import Field
from momantu_skills.navigation.plan.goals import Stand
from momantu_skills.navigation.plan.planner import UNREACHED, Plan, plan

LEAD_IN = (0.6, 0.4, 0.2, 0.0)
"""Distances before the goal, on its axis, where the path ends and the approach begins, m; longest
first."""
TRIED = 5
"""Goal poses for which a path is searched before giving up."""
EXTRA = 0.02
"""Clearance that the planner adds to the footprint, m."""
LOOK_AHEAD = 4.0
"""Length of the path ahead that is watched for new obstacles, m."""
PASSAGE = 1.0
"""Distance ahead within which a base that gets no nearer is held up, m."""
CROSSED_BY = 0.05
"""Missing clearance on the path that causes a new plan, m."""


@dataclass(frozen=True, slots=True, eq=False)
class Route:
    """stand: the goal pose (map). lead_in: where the approach begins (map). plan: leads there."""

    stand: Pose2D
    lead_in: Pose2D
    plan: Plan

    def to_go(self, pose: Pose2D) -> float:
        """Return weighted metres from a pose to the lead-in; large outside the plan."""
        row, column = self.plan.grid.index(pose.x, pose.y)
        rows, columns = self.plan.cost.shape
        if not (0 <= row < rows and 0 <= column < columns):
            return float(UNREACHED)
        return float(self.plan.cost[row, column])

    def crossed(self, vehicle: Vehicle, pose: Pose2D) -> bool:
        """Return whether an obstacle is on the path ahead of the base."""
        count = int(LOOK_AHEAD / (0.5 * vehicle.costmap.grid.resolution))
        room = _clearances(vehicle, self._ahead(pose)[:count])
        return bool((room < planning_radius(vehicle) - CROSSED_BY).any())

    def narrowest(self, vehicle: Vehicle, pose: Pose2D) -> tuple[float, float, float]:
        """Return the narrowest point of the next metre (map): x, y, and the clearance there, m."""
        ahead = self._ahead(pose)
        near = np.hypot(*(ahead - ahead[0]).T) < PASSAGE
        room = _clearances(vehicle, ahead[near])
        least = int(np.argmin(room))
        x, y = ahead[near][least].tolist()
        return x, y, float(room[least])

    def _ahead(self, pose: Pose2D) -> Array:
        """Return the path (n, 2) from its point that is nearest to a pose on."""
        away = np.hypot(self.plan.path[:, 0] - pose.x, self.plan.path[:, 1] - pose.y)
        return np.asarray(self.plan.path[int(np.argmin(away)) :])

    def heading(self, pose: Pose2D, ahead: float = 0.5) -> float:
        """Return the direction from a pose to the point of the path `ahead` m farther on, rad."""
        path = self._ahead(pose)
        beyond = path[np.hypot(path[:, 0] - pose.x, path[:, 1] - pose.y) > ahead]
        x, y = beyond[0] if len(beyond) else path[-1]
        return math.atan2(float(y) - pose.y, float(x) - pose.x)


def _clearances(vehicle: Vehicle, points: Array) -> Array:
    """Return the clearance (n,) at points (n, 2) of the map, m."""
    costmap = vehicle.costmap
    cells = ((points - costmap.frame[:2]) / costmap.grid.resolution).astype(np.int64)
    return np.asarray(costmap.field[cells[:, 1], cells[:, 0]])


def planning_radius(vehicle: Vehicle) -> float:
    """Return the clearance that driving straight needs on either side of the base's axis, m."""
    return vehicle.half_width + EXTRA


def free_stands(vehicle: Vehicle, stands: list[Stand]) -> list[Stand]:
    """Return the nearest free stand of each variant, best variant first."""
    best: dict[int, Stand] = {}
    for stand in stands:
        free = vehicle.room(stand.pose, whole=False) > vehicle.config.margin
        if free and (stand.variant not in best or stand.cost < best[stand.variant].cost):
            best[stand.variant] = stand
    return sorted(best.values(), key=lambda stand: stand.cost)


def first_choice(vehicle: Vehicle, stands: list[Stand], side: int) -> Stand | None:
    """Return the `side`-th best free stand, reachable or not; None if none is free."""
    free = free_stands(vehicle, stands)
    return free[side % len(free)] if free else None


def choose(vehicle: Vehicle, stands: list[Stand], side: int, start: Pose2D | None = None) -> Route:
    """Return a route to the `side`-th best stand that is free and can be reached.

    start: where the route begins (map); by default where the base is.

    Raises:
        Failure: GOAL_BLOCKED, GOAL_KEPT_OUT, PATH_BLOCKED or NO_PATH.
    """
    vehicle.costmap.refresh()
    free = free_stands(vehicle, stands)
    if not free:
        raise no_stand(vehicle, stands)
    turn = side % len(free)
    for stand in (free[turn:] + free[:turn])[:TRIED]:
        route = route_to(vehicle, stand.pose, start)
        if route is not None:
            return route
    raise no_way(vehicle, free[turn].pose, start)


def route_to(vehicle: Vehicle, stand: Pose2D, start: Pose2D | None = None) -> Route | None:
    """Return the cheapest path to a stand through a lead-in on its axis; None if there is none."""
    for distance in LEAD_IN:
        lead_in = stand @ Pose2D(-distance, 0.0, 0.0)
        wanted = vehicle.config.margin if distance else -math.inf
        if vehicle.room(lead_in, whole=False) < wanted:
            continue
        found = planned(vehicle, lead_in, start)
        if found is not None:
            return Route(stand, lead_in, found)
    return None


def no_stand(vehicle: Vehicle, stands: list[Stand]) -> Failure:
    """Return GOAL_KEPT_OUT if all stands lie in zones to keep out of, else GOAL_BLOCKED."""
    zones, discs = vehicle.costmap.zones, vehicle.low_discs
    entered = [zones.entered(stand.pose, discs) for stand in stands]
    names = list(dict.fromkeys(name for name in entered if name is not None))
    listed, data = ", ".join(names), [[s.pose.x, s.pose.y, s.pose.yaw] for s in stands[:4]]
    where = (
        f"({stands[0].pose.x:.2f}, {stands[0].pose.y:.2f})"
        if len(stands) == 1
        else f"each of {len(stands)} places where the base could stand"
    )
    if names and None not in entered:
        zone = f"the keep-out zone{'s' if len(names) > 1 else ''} {listed}"
        sentence = f"at {where} the base would stand in {zone}"
        return Failure("GOAL_KEPT_OUT", sentence, places=data, zones=names)
    also = f", or it lies in {listed}, where the robot must not go" if names else ""
    return Failure("GOAL_BLOCKED", f"something stands at {where}{also}", places=data)


def no_way(vehicle: Vehicle, stand: Pose2D, start: Pose2D | None = None) -> Failure:
    """Return PATH_BLOCKED if the map and its zones leave a path, else NO_PATH."""
    pose = start or vehicle.pose()
    known = planned(vehicle, stand, start, known=True)
    where = f"({stand.x:.2f}, {stand.y:.2f})"
    data = {"from": [pose.x, pose.y], "to": [stand.x, stand.y], "radius": planning_radius(vehicle)}
    if known is not None:
        return Failure("PATH_BLOCKED", f"what the sensors see closes every way to {where}", **data)
    names = vehicle.costmap.zones.keep_out
    if names and planned(vehicle, stand, start, mapped=True) is not None:
        closed = f"keep-out zones close every way to {where}; zones: {', '.join(names)}"
        return Failure("NO_PATH", closed, **data, zones=list(names))
    return Failure("NO_PATH", f"the map has no way wide enough to {where}", **data)


def planned(
    vehicle: Vehicle,
    goal: Pose2D,
    start: Pose2D | None = None,
    *,
    known: bool = False,
    mapped: bool = False,
    weight: Field | None = None,
) -> Plan | None:
    """Plan the cheapest path from `start`, by default the base's position; see `planner.plan`."""
    config, radius, caution = vehicle.config, planning_radius(vehicle), vehicle.caution.factors()
    if caution is not None:
        weight = caution if weight is None else weight * caution
    return plan(
        vehicle.costmap,
        start or vehicle.pose(),
        goal,
        radius,
        config.comfort,
        config.planner,
        known=known,
        mapped=mapped,
        weight=weight,
    )
