"""Worlds by their files: their sites and their episodes; needs neither a simulator nor a map.

What reads and checks world files is imported when it is needed: a nominal site rarely is.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from momantu_bt.geometry import Pose2D
from momantu_bt.world import Site, WorldError
from momantu_worlds.scenes.site.nominal import Nominal, keep, kept_nominal, site_of

if TYPE_CHECKING:
    from momantu_worlds.scenes.file.world import WorldFile
    from momantu_worlds.scenes.geometry.bodies import Episode

FOLDER = Path(__file__).parent


def world_path(name: str) -> Path:
    """Where the world file of a bundled world lies."""
    return FOLDER / f"{name}.yaml"


def load_world(world: str | Path) -> WorldFile:
    """A bundled world by its name, or a world by its file.

    Raises:
        WorldError: there is no such file, or it is wrong.
    """
    from momantu_worlds.scenes.file.reader import world_text

    path = world_path(world) if isinstance(world, str) else world
    return _parsed(path, world_text(path))


@lru_cache(maxsize=16)
def _parsed(path: Path, text: str) -> WorldFile:
    from momantu_worlds.scenes.file.reader import parse_world

    return parse_world(text, path)


def nominal(path: Path) -> Nominal:
    """The site with the start where the file has it, and the robot; raises as `load_world`."""
    try:
        text = path.read_bytes()
    except OSError as error:
        raise WorldError(f"the world file {path} cannot be read: {error.strerror}") from error
    having = kept_nominal(text)
    if having is None:
        world = load_world(path)
        having = Nominal(nominal_site(world), world.robot)
        keep(having, text)
    return having


def nominal_site(world: WorldFile) -> Site:
    """The site with the start where the file has it, without maps."""
    return site_of(world, Pose2D(*world.start.at))


def draw_episode(world: str | Path, seed: int) -> Episode:
    """The episode of a seed, its site without maps; the same in every process.

    Raises:
        WorldError: the world file is missing or wrong, or leaves no room for the robot.
    """
    from momantu_worlds.scenes.arrange.episode import build
    from momantu_worlds.scenes.arrange.variation import vary

    loaded = load_world(world)
    layout = vary(loaded, seed)
    return build(loaded, layout, site_of(loaded, layout.believed_start))
