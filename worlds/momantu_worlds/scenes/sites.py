"""What the robot is told: the site that follows from a world file, and its short form on disk.

Reading and checking a world file takes a seventh of a second, and every check of a tree asks for
the site. So the nominal site is kept beside the map, with the digest of the world file that it was
made from; a file that was changed since is read anew.
"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass, plain
from momantu_bt.world import Site, Surface

if TYPE_CHECKING:
    from momantu_worlds.scenes.world_file import WorldFile

SIGMAS = 2.0
"""The farthest a rough start may be off counts as this many standard deviations."""
KEPT = ("start", "start_sigma", "places", "surfaces", "objects")
"""Fields of a site that its short form holds; name and maps follow from where it lies."""


def site_of(
    world: WorldFile, start: Pose2D, map_file: Path | None, overhang_file: Path | None
) -> Site:
    """The site: nominal tables, places and object classes, and a rough start pose."""
    surfaces = {
        name: Surface(table.pose, table.size[:2], table.size[2], table.sides)
        for name, table in world.tables.items()
    }
    notes = world.site
    begin = world.start
    return Site(
        name=world.name,
        map_file=map_file,
        overhang_file=overhang_file,
        start=start,
        start_sigma=(begin.belief_shift / SIGMAS, begin.belief_turn / SIGMAS),
        places=MappingProxyType({name: Pose2D(*pose) for name, pose in notes.places.items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType(
            {name: ObjectClass(**sizes.model_dump()) for name, sizes in notes.objects.items()}
        ),
    )


def digest(world_file: Path) -> str:
    """Names the content of a world file; raises OSError when it cannot be read."""
    return hashlib.blake2b(world_file.read_bytes(), digest_size=16).hexdigest()


def put(file: Path, content: bytes) -> None:
    """Write a file whole or not at all, whoever else writes or reads it."""
    part = file.with_name(f".{file.name}.{os.getpid()}")
    part.write_bytes(content)
    part.replace(file)


def save_site(site: Site, world_file: Path, kept: Path) -> None:
    """Write a site's short form."""
    data = {"made_from": digest(world_file)} | {name: plain(getattr(site, name)) for name in KEPT}
    put(kept, (json.dumps(data, indent=1) + "\n").encode())


def kept_site(name: str, world_file: Path, kept: Path, maps: tuple[Path, Path]) -> Site | None:
    """The site from its short form; None when there is none of just this world file."""
    try:
        data = json.loads(kept.read_text(encoding="utf-8"))
        if data["made_from"] != digest(world_file):
            return None
    except (OSError, ValueError, KeyError, TypeError):
        return None
    surfaces = {
        surface: Surface(
            Pose2D(**entry["map_from_surface"]),
            (entry["size"][0], entry["size"][1]),
            entry["height"],
            tuple(entry["sides"]),
        )
        for surface, entry in data["surfaces"].items()
    }
    return Site(
        name=name,
        map_file=maps[0],
        overhang_file=maps[1],
        start=Pose2D(**data["start"]),
        start_sigma=(data["start_sigma"][0], data["start_sigma"][1]),
        places=MappingProxyType({place: Pose2D(**at) for place, at in data["places"].items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType({o: ObjectClass(**e) for o, e in data["objects"].items()}),
    )
