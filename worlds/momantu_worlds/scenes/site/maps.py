"""The maps of a robot in a world: drawn once for its laser and its height."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from shutil import rmtree

from momantu_bt.formats.cache import cache_subfolder
from momantu_bt.formats.maps import write_map
from momantu_bt.world import Site, WorldError
from momantu_worlds.scenes.file.world import WorldFile
from momantu_worlds.scenes.site.cache import cache_key
from momantu_worlds.scenes.site.floor_plan import draw_plans

MOST_CACHED = 16
"""Maps of one world: for several robots, and for recent versions of its file."""


def with_maps(site: Site, world: WorldFile, band: tuple[float, float], robot_height: float) -> Site:
    """The site with the world file's own map, or with maps drawn from the file.

    band: heights that the robot's laser sees, m. robot_height: of the robot, m.

    Raises:
        WorldError: no map can be drawn or written, or the file's own is not there.
    """
    if world.site.map is not None:
        return replace(site, map_file=world.beside(world.site.map))
    try:
        plan, overhang = _drawn(world, band, robot_height)
    except OSError as error:
        raise WorldError(f"the map of {world.name!r} cannot be written: {error}") from error
    return replace(site, map_file=plan, overhang_file=overhang)


def _drawn(world: WorldFile, band: tuple[float, float], robot_height: float) -> tuple[Path, Path]:
    made_of = cache_key([repr((band, robot_height)), *_contents(world)])
    folder = cache_subfolder("maps") / f"{world.name}-{made_of}"
    files = folder / "map.yaml", folder / "overhang.yaml"
    if not all(file.is_file() for file in files):
        folder.mkdir(exist_ok=True)
        for plan, file in zip(draw_plans(world, band, robot_height), files, strict=True):
            write_map(file, plan)
        _evict(folder)
    return files


def _evict(newest: Path) -> None:
    """Remove the oldest maps of a world whose file was changed again and again."""
    name = newest.name.rpartition("-")[0]
    others = [f for f in newest.parent.glob(f"{name}-*") if f.name.rpartition("-")[0] == name]
    with suppress(OSError):  # another process forgets, too
        for old in sorted(others, key=lambda f: f.stat().st_mtime)[:-MOST_CACHED]:
            rmtree(old, ignore_errors=True)


def _contents(world: WorldFile) -> Iterator[str]:
    """Everything that the plan depends on: the world file's values and its mesh files."""
    yield world.model_dump_json()
    for file in world.mesh_files():
        yield hashlib.blake2b(file.read_bytes()).hexdigest()
