"""What a run is told of its surroundings in the place of what its world tells: a map, names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from momantu_bt.errors import InputError
from momantu_bt.formats.map_folder import MAP, NAMES, OVERHANG, map_file
from momantu_bt.formats.maps import FREE, picture_file, read_map
from momantu_bt.geometry import Pose2D
from momantu_bt.robot import RobotDescription
from momantu_bt.site_file import Names, read_names
from momantu_bt.tree.registry import Registry
from momantu_bt.world import MappedWorld, Site, World, WorldEntry

NO_MAP = "none"
"""`--map none`: the robot is told no floor plan, and drives by odometry and what it sees."""


@dataclass(frozen=True, slots=True)
class Told:
    """What replaces a site's own. map_file: the floor plan; None: there is none.

    overhang_file: what the laser's plane misses, on the same map. area: of the map, m. names: of
    places and surfaces; None: the site's own, if there is a map.
    """

    map_file: Path | None
    overhang_file: Path | None = None
    area: tuple[float, float, float, float] | None = None
    names: Names | None = None
    charted: bool = True

    def of(self, site: Site) -> Site:
        """The site, told so.

        Without a map its poses mean nothing: the map's frame is odometry's then. The robot starts
        at its origin, or where the names say; of the rest only what has no place is kept.
        """
        if self.map_file is not None:
            site = replace(
                site,
                map_file=self.map_file,
                overhang_file=self.overhang_file,
                area=self.area,
            )
        elif not self.charted:
            origin = Pose2D(0.0, 0.0, 0.0)
            site = replace(site.uncharted(), start=origin, start_sigma=(0.0, 0.0))
        return site if self.names is None else self._named(site, self.names)

    def _named(self, site: Site, names: Names) -> Site:
        named = replace(
            site.nowhere(),
            places=MappingProxyType({n: Pose2D(*pose) for n, pose in names.places.items()}),
            surfaces=MappingProxyType({n: s.surface() for n, s in names.surfaces.items()}),
            zones=MappingProxyType({n: z.zone for n, z in names.zones.items()}),
        )
        return replace(named, start=Pose2D(*names.start))


def read_told(map: str | None, names: str | None) -> Told | None:
    """What `--map` and `--names` say; None if they say nothing.

    map: a folder, a map_server YAML file, or `none`. names: a site file, or a map's folder.

    Raises:
        InputError: there is no such map or site file; the message says what there is.
        MapError, SiteFileError: it is broken.
    """
    if map is None and names is None:
        return None
    read = None if names is None else read_names(_names_file(Path(names)))
    if map is None:
        return Told(None, names=read)
    if map == NO_MAP:
        return Told(None, names=read, charted=False)
    file = map_file(Path(map), f"--map {map}").absolute()
    plan = read_map(file)
    cells = plan.cells()
    if not (cells == FREE).any():
        raise InputError(f"--map {map}: {file.name} has no free cell, so a robot cannot be on it")
    rows, columns = cells.shape
    (x, y), cell = plan.origin, plan.resolution
    overhang = file.with_name(OVERHANG)
    beside = overhang if overhang.is_file() and file.name == MAP else None
    return Told(file, beside, (x, y, x + columns * cell, y + rows * cell), read)


def absolute_map(path: str | None) -> str | None:
    """A path of `--map` or `--names` for a process with another working directory."""
    return path if path in (None, NO_MAP) else str(Path(path).absolute())


def told_files(map_: str | None, names: str | None) -> dict[str, Path]:
    """The files that `--map` and `--names` name, by what they are; raises as `read_told`."""
    told = read_told(map_, names)
    found = {} if names is None else {"names": _names_file(Path(names))}
    maps = () if told is None else (told.map_file, told.overhang_file)
    for what, file in zip(("map", "overhang"), maps, strict=False):
        if file is not None:
            found |= {what: file, f"{what}'s picture": picture_file(file)}
    return found


def _names_file(path: Path) -> Path:
    file = path / NAMES if path.is_dir() else path
    if file.is_file():
        return file
    what = f"the folder has no {NAMES}" if path.is_dir() else "there is no such file or folder"
    raise InputError(
        f"--names {path}: {what}; names are in the {NAMES} of a map's folder, which "
        "`momantu-bt map` writes: start, places and surfaces, and zones of your own"
    )


def with_told(registry: Registry, told: Told) -> Registry:
    """A copy of the registry whose worlds tell this."""
    return replace(registry, worlds=_Worlds(registry.worlds, told))


class _Worlds(Mapping[str, Any]):
    """Worlds by name or path, each of which tells something else than its own."""

    def __init__(self, worlds: Mapping[str, WorldEntry], told: Told) -> None:
        self._worlds, self._told = worlds, told

    def __getitem__(self, name: str) -> Any:
        return _Telling(self._worlds[name], self._told)

    def __contains__(self, name: object) -> bool:
        return name in self._worlds

    def __iter__(self) -> Iterator[str]:
        return iter(self._worlds)

    def __len__(self) -> int:
        return len(self._worlds)


class _Telling:
    """A world entry with another site; all else is the entry's own."""

    def __init__(self, entry: WorldEntry, told: Told) -> None:
        self._entry, self._told = entry, told

    def __getattr__(self, name: str) -> Any:
        return getattr(self._entry, name)

    @property
    def name(self) -> str:
        """The world's name."""
        return self._entry.name

    @property
    def default_robot(self) -> str:
        """The robot to use when the user names none."""
        return self._entry.default_robot

    def site(self) -> Site:
        """The nominal site, told so."""
        return self._told.of(self._entry.site())

    def site_for(self, description: RobotDescription) -> Site:
        """The nominal site with maps, told so."""
        entry = self._entry
        own = entry.site_for(description) if isinstance(entry, MappedWorld) else entry.site()
        return self._told.of(own)

    def open(self, description: RobotDescription, seed: int, *, referee: bool = True) -> World:
        """The world itself: the run's own site is told when it is set up."""
        return self._entry.open(description, seed, referee=referee)


def off_the_map(told: Told, start: Pose2D) -> str | None:
    """A sentence for a person whose robot is told that it starts beside its map; else None."""
    if told.area is None:
        return None
    low_x, low_y, high_x, high_y = told.area
    inside = low_x <= start.x <= high_x and low_y <= start.y <= high_y
    if inside or not all(map(math.isfinite, (start.x, start.y))):
        return None
    return (
        f"the robot is told that it starts at ({start.x:.2f}, {start.y:.2f}), and the map spans x "
        f"{low_x:.1f} to {high_x:.1f} and y {low_y:.1f} to {high_y:.1f} m: is it of this place? "
        "`--names` takes the start of the map's site.yaml; else let the tree look for the robot on "
        "the whole map first"
    )
