"""Free spots on a surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from momantu_bt.geometry import Array
from momantu_skills.perception.geometry.grids import Grid, Mask, clearance, closed
from momantu_skills.perception.geometry.regions import depth_inside
from momantu_skills.perception.surface.planes import Support


@dataclass(frozen=True)
class SpotConfig:
    """What makes a spot free, and a free spot good. Lengths in m."""

    cell: float = 0.01
    """Cell size of the grid over the surface; finer than any margin below."""
    reach: float = 0.35
    """Largest distance from the requested place: the task allows 0.40, the rest is for errors."""
    edge: float = 0.03
    """Least distance of the object's base to the edge of the surface."""
    fingers: float = 0.06
    """Least distance of the base to anything else: the open fingers need it."""
    unseen: float = 0.01
    """Least distance of the base to unseen parts of the surface."""
    on_top: float = 0.10
    """Distance from the requested place below which the object would stand on the tag itself."""
    apart: float = 0.08
    """Least distance between two of the spots."""
    most: int = 8
    """Most spots that are returned."""
    comfortable: float = 0.12
    """Clearance above which more gives no advantage."""
    on_top_cost: float = 0.5
    """Cost of standing on the tag, as distance to the robot in m."""
    clearance_worth: float = 2.0
    """Distance to the robot, m, that a metre of clearance is worth."""
    near_worth: float = 0.3
    """Distance to the robot, m, that being a metre nearer to the requested place is worth."""


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A surface as a grid. obstacle, seen: (nx, ny) bool: cells with objects; seen cells."""

    grid: Grid
    obstacle: Mask
    seen: Mask


def survey_ground(support: Support, floor: float, ceiling: float, config: SpotConfig) -> Ground:
    """Where the surface is covered (between `floor` and `ceiling` m above it) and where seen."""
    above = support.points[:, 2] - support.height
    grid = Grid.over(support.outline, config.cell, margin=0.05)
    inside = depth_inside(support.points[:, :2], support.outline) > -0.04
    standing = inside & ~support.on_plane & (above > floor) & (above < ceiling)
    obstacle = grid.counts(support.points[standing, :2]) >= 2
    seen = closed(grid.counts(support.points[support.on_plane, :2]) > 0, 2)
    return Ground(grid, obstacle, seen & ~obstacle)


def free_spots(
    ground: Ground,
    outline: Array,
    near: Array,
    robot: Array,
    radius: float,
    config: SpotConfig,
) -> Sequence[tuple[float, float]]:
    """Spots (x, y) in odom, best first, with room for a base of `radius` m; may be empty.

    outline: (k, 2) of the surface. near: (2,) requested place. robot: (2,) the robot's position.
    """
    centres = ground.grid.centres()
    flat = centres.reshape(-1, 2)
    shape = ground.grid.shape
    edge = depth_inside(flat, outline).reshape(shape)
    room = clearance(ground.obstacle, ground.grid.cell)
    known = clearance(~(ground.seen | ground.obstacle), ground.grid.cell)
    asked = np.linalg.norm(centres - near, axis=2)
    free = (edge >= radius + config.edge) & (room >= radius + config.fingers)
    free &= (known >= radius + config.unseen) & (asked <= config.reach)
    slack = np.minimum(np.minimum(edge - config.edge, room - config.fingers) - radius, 10.0)
    cost = np.linalg.norm(centres - robot, axis=2) + config.near_worth * asked
    cost -= config.clearance_worth * np.minimum(slack, config.comfortable)
    cost += np.where(asked < config.on_top + radius, config.on_top_cost, 0.0)
    return _distinct(flat[free.ravel()], cost[free], config)


def _distinct(spots: Array, cost: Array, config: SpotConfig) -> Sequence[tuple[float, float]]:
    """The cheapest spots that are far enough from each other."""
    chosen: list[Array] = []
    for spot in spots[np.argsort(cost, kind="stable")]:
        if all(float(np.hypot(*(spot - other))) >= config.apart for other in chosen):
            chosen.append(spot)
        if len(chosen) == config.most:
            break
    return [(float(x), float(y)) for x, y in chosen]
