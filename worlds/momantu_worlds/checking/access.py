"""Checks of access: whether the robot can stand where it starts, and get to its goals."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from momantu_bt.findings import FindingAtKeys
from momantu_bt.formats.problems import Severity
from momantu_bt.geometry import Array
from momantu_worlds.checking.overlaps import TOUCHING
from momantu_worlds.checking.scenario import UNKNOWN, Scenario

DOOR = 0.1
"""Search radius around a doorway's centre for its widest point, m. It is at most the thickness of
walls, so that the room behind is not included."""


def start(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that the base overlaps nothing at the start pose."""
    pose = scenario.episode.start
    base = scenario.robot.outline(pose)
    worst: dict[str, float] = {}
    for each in scenario.obstacles:
        worst[each.body] = max(worst.get(each.body, 0.0), each.depth(base))
    for body, depth in worst.items():
        if depth > TOUCHING:
            yield FindingAtKeys(
                Severity.ERROR,
                "start-in-collision",
                f"the robot starts {100 * depth:.0f} cm inside {body}",
                "give it a start in free floor, or a smaller `start.shift`",
                ("start", "at"),
                about=(body,),
                amount=depth,
            )


def places(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that the robot can stand at every place; furniture that an episode adds is ignored."""
    ground, robot = scenario.known_ground, scenario.robot
    begin = scenario.episode.start
    reached = ground.reached((begin.x, begin.y), robot.half_width)
    for name, pose in scenario.episode.site.places.items():
        at = (pose.x, pose.y)
        room = ground.room_at(at)
        if room < robot.half_width - ground.cell:
            near = ground.blocking(at, lambda body: body.startswith(UNKNOWN))
            beside = f"{100 * room:.0f} cm beside {near}" if room > 0 else f"in {near}"
            if not near:
                beside = "beyond the floor"
            yield FindingAtKeys(
                Severity.ERROR,
                "place-blocked",
                f"the place {name} is {beside}; {robot.name} needs "
                f"{100 * robot.half_width:.0f} cm around its middle",
                "move the place, or what stands there",
                ("site", "places", name),
                about=(name,),
                amount=-room,
            )
        elif not ground.at(reached, at):
            yield FindingAtKeys(
                Severity.ERROR,
                "place-unreachable",
                f"{robot.name} cannot get from its start to the place {name}",
                _way(scenario),
                ("site", "places", name),
                about=(name,),
            )


def doorways(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that every doorway is wide enough for the robot and that nothing stands in it."""
    width = 2 * scenario.robot.half_width
    for name, gap in scenario.episode.doorways.items():
        walls, free = scenario.walls, scenario.ground
        between = 2 * walls.room_at(gap.at, DOOR)
        left = 2 * free.room_at(gap.at, DOOR)
        if between < width - free.cell:
            yield FindingAtKeys(
                Severity.ERROR,
                "door-narrow",
                f"the door {name} leaves {100 * between:.0f} cm; {scenario.robot.name} is "
                f"{100 * width:.0f} cm wide",
                f"make it at least {100 * width + 10:.0f} cm wide",
                scenario.place(name),
                about=(name,),
                amount=width - between,
            )
        elif left < width - free.cell:
            near = free.blocking(gap.at, scenario.is_wall)
            yield FindingAtKeys(
                Severity.ERROR,
                "door-blocked",
                f"{near} leaves {100 * left:.0f} cm of the door {name}",
                f"move {near} away from the door",
                scenario.place(name),
                about=(name, near),
                amount=width - left,
            )


def surfaces(scenario: Scenario) -> Iterator[FindingAtKeys]:
    """Check that the robot can drive up to each surface and that its hand reaches objects on it."""
    robot = scenario.robot
    for name, (map_from_top, size) in scenario.surfaces.items():
        place, height = scenario.place(name), float(map_from_top.position[2])
        if not robot.works_at(height):
            yield FindingAtKeys(
                Severity.ERROR,
                "surface-height",
                f"{name} is {height:.2f} m high; {robot.name}'s hand cannot reach that height",
                f"make it {_heights(scenario)} high, or choose another robot",
                place,
                about=(name,),
                amount=abs(height),
            )
        stands = scenario.stands_near(map_from_top.position, math.hypot(*size) / 2 + robot.reach[2])
        own = map_from_top.inverse().apply(np.column_stack([stands, np.full(len(stands), height)]))[
            :, :2
        ]
        sides = scenario.episode.site.surfaces[name].sides
        good = [side for side in sides if _before(own, size, side, robot.reach[2])]
        if not good:
            yield FindingAtKeys(
                Severity.ERROR,
                "surface-unreachable",
                f"{robot.name} cannot get from its start to any side of {name}",
                _way(scenario),
                place,
                about=(name,),
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
    return f"leave a passage of at least {100 * wide + 10:.0f} cm between them"
