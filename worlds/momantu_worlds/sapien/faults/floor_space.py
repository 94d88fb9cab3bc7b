"""The floor where the robot could stand now: free cells, and paths over them."""

from __future__ import annotations

import math

import numpy as np

from momantu_bt.geometry import Pose2D
from momantu_worlds.sapien.faults.stage import WALL, Stage
from momantu_worlds.scenes.geometry.plane import Passages, Rectangle, passages
from momantu_worlds.scenes.geometry.prisms import Prism

AIR = 0.05
"""Clearance of the base from everything, m."""
BORDER = 1.0
"""Margin of floor around the outermost bodies, m, if there are no walls."""
BARE = 20.0
"""Edge of the floor around the robot, m, if there are no bodies at all."""


def free_floor(stage: Stage) -> Passages:
    """Where the base has room among all static bodies; indoors if there are walls."""
    radius = max(math.hypot(x, y) for x, y in stage.description.footprint) + AIR
    height = max(prism.top for prism in stage.robot_prisms())
    loose = {body.name for body in stage.bodies if not body.static}
    prisms = [s for s in stage.prisms(*loose) if s.bottom < height]
    walls = stage.prisms(categories=(WALL,))
    bounds = [s.base for s in walls or prisms] or [Rectangle(stage.base(), (BARE, BARE))]
    corners = np.concatenate([base.corners() for base in bounds])
    border = 0.0 if walls else BORDER
    low, high = corners.min(axis=0) - border, corners.max(axis=0) + border
    center, size = (low + high) / 2, high - low
    return passages(
        [s.base for s in prisms],
        (float(center[0]), float(center[1])),
        (float(size[0]), float(size[1])),
        radius,
    )


def walls_between(stage: Stage, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether a wall crosses the straight line between two points of the floor."""
    middle = Pose2D((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, math.atan2(b[1] - a[1], b[0] - a[0]))
    line = Prism(Rectangle(middle, (math.dist(a, b), 0.01)), 0.0, 0.1)
    return not line.clear_of(stage.prisms(categories=(WALL,)), 0.0)
