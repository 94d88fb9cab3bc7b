"""Whether the robot can stand where it starts, and get to what matters."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from momantu_bt.geometry import Array
from momantu_worlds.checking.overlaps import TOUCHING
from momantu_worlds.checking.remarks import Remark
from momantu_worlds.checking.scenario import UNKNOWN, Scenario

DOOR = 0.1
"""m around a doorway's middle in which its widest spot is looked for: no farther than walls are
thick, or the room behind would count."""


def start(scenario: Scenario) -> Iterator[Remark]:
    """The base as it stands at first overlaps nothing."""
    pose = scenario.episode.start
    base = scenario.robot.outline(pose)
    worst: dict[str, float] = {}
    for each in scenario.obstacles:
        worst[each.body] = max(worst.get(each.body, 0.0), each.depth(base))
    for body, depth in worst.items():
        if depth > TOUCHING:
            yield Remark(
                severity="error",
                code="start-in-collision",
                place=("start", "at"),
                about=(body,),
                message=f"the robot starts {100 * depth:.0f} cm inside {body}",
                cure="give it a start in free floor, or a smaller `start.shift`",
                amount=depth,
            )


def places(scenario: Scenario) -> Iterator[Remark]:
    """The middle of the base can be at every place; what an episode adds is not looked at."""
    ground, robot = scenario.known_ground, scenario.robot
    begin = scenario.episode.start
    reached = ground.reached((begin.x, begin.y), robot.half_width)
    for name, pose in scenario.episode.site.places.items():
        at = (pose.x, pose.y)
        room = ground.room_at(at)
        if room < robot.half_width - ground.cell:
            near = ground.blocking(at, lambda body: body.startswith(UNKNOWN))
            beside = f"{100 * room:.0f} cm beside {near}" if room > 0 else f"in {near or 'nothing'}"
            yield Remark(
                severity="error",
                code="place-blocked",
                place=("site", "places", name),
                about=(name,),
                message=(
                    f"the place {name} is {beside}; {robot.name} needs "
                    f"{100 * robot.half_width:.0f} cm around its middle"
                ),
                cure="move the place, or what stands there",
                amount=-room,
            )
        elif not ground.at(reached, at):
            yield Remark(
                severity="error",
                code="place-unreachable",
                place=("site", "places", name),
                about=(name,),
                message=f"{robot.name} cannot get from its start to the place {name}",
                cure=_way(scenario),
            )


def doorways(scenario: Scenario) -> Iterator[Remark]:
    """Walls leave room for the robot in every doorway, and nothing stands in it."""
    width = 2 * scenario.robot.half_width
    for name, gap in scenario.episode.doorways.items():
        walls, free = scenario.walls, scenario.ground
        between = 2 * walls.room_at(gap.at, DOOR)
        left = 2 * free.room_at(gap.at, DOOR)
        if between < width - free.cell:
            yield Remark(
                severity="error",
                code="door-narrow",
                place=scenario.place(name),
                about=(name,),
                message=(
                    f"the door {name} leaves {100 * between:.0f} cm; {scenario.robot.name} is "
                    f"{100 * width:.0f} cm wide"
                ),
                cure=f"make it at least {100 * width + 10:.0f} cm wide",
                amount=width - between,
            )
        elif left < width - free.cell:
            near = free.blocking(gap.at, scenario.is_wall)
            yield Remark(
                severity="error",
                code="door-blocked",
                place=scenario.place(name),
                about=(name, near),
                message=f"{near} leaves {100 * left:.0f} cm of the door {name}",
                cure=f"move {near} away from the door",
                amount=width - left,
            )


def surfaces(scenario: Scenario) -> Iterator[Remark]:
    """The robot gets before each surface, and its hand to what stands on it."""
    robot = scenario.robot
    for name, (map_from_top, size) in scenario.surfaces.items():
        place, height = scenario.place(name), float(map_from_top.position[2])
        if not robot.works_at(height):
            yield Remark(
                severity="error",
                code="surface-height",
                place=place,
                about=(name,),
                message=f"{name} is {height:.2f} m high; {robot.name}'s hand does not get there",
                cure=f"make it {_heights(scenario)} high, or choose another robot",
                amount=abs(height),
            )
        stands = scenario.stands_near(map_from_top.position, math.hypot(*size) / 2 + robot.reach[2])
        own = map_from_top.inverse().apply(np.column_stack([stands, np.full(len(stands), height)]))[
            :, :2
        ]
        sides = scenario.episode.site.surfaces[name].sides
        good = [side for side in sides if _before(own, size, side, robot.reach[2])]
        if not good:
            yield Remark(
                severity="error",
                code="surface-unreachable",
                place=place,
                about=(name,),
                message=f"{robot.name} cannot get from its start to any side of {name}",
                cure=_way(scenario),
            )


def _before(own: Array, size: tuple[float, float], side: float, reach: float) -> bool:
    """Whether one of the points (n, 2), in the top's frame, lies before a side, within reach."""
    cos, sin = math.cos(side), math.sin(side)
    half = size[0] / 2 if abs(cos) > abs(sin) else size[1] / 2
    width = size[1] / 2 if abs(cos) > abs(sin) else size[0] / 2
    out, along = own @ (cos, sin) - half, own @ (-sin, cos)
    return bool(((out > 0) & (out <= reach) & (np.abs(along) <= width)).any())


def _heights(scenario: Scenario) -> str:
    """The heights of surfaces at which the robot works, in words."""
    good = [h / 20 for h in range(41) if scenario.robot.works_at(h / 20)]
    return f"{good[0]:.2f} to {good[-1]:.2f} m" if good else "as high as its hand reaches"


def _way(scenario: Scenario) -> str:
    wide = 2 * scenario.robot.half_width
    return f"leave a way of at least {100 * wide + 10:.0f} cm everywhere between them"
