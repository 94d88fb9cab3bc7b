"""What the robot is told: the site that follows from a world file, and its short form on disk.

Reading and checking a world file takes a seventh of a second, and every check of a tree asks for
the site. So the nominal site is kept, under the digest of the world file that it was made from.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from momantu_bt.files import kept_folder, write_whole
from momantu_bt.geometry import Pose2D
from momantu_bt.messages import ObjectClass, plain
from momantu_bt.world import Overhang, Site, Surface
from momantu_worlds.scenes.site.cache_key import cache_key

if TYPE_CHECKING:
    from momantu_worlds.scenes.file.world import WorldFile

SIGMAS = 2.0
"""The farthest a rough start may be off counts as this many standard deviations."""
FIELDS = ("name", "start", "start_sigma", "places", "surfaces", "objects", "services")
"""Fields of a site that its short form holds: all but maps, which depend on the robot."""


@dataclass(frozen=True, slots=True)
class Nominal:
    """What is asked of a world before it is opened. robot: the one it is meant for."""

    site: Site
    robot: str


def site_of(world: WorldFile, start: Pose2D) -> Site:
    """The site: nominal surfaces, places and object classes, and a rough start pose."""
    from momantu_worlds.scenes.arrange.surfaces import nominal_surfaces
    from momantu_worlds.scenes.site.overhangs import overhangs

    tops = nominal_surfaces(world)
    over = overhangs(world, tops)
    surfaces = {
        name: Surface(top.pose, top.size, top.height, top.sides, over[name])
        for name, top in tops.items()
    }
    notes = world.site
    begin = world.start
    return Site(
        name=world.name,
        start=start,
        start_sigma=(begin.belief_shift / SIGMAS, begin.belief_turn / SIGMAS),
        places=MappingProxyType({name: Pose2D(*pose) for name, pose in notes.places.items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType(
            {name: ObjectClass(**sizes.model_dump()) for name, sizes in notes.objects.items()}
        ),
        services=MappingProxyType(notes.services),
    )


def keep(nominal: Nominal, text: bytes) -> None:
    """Write the short form for a world file of this text, if it can be written."""
    data = {name: plain(getattr(nominal.site, name)) for name in FIELDS}
    with suppress(OSError):
        content = json.dumps({"robot": nominal.robot, "site": data}, indent=1) + "\n"
        write_whole(_place(text), content)


def kept_nominal(text: bytes) -> Nominal | None:
    """What was kept for a world file of this text; None when nothing was, or it is damaged."""
    try:
        data = json.loads(_place(text).read_text(encoding="utf-8"))
        return Nominal(_read(data["site"]), data["robot"])
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None


def _place(text: bytes) -> Path:
    return kept_folder("sites") / f"{cache_key([text])}.json"


def _read(data: dict[str, Any]) -> Site:
    surfaces = {
        surface: Surface(
            Pose2D(**entry["map_from_surface"]),
            (entry["size"][0], entry["size"][1]),
            entry["height"],
            tuple(entry["sides"]),
            tuple(_overhang(one) for one in entry["over"]),
        )
        for surface, entry in data["surfaces"].items()
    }
    return Site(
        name=data["name"],
        start=Pose2D(**data["start"]),
        start_sigma=(data["start_sigma"][0], data["start_sigma"][1]),
        places=MappingProxyType({place: Pose2D(**at) for place, at in data["places"].items()}),
        surfaces=MappingProxyType(surfaces),
        objects=MappingProxyType({o: ObjectClass(**e) for o, e in data["objects"].items()}),
        services=MappingProxyType(data["services"]),
    )


def _overhang(entry: dict[str, Any]) -> Overhang:
    x, y = entry["size"]
    return Overhang(Pose2D(**entry["map_from_overhang"]), (x, y), entry["bottom"], entry["top"])
