"""Worlds and robots as a command line names them."""

from __future__ import annotations

from momantu_bt.plugins import ROBOTS, WORLDS, load
from momantu_bt.robot import RobotDescription
from momantu_bt.world import WorldEntry


def world_of(name: str) -> WorldEntry:
    """The world of a name; PluginError with the nearest names when there is no such world."""
    entry: WorldEntry = load(WORLDS, name)
    return entry


def robot_of(name: str) -> RobotDescription:
    """The robot of a name; PluginError with the nearest names when there is no such robot."""
    description: RobotDescription = load(ROBOTS, name)()
    return description
