"""The cache of nominal sites, and the keys of all that is computed from world files.

Reading and checking a world file takes 0.14 s, and every check of a tree asks for the site. So the
nominal site is cached under a key of the world file's text and of this package's code.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from momantu_bt.formats.cache import cache_subfolder
from momantu_bt.formats.files import write_whole
from momantu_bt.geometry import Pose2D, Transform
from momantu_bt.messages import ObjectClass, plain
from momantu_bt.tags import TagBundle, TagPlate
from momantu_bt.world import Overhang, Site, Surface
from momantu_bt.zone import Zone

FIELDS = (
    "name",
    "start",
    "start_sigma",
    "places",
    "surfaces",
    "objects",
    "tags",
    "services",
    "area",
    "zones",
)
"""Fields of a site that are cached: all but maps, which depend on the robot."""


@dataclass(frozen=True, slots=True)
class Nominal:
    """What a world tells before it is opened: its site, and the robot that it is meant for."""

    site: Site
    robot: str


def store_nominal(nominal: Nominal, text: bytes) -> None:
    """Cache the site of a world file with this text; without a writable cache nothing happens."""
    data = {name: plain(getattr(nominal.site, name)) for name in FIELDS}
    with suppress(OSError):
        content = json.dumps({"robot": nominal.robot, "site": data}, indent=1) + "\n"
        write_whole(_cache_file(text), content)


def cached_nominal(text: bytes) -> Nominal | None:
    """The cached site of a world file with this text; None if there is none, or it is damaged."""
    try:
        data = json.loads(_cache_file(text).read_text(encoding="utf-8"))
        return Nominal(_read(data["site"]), data["robot"])
    except (OSError, ValueError, KeyError, TypeError, IndexError):
        return None


def _cache_file(text: bytes) -> Path:
    return cache_subfolder("sites") / f"{cache_key([text])}.json"


def _read(data: dict[str, Any]) -> Site:
    surfaces = {
        surface: Surface(
            Pose2D(**entry["map_from_surface"]),
            (entry["size"][0], entry["size"][1]),
            entry["height"],
            tuple(entry["sides"]),
            tuple(_overhang(one) for one in entry["over"]),
            entry["round"],
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
        tags=MappingProxyType({name: _bundle(each) for name, each in data["tags"].items()}),
        services=MappingProxyType(data["services"]),
        area=None if data["area"] is None else tuple(data["area"]),
        zones=MappingProxyType({name: _zone(each) for name, each in data["zones"].items()}),
    )


def _bundle(entry: dict[str, Any]) -> TagBundle:
    place = entry["map_from_bundle"]
    plates = (
        TagPlate(each["tag_id"], each["edge"], Transform(**each["bundle_from_tag"]))
        for each in entry["plates"]
    )
    return TagBundle(entry["family"], tuple(plates), None if place is None else Transform(**place))


def _overhang(entry: dict[str, Any]) -> Overhang:
    x, y = entry["size"]
    return Overhang(Pose2D(**entry["map_from_overhang"]), (x, y), entry["bottom"], entry["top"])


def _zone(entry: dict[str, Any]) -> Zone:
    return Zone(entry["kind"], tuple((x, y) for x, y in entry["corners"]), entry["speed"])


def cache_key(parts: Iterable[bytes | str]) -> str:
    """A key for what the code of `scenes` computes from these parts: 20 hexadecimal digits."""
    hashed = hashlib.blake2b(_code(), digest_size=10)
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        hashed.update(len(data).to_bytes(8, "big") + data)
    return hashed.hexdigest()


@cache
def _code() -> bytes:
    """Digest of all modules of `scenes`: a change of the code makes every old entry invalid."""
    hashed = hashlib.blake2b(digest_size=10)
    root = Path(__file__).parents[1]
    for path in sorted(root.rglob("*.py")):
        hashed.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return hashed.digest()
