"""Worlds by name: their sites and their episodes; needs neither a simulator nor a map."""

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


@cache
def load_world(name: str) -> WorldFile:
    """The world as `NAME.yaml` in this folder has it.

    Raises:
        WorldError: there is no such file, or it is wrong.
    """
    return read_world(FOLDER / f"{name}.yaml")


def map_files(name: str) -> tuple[Path, Path]:
    """Where the map and the overhang layer of a world are kept."""
    return FOLDER / name / "map.yaml", FOLDER / name / "overhang.yaml"


def nominal_site(name: str) -> Site:
    """What the robot is told, with the start where the file has it; raises as `load_world`."""
    world = load_world(name)
    return site_of(world, pose2d(world.start.at), *map_files(name))


def draw_episode(name: str, seed: int) -> Episode:
    """The episode of a seed; the same in every process.

    Raises:
        WorldError: the world file is missing or wrong, or leaves no room for the robot.
    """
    world = load_world(name)
    layout = vary(world, seed)
    return build(world, layout, site_of(world, layout.believed_start, *map_files(name)))
