"""A small scene for tests: a floor, a table, a wall, a picture and a can."""

from __future__ import annotations

import numpy as np

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.world import Site
from momantu_worlds.scenes.geometry.bodies import (
    Body,
    Box,
    Cylinder,
    Episode,
    Part,
    Picture,
    PointLight,
    SunLight,
)

TABLE_HEIGHT = 0.72
CAN_RADIUS, CAN_HEIGHT, CAN_MASS = 0.035, 0.13, 0.4
WALL_FACE = 2.925
"""x of the wall's near face, m."""


def plain_episode(
    *,
    can_friction: float = 0.8,
    can_at: tuple[float, float, float] = (0.95, 0.0, TABLE_HEIGHT),
    table: bool = True,
    stand: bool = False,
) -> Episode:
    """The robot at the origin looks along x at a table 0.8 m away; a wall stands behind it.

    can_at: centre of the can's bottom. stand: a thin post carries the can, not the table.
    """
    pixels = np.full((80, 80, 3), 255, dtype=np.uint8)
    pixels[10:40, 40:70] = 0
    floor = Part(Box((20, 20, 1)), Transform((0, 0, -0.5)), (0.6, 0.5, 0.4), collision=False)
    bodies = [
        Body("floor", "floor", Transform(), (floor,)),
        Body("wall", "wall", Transform((3, 0, 1.25)), (Part(Box((0.15, 8, 2.5))),)),
    ]
    if table:
        top = Part(Box((0.8, 1.4, TABLE_HEIGHT)), Transform((0, 0, TABLE_HEIGHT / 2)))
        can = Part(Cylinder(CAN_RADIUS, CAN_HEIGHT), color=(0.8, 0.1, 0.1))
        x, y, z = can_at
        can_pose = Transform((x, y, z + CAN_HEIGHT / 2))
        picture = Part(Picture((0.2, 0.2), pixels), collision=False)
        bodies += [
            Body("table_a", "table", Transform((1.2, 0 if not stand else 3, 0)), (top,)),
            Body("tag", "tag", Transform((1.0, 0.4, TABLE_HEIGHT + 0.001)), (picture,)),
            Body("can", "can", can_pose, (can,), False, CAN_MASS, can_friction),
        ]
    if stand:
        post = Part(Cylinder(0.03, 0.1), Transform((0, 0, -0.05)))
        bodies.append(Body("stand", "stand", Transform(can_at), (post,)))
    return Episode(
        "plain",
        0,
        tuple(bodies),
        Pose2D(0, 0, 0),
        (0.5, 0.5, 0.5),
        (SunLight((0.3, 0.2, -1), (1.2, 1.2, 1.2)),),
        (PointLight((2, 1, 2.4), (3, 3, 3)),),
        Site("plain"),
    )
