"""World files by path or bundled name: their nominal sites, and the episodes of their seeds.

It needs neither a simulator nor a map. A nominal site is usually cached, so the modules that read
world files are loaded when they are first used.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from momantu_bt.geometry import Pose2D
from momantu_bt.lazy import lazily
from momantu_bt.world import Site
from momantu_worlds.scenes.site.cache import Nominal, cached_nominal, store_nominal

with lazily():
    from momantu_worlds.scenes.arrange import episode as episodes
    from momantu_worlds.scenes.arrange import variation
    from momantu_worlds.scenes.file import reader
    from momantu_worlds.scenes.site import site as sites

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
        WorldFileError: the file cannot be read, or it is wrong.
    """
    path = world_path(world) if isinstance(world, str) else world
    return _parsed(path, reader.world_text(path))


@lru_cache(maxsize=16)
def _parsed(path: Path, text: str) -> WorldFile:
    return reader.parse_world(text, path)


def nominal(path: Path) -> Nominal:
    """The site with the start where the file has it, and the robot; raises as `load_world`."""
    try:
        text = path.read_bytes()
    except OSError:
        text = b""  # nothing is cached for it, and `load_world` says why it cannot be read
    found = cached_nominal(text)
    if found is None:
        world = load_world(path)
        found = Nominal(nominal_site(world), world.robot)
        if world.site.tags_file is None:  # that file may change while this one does not
            store_nominal(found, text)
    return found


def nominal_site(world: WorldFile) -> Site:
    """The site with the start where the file has it, without maps."""
    return sites.site_of(world, Pose2D(*world.start.at))


def draw_episode(world: str | Path, seed: int) -> Episode:
    """The episode of a seed, its site without maps; the same in every process.

    Raises:
        WorldFileError: the file cannot be read, or it is wrong.
        WorldError: it leaves no room for the robot.
    """
    loaded = load_world(world)
    layout = variation.vary(loaded, seed)
    return episodes.build(loaded, layout, sites.site_of(loaded, layout.believed_start))
