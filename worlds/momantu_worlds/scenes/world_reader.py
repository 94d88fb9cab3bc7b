"""Reading a world file: YAML 1.2 to checked values, with every error at its place."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from momantu_bt.descriptions.findings import checked
from momantu_bt.descriptions.reading import DescriptionError, Reading, read_text
from momantu_worlds.scenes.world_file import WorldFile
from momantu_worlds.scenes.world_names import dangling


class WorldFileError(DescriptionError):
    """A world file is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "world"


def read_world(path: Path) -> WorldFile:
    """The world that a file describes.

    Raises:
        WorldFileError: the file cannot be read, is no YAML, or describes no possible world; all
            problems are listed with line and column.
    """
    return parse_world(world_text(path), path)


def world_text(path: Path) -> str:
    """The text of a world file; WorldFileError when it cannot be read or is too long."""
    return read_text(path, WorldFileError)


def parse_world(text: str, path: Path) -> WorldFile:
    """As `read_world`, from text; `path` is for the messages, and where named files lie."""
    reading = Reading(path, text, WorldFileError)
    world = checked(reading, WorldFile, WorldFileError).located(path)
    reading.refuse(dangling(world))
    return world
