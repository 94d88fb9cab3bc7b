"""person.reaches_over: somebody beside the item's table holds an arm over it for a while."""

from __future__ import annotations

import math

from momantu_bt.fault import Fault, FaultError
from momantu_bt.geometry import Pose2D, Transform, quaternion_from_axis_angle
from momantu_worlds.people.walker import Walker
from momantu_worlds.sapien.faults.figures import Person, has_room
from momantu_worlds.sapien.faults.stage import Stage
from momantu_worlds.sapien.faults.tops import TableTop, item_top, obstacles
from momantu_worlds.scenes.catalogue.person import CATEGORY, CLOTHES
from momantu_worlds.scenes.geometry.bodies import Actor, Body, Cylinder, Part
from momantu_worlds.scenes.geometry.prisms import Prism, body_prism
from momantu_worlds.scenes.geometry.support import UprightCylinder

SHOULDER, CHEST = 1.4, 0.15
"""Where the arm begins: above the floor, and before the middle of the figure, m."""
LONGEST, STEP = 1.0, 0.05
"""Largest distance of somebody from what they reach for, and step of the search for room, m."""
SHORT_OF = 0.12
"""Where the hand is, m before the item, as if it were about to take it."""
HIGH = 0.6
"""Height of the hand, relative to the item's."""
THICK = 0.045
"""Radius of the arm, m."""
CLEAR = 0.01
"""Least gap between the arm and things, m."""
ASIDE, DRAWS_BACK = 0.4, 0.2
"""Least gap to the robot at first, and that at which the arm is drawn back, m."""
ROUND = 24
"""Directions around the item from which somebody may reach."""


class PersonReaches(Person):
    """Somebody who draws the arm back for good when the robot comes near it."""

    def __init__(self, stage: Stage, fault: Fault) -> None:
        super().__init__(stage, fault)
        self._item = UprightCylinder(stage.item)
        self._arm: str | None = None
        self._room: Prism

    def begin(self) -> None:
        """Let somebody come and reach; FaultError while there is no room for it."""
        super().begin()
        self._stage.simulator.before_tick.append(self._watch)

    def end(self) -> None:
        """Remove the figure and its arm."""
        if self._admitted is not None:
            self._stage.simulator.before_tick.remove(self._watch)
        self._draw_back()
        super().end()

    def _walker(self) -> Walker:
        top = item_top(self._stage)
        others = obstacles(self._stage, top, self._stage.goal.item)
        for away, walker in sorted(self._walkers(), key=lambda found: found[0]):
            arm = self._reaching(walker, away, top)
            room = body_prism(arm, arm.map_from_body)
            assert room is not None
            if (
                room.clear_of(others, CLEAR)
                and room.clear_of(self._stage.robot_prisms(), ASIDE)
                and has_room(self._stage, walker, ASIDE)
            ):
                self._room, self._arm = room, self._stage.add(arm)
                return walker
        raise FaultError(f"{self._fault.name}: there is no room for a person beside {top.name}")

    def _walkers(self) -> list[tuple[float, Walker]]:
        """Who could reach for the item, and how far from it each of them stands, m."""
        x, y, _ = (float(v) for v in self._stage.item_pose().position)
        floor, found = self._stage.crowd.floor, []
        for k in range(ROUND):
            turn = 2.0 * math.pi * k / ROUND
            for step in range(1, round(LONGEST / STEP) + 1):
                away = step * STEP
                at = (x + away * math.cos(turn), y + away * math.sin(turn))
                if floor.free(at):
                    found.append((away, self._standing(Pose2D(*at, turn + math.pi))))
                    break
        return found

    def _standing(self, pose: Pose2D) -> Walker:
        actor = Actor(self._stage.free_name("person"), (), (0.8, 0.8), (0.0, 0.0))
        draw = self._stage.random(self._fault)
        walker = Walker(actor, self._stage.crowd.floor, (pose.x, pose.y), draw)
        walker.pose = pose
        return walker

    def _reaching(self, walker: Walker, away: float, top: TableTop) -> Body:
        """The arm of somebody who stands `away` m before the item."""
        ahead = away - self._item.radius - SHORT_OF
        low = float(top.map_from_top.position[2]) + HIGH * self._item.height
        along, up = ahead - CHEST, low - SHOULDER
        turn = quaternion_from_axis_angle((0.0, 1.0, 0.0), math.atan2(along, up))
        middle = Transform((CHEST + along / 2, 0.0, SHOULDER + up / 2), turn)
        part = Part(Cylinder(THICK, math.hypot(along, up)), middle, CLOTHES)
        return Body("arm_of_person", CATEGORY, walker.pose.transform(), (part,))

    def _watch(self) -> None:
        if self._arm is not None and not self._room.clear_of(
            self._stage.robot_prisms(), DRAWS_BACK
        ):
            self._draw_back()

    def _draw_back(self) -> None:
        if self._arm is not None:
            self._stage.remove(self._arm)
            self._arm = None
