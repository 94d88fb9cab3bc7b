"""Finding the place in a world file that a part of an episode comes from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from momantu_bt.descriptions.reading import DescriptionError, Reading, read_text
from momantu_bt.formats.places import KeyPath, Place

SECTIONS = ("tables", "furniture", "objects", "tags", "bodies", "doors", "doorways", "rooms")
"""Parts of a world file whose keys are names of what they describe."""
NAMED = ("item", "tag")
"""Sections with a key `name`."""
WALL = "wall_"
"""Prefix of the names of walls."""


class Where:
    """A world file's places."""

    def __init__(self, path: Path) -> None:
        """Raises WorldError when the file cannot be read."""
        self.path = path
        self._reading = Reading(path, read_text(path, DescriptionError), DescriptionError)

    def at(self, keys: KeyPath) -> Place:
        """The place of the element that some keys lead to, or of the nearest element around it."""
        return self._reading.at(keys, key=True)

    def body(self, name: str) -> KeyPath:
        """The keys that describe a body or a doorway; for added furniture, `unknown`."""
        world = self._reading.plain
        for section in SECTIONS:
            if name in _mapping(world, section):
                return (section, name)
        for section in NAMED:
            if _mapping(world, section).get("name") == name:
                return (section,)
        if name.startswith(WALL):
            return _wall(world, name.removeprefix(WALL))
        if name.startswith("extra_"):
            return ("unknown",)
        return ("distractors",) if "distractors" in world else ()


def _wall(world: dict[str, Any], name: str) -> KeyPath:
    """A wall piece by its name, or the room that a wall's name begins with."""
    pieces = _mapping(world, "walls").get("pieces") or []
    for number, piece in enumerate(pieces):
        if isinstance(piece, dict) and piece.get("name") == name:
            return ("walls", "pieces", number)
    rooms = [room for room in _mapping(world, "rooms") if f"{name}_".startswith(f"{room}_")]
    return ("rooms", max(rooms, key=len)) if rooms else ("walls",)


def _mapping(world: dict[str, Any], section: str) -> dict[str, Any]:
    found = world.get(section)
    return found if isinstance(found, dict) else {}
