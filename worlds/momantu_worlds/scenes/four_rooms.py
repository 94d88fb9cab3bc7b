"""The world `four_rooms`: its site, and an episode for each seed."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from momantu_bt.world import Site
from momantu_worlds.scenes.bodies import Episode
from momantu_worlds.scenes.building import build
from momantu_worlds.scenes.sites import site_of
from momantu_worlds.scenes.variation import vary
from momantu_worlds.scenes.world_file import WorldFile, pose2d
from momantu_worlds.scenes.world_reader import read_world

FOLDER = Path(__file__).parent
WORLD_FILE = FOLDER / "four_rooms.yaml"
MAP_FILE = FOLDER / "four_rooms" / "map.yaml"
OVERHANG_FILE = FOLDER / "four_rooms" / "overhang.yaml"


@cache
def world_file() -> WorldFile:
    """The world as written down."""
    return read_world(WORLD_FILE)


def site() -> Site:
    """What the robot is told, with the start where the file has it; reads no map, no simulator."""
    world = world_file()
    return site_of(world, pose2d(world.start.at), MAP_FILE, OVERHANG_FILE)


def reset(seed: int) -> Episode:
    """The episode of a seed.

    Raises:
        WorldError: the world file is wrong, or leaves no room for the robot.
    """
    world = world_file()
    layout = vary(world, seed)
    return build(world, layout, site_of(world, layout.believed_start, MAP_FILE, OVERHANG_FILE))
