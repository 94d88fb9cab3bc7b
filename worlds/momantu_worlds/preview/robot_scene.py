"""The scene of `robots preview`: a robot before a table with a can on it."""

from __future__ import annotations

from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.robot import RobotDescription
from momantu_bt.world import Site
from momantu_worlds.scenes.geometry.bodies import Body, Box, Cylinder, Episode, Part, SunLight

FLOOR = (8.0, 8.0)
"""m; more than is in any picture."""
TABLE = (0.6, 1.1, 0.7)
"""m; depth, width and height."""
CAN = (0.033, 0.12)
"""m; radius and height."""
BESIDE = 0.12
"""m from the table's edge to the can's middle."""
TILE = 0.5
"""m; edges of the floor's squares, to judge sizes by."""
LIGHT, DARK = (0.82, 0.82, 0.80), (0.70, 0.70, 0.69)
WOOD = (0.72, 0.60, 0.45)
RED = (0.75, 0.15, 0.12)
AMBIENT = (0.55, 0.55, 0.55)
SUNS = (
    SunLight((-0.5, 0.35, -1.0), (0.7, 0.7, 0.68)),
    SunLight((0.6, -0.3, -0.4), (0.25, 0.25, 0.28)),
)
"""From before and above, and a little from behind, so that no face is black."""


def robot_episode(description: RobotDescription) -> Episode:
    """The robot at the origin, looking at a table as far off as it stands to look."""
    edge = description.working.look_off
    return Episode(
        name="preview",
        seed=0,
        bodies=(_floor(), *_table(edge)),
        start=Pose2D(0.0, 0.0, 0.0),
        ambient=AMBIENT,
        suns=SUNS,
        lamps=(),
        site=Site("preview"),
    )


def _floor() -> Body:
    """A board of squares; one slab beneath them carries."""
    half = (round(FLOOR[0] / TILE / 2), round(FLOOR[1] / TILE / 2))
    slab = Part(Box((*FLOOR, 0.1)), Transform((0.0, 0.0, -0.06)), LIGHT)
    tiles = tuple(
        Part(
            Box((TILE, TILE, 0.01)),
            Transform(((i + 0.5) * TILE, (j + 0.5) * TILE, -0.005)),
            LIGHT if (i + j) % 2 else DARK,
        )
        for i in range(-half[0], half[0])
        for j in range(-half[1], half[1])
    )
    return Body("floor", "floor", Transform(), (slab, *tiles))


def _table(edge: float) -> tuple[Body, Body]:
    depth, width, height = TABLE
    middle = edge + depth / 2
    top = Part(Box((depth, width, 0.04)), Transform((0.0, 0.0, height - 0.02)), WOOD)
    legs = tuple(
        Part(
            Box((0.05, 0.05, height - 0.04)),
            Transform((x * (depth / 2 - 0.05), y * (width / 2 - 0.05), (height - 0.04) / 2)),
            WOOD,
        )
        for x in (-1, 1)
        for y in (-1, 1)
    )
    table = Body("table", "table", Transform((middle, 0.0, 0.0)), (top, *legs))
    radius, tall = CAN
    place = Transform((edge + BESIDE, 0.0, height + tall / 2))
    can = Body("can", "can", place, (Part(Cylinder(radius, tall), color=RED),))
    return table, can
