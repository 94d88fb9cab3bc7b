"""place.occupied: boxes stand on the free spots around the marker."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D
from momantu_worlds.sapien.faults.box_row import HEIGHT, SIZE, BoxRow
from momantu_worlds.sapien.faults.parameters import only, whole
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tag import marker_picture
from momantu_worlds.sapien.faults.tops import TableTop, obstacles, table_top, things_on
from momantu_worlds.scenes.arrange.spots import SetDown, free_spots
from momantu_worlds.scenes.geometry.bodies import Body
from momantu_worlds.scenes.geometry.parts import block
from momantu_worlds.scenes.geometry.plane import Rectangle
from momantu_worlds.scenes.geometry.prisms import body_prism
from momantu_worlds.scenes.geometry.support import UprightCylinder

MOST_FREE = 4
APART = 0.25
"""Least distance between two spots that stay free, m."""
FROM_ROBOT = 0.02
"""Least gap of a box to the robot and to everything else, m."""
MASS = 0.2
"""Mass of a box, kg."""
COLOR = (0.74, 0.60, 0.42)


class Occupied:
    """Loose boxes, which the robot must not push either; they are removed at the end."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        """Parameters: free, the number of spots elsewhere on the top that stay free."""
        only(fault, "free")
        self._picture = marker_picture(stage)
        self._free = whole(fault, "free", 0, MOST_FREE)
        self._stage, self._fault = stage, fault
        self._item = UprightCylinder(stage.item)
        self._boxes: list[str] = []

    def begin(self) -> None:
        """Add the boxes.

        Raises:
            FaultError: fewer spots are free already than should stay free.
        """
        stage, goal = self._stage, self._stage.goal
        top = table_top(stage, goal.support)
        wanted = SetDown(self._item.radius, self._item.height, goal.max_distance, top.side)
        top_from_marker = top.map_from_top.inverse() @ stage.simulator.truth.pose(stage.marker.name)
        row = BoxRow(
            wanted,
            top.placed,
            things_on(stage, top, *([goal.item] if stage.held() else [])),
            Rectangle(Pose2D.from_transform(top_from_marker), self._picture.size),
        )
        row.keep(self._kept(row, top))
        for x, y in row.boxes(lambda x, y: self._room_for_box(top, x, y)):
            self._boxes.append(stage.add(self._box(top, x, y)))

    def end(self) -> None:
        """Remove the boxes."""
        for name in self._boxes:
            self._stage.remove(name)
        self._boxes.clear()

    def _kept(self, row: BoxRow, top: TableTop) -> list[tuple[float, float]]:
        """Spots that stay free: those with the most room around them, apart from each other."""
        spots = free_spots(row.wanted, top.placed, row.things, row.marker.pose)
        spots.sort(key=row.room, reverse=True)
        kept: list[tuple[float, float]] = []
        for spot in spots:
            if len(kept) < self._free and all(math.dist(spot, other) >= APART for other in kept):
                kept.append(spot)
        if len(kept) < self._free:
            raise FaultError(
                f"{self._fault.name}: only {len(kept)} spots are free on {top.name}, "
                f"so {self._free} cannot stay free"
            )
        return kept

    def _box(self, top: TableTop, x: float, y: float) -> Body:
        parts = (block((SIZE, SIZE, HEIGHT), (0, 0, HEIGHT / 2), COLOR),)
        pose = top.map_from_top @ Pose2D(x, y).transform()
        return Body("occupying_box", "box", pose, parts, static=False, mass=MASS)

    def _room_for_box(self, top: TableTop, x: float, y: float) -> bool:
        body = self._box(top, x, y)
        prism = body_prism(body, body.map_from_body)
        assert prism is not None
        return (
            top.holds(prism)
            and prism.clear_of(obstacles(self._stage, top), 0.0)
            and all(prism.clear_of([other], FROM_ROBOT) for other in self._stage.robot_prisms())
        )
