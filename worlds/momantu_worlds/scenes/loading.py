"""Worlds by name: their sites and their episodes; needs neither a simulator nor a map.

What reads and checks world files is imported when it is needed: a nominal site rarely is.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from momantu_bt.geometry import Pose2D
from momantu_bt.world import Site, WorldError
from momantu_worlds.scenes.sites import kept_site, save_site, site_of

if TYPE_CHECKING:
    from momantu_worlds.scenes.bodies import Episode
    from momantu_worlds.scenes.world_file import WorldFile

FOLDER = Path(__file__).parent


def world_path(name: str) -> Path:
    """Where the world file of a name lies."""
    return FOLDER / f"{name}.yaml"


def map_files(name: str) -> tuple[Path, Path]:
    """Where the map and the overhang layer of a world are kept."""
    return FOLDER / name / "map.yaml", FOLDER / name / "overhang.yaml"


@cache
def load_world(name: str) -> WorldFile:
    """The world as its file has it.

    Raises:
        WorldError: there is no such file, or it is wrong.
    """
    from momantu_worlds.scenes.world_reader import read_world

    return read_world(world_path(name))


def nominal_site(name: str) -> Site:
    """What the robot is told, with the start where the file has it; raises as `load_world`."""
    kept = _kept(name)
    return kept if kept is not None else site_from_file(name)


def site_from_file(name: str) -> Site:
    """As `nominal_site`, from the world file itself."""
    world = load_world(name)
    return site_of(world, Pose2D(*world.start.at), *map_files(name))


def draw_episode(name: str, seed: int) -> Episode:
    """The episode of a seed; the same in every process. Maps of a changed file are drawn anew.

    Raises:
        WorldError: the world file is missing or wrong, leaves no room for the robot, or was
            changed where maps cannot be written.
    """
    from momantu_worlds.scenes.building import build
    from momantu_worlds.scenes.variation import vary

    world = load_world(name)
    if _kept(name) is None:
        keep(name)
    layout = vary(world, seed)
    return build(world, layout, site_of(world, layout.believed_start, *map_files(name)))


def sketch(name: str, seed: int) -> Episode:
    """As `draw_episode`, for who needs no map: its site has none.

    Raises:
        WorldError: the world file is missing or wrong, or leaves no room for the robot.
    """
    from momantu_worlds.scenes.building import build
    from momantu_worlds.scenes.variation import vary

    world = load_world(name)
    layout = vary(world, seed)
    return build(world, layout, site_of(world, layout.believed_start, None, None))


def keep(name: str) -> None:
    """Draw a world's maps anew, and write its nominal site beside them.

    Raises:
        WorldError: as `load_world`, or nothing can be written there.
    """
    from momantu_worlds.scenes.floor_plan import draw_plans, save_plan

    plans = draw_plans(load_world(name))
    try:
        (FOLDER / name).mkdir(exist_ok=True)
        for plan, file in zip(plans, map_files(name), strict=True):
            save_plan(plan, file)
        save_site(site_from_file(name), world_path(name), _kept_path(name))
    except OSError as error:
        raise WorldError(
            f"{world_path(name)} was changed, but its maps cannot be drawn anew: {error}; make "
            f"{FOLDER / name} writable, or undo the change"
        ) from error


def _kept_path(name: str) -> Path:
    return FOLDER / name / "site.json"


def _kept(name: str) -> Site | None:
    """The nominal site from its short form; None unless made from the world file as it is."""
    return kept_site(name, world_path(name), _kept_path(name), map_files(name))
