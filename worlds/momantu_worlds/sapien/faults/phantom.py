"""camera.phantom: cameras show a copy of the item on the same top, where there is nothing."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D, Transform
from momantu_worlds.sapien.faults.pictures import PictureCount, cameras, frames
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import TableTop, item_top, obstacles, things_on
from momantu_worlds.scenes.arrange.spots import Disc, lane, outline_points, seen_share
from momantu_worlds.scenes.arrange.tabletop import ITEM_SEEN
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.support import UprightCylinder

APART = 0.15
"""Least distance to the item, m."""
ASIDE = 0.03
"""Least gap to everything, m, so that the copy is seen as one object."""
TRIES = 400
"""Draws of a place before the fault fails."""


class Phantom:
    """Shows a visual shape without a collision shape; videos show it too."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """Parameters: frames, the number of pictures of the place that show it."""
        cameras(stage, fault)
        self._stage, self._fault, self._frames = stage, fault, frames(fault)
        self._item = stage.item
        self._count: PictureCount | None = None

    def begin(self) -> None:
        """Show the copy; FaultError if the item stands on no top, or on one without room."""
        top = item_top(self._stage)
        pose = self._place(top)
        parts = tuple(dataclasses.replace(p, collision=False) for p in self._item.parts)
        at = self._item.with_foot_at(pose)
        self._shown = self._stage.add(Body("phantom", "phantom", at, parts))
        middle = pose.apply(np.array([0.0, 0.0, UprightCylinder(self._item).height / 2]))
        self._count = PictureCount(self._stage, self._frames, lambda: middle, self.end)

    def end(self) -> None:
        """Hide the copy; this happens by itself after the given number of pictures."""
        if self._count is not None:
            self._count.stop()
            self._count = None
            self._stage.remove(self._shown)

    def _place(self, top: TableTop) -> Transform:
        """A seeded free place on the top, visible from before it and in reach of the hand."""
        item, draw = UprightCylinder(self._item), self._stage.random(self._fault)
        here = top.map_from_top.inverse().apply(self._stage.item_pose().position)
        things, others = things_on(self._stage, top), obstacles(self._stage, top)
        half = np.array(top.size) / 2
        for _ in range(TRIES):
            x, y = draw.uniform(-half, half).tolist()
            at = Pose2D(x, y, float(draw.uniform(-math.pi, math.pi)))
            pose, spot = top.map_from_top @ at.transform(), Disc(x, y, item.radius, item.height)
            prism = self._stage.item_prism(pose)
            if (
                math.hypot(x - here[0], y - here[1]) >= APART
                and top.holds(prism)
                and prism.clear_of(others, ASIDE)
                and lane(spot, things, top.side)
                and seen_share(outline_points(spot), things, top.placed, top.side, spot)
                >= ITEM_SEEN
            ):
                return pose
        raise FaultError(f"{self._fault.name}: there is no room for a look-alike on {top.name}")
