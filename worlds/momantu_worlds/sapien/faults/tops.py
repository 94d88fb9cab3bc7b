"""Table tops in their current state: the objects on them, and free space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from momantu_bt.fault import FaultError
from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.scenes.arrange.layout import PlacedTable
from momantu_worlds.scenes.arrange.spots import Disc
from momantu_worlds.scenes.geometry.bodies import Body, BodyTop, Cylinder
from momantu_worlds.scenes.geometry.prisms import Prism, body_points, prism_around
from momantu_worlds.scenes.geometry.support import SupportTop

TABLES = ("table", "desk")
"""Categories of bodies with a top, whether or not they are surfaces of the site."""
STANDING = 0.03
"""Largest height difference to a top at which an object stands on it, m."""
RIM = 0.02
"""Least distance of an added body to the edge of a top, m."""
UPRIGHT = math.cos(0.1)


@dataclass(frozen=True, slots=True)
class TableTop:
    """One top, where its body stands now. name: of its body.

    side: direction from which it is preferably approached, in its own frame, rad.
    """

    name: str
    map_from_top: Transform
    top: BodyTop
    side: float

    @property
    def size(self) -> tuple[float, float]:
        """Its extent along its own x and y, m."""
        return self.top.size

    @property
    def placed(self) -> PlacedTable:
        """The same as a layout's type."""
        height = float(self.map_from_top.position[2])
        pose = Pose2D.from_transform(self.map_from_top)
        return PlacedTable(pose, height, self.size, round=self.top.round)

    def within(self, x: float, y: float) -> bool:
        """Whether a point in its frame is above the top."""
        return self.top.margin(x, y) >= 0.0

    def holds(self, prism: Prism) -> bool:
        """Whether a whole prism is above the top, RIM inside its edges."""
        corners = np.column_stack([prism.base.corners(), np.zeros(4)])
        own = self.map_from_top.inverse().apply(corners)[:, :2]
        return all(self.top.margin(float(x), float(y)) >= RIM for x, y in own)


def table_top(stage: Stage, name: str) -> TableTop:
    """The top of a body, at its true pose."""
    top = SupportTop(stage.episode.body(name))
    surface = stage.episode.site.surfaces.get(name)
    side = surface.sides[0] if surface is not None and surface.sides else 0.0
    return TableTop(name, top.surface(stage.simulator.truth.pose(name)), top.top, side)


def item_top(stage: Stage) -> TableTop:
    """The top that the item stands or lies on.

    Raises:
        FaultError: it is on none now, or between the fingers.
    """
    item = stage.goal.item
    if stage.in_hand():
        raise FaultError(f"{item} is between the fingers now, so nothing else happens to it")
    foot = stage.item_prism().bottom
    for body in stage.episode.bodies:
        if body.category in TABLES or body.name in stage.episode.site.surfaces:
            top = table_top(stage, body.name)
            x, y, _ = top.map_from_top.inverse().apply(stage.item_pose().position)
            if (
                top.within(float(x), float(y))
                and abs(foot - float(top.map_from_top.position[2])) <= STANDING
            ):
                return top
    raise FaultError(f"{item} stands on no table now")


def things_on(stage: Stage, top: TableTop, *without: str) -> list[Disc]:
    """Upright cylinders around the loose objects on a top, in its frame; some bodies left out."""
    discs = []
    for body in stage.bodies:
        points = body_points(body)
        if body.static or points is None or body.name in without:
            continue
        top_from_body = top.map_from_top.inverse() @ stage.simulator.truth.pose(body.name)
        prism = prism_around(top_from_body.apply(points), top_from_body.yaw)
        at = prism.base.pose
        if top.within(at.x, at.y) and abs(prism.bottom) <= STANDING:
            reach = _reach(body, top_from_body, math.hypot(*prism.base.size) / 2)
            discs.append(Disc(at.x, at.y, reach, prism.top))
    return discs


def obstacles(stage: Stage, top: TableTop, *without: str) -> list[Prism]:
    """What a thing on a top must not meet: the robot, and parts of all bodies, some left out."""
    return [*stage.part_prisms(top.name, *without), *stage.robot_prisms()]


def _reach(body: Body, top_from_body: Transform, most: float) -> float:
    """Radius of the disc around a body: of its cylinder if it stands upright, else `most`."""
    colliding = [part.geometry for part in body.parts if part.collision]
    upright = float(top_from_body.rotation[2, 2]) > UPRIGHT
    if upright and len(colliding) == 1 and isinstance(colliding[0], Cylinder):
        return colliding[0].radius
    return most
