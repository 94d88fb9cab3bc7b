"""Reading a world file: YAML 1.2 to checked values; every error is reported at its place."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

from pydantic import ValidationError

from momantu_bt.descriptions.reading import DescriptionError, KeyProblem, Reading, read_text
from momantu_bt.descriptions.tunables import tunable_problems
from momantu_bt.descriptions.validation import checked
from momantu_worlds.scenes.file.references import dangling
from momantu_worlds.scenes.file.world import WorldFile

SECTIONS = (
    "rooms",
    "doors",
    "doorways",
    "tables",
    "furniture",
    "objects",
    "tags",
    "bodies",
    "actors",
)
"""Parts of a world file whose keys are names."""


class WorldFileError(DescriptionError):
    """A world file is wrong; the message lists every problem with its line and a caret."""

    what: ClassVar[str] = "world"


def read_world(path: Path) -> WorldFile:
    """Read the world that a file describes.

    Raises:
        WorldFileError: the file cannot be read, is not YAML, or describes no possible world;
            all problems are listed with line and column.
    """
    return parse_world(world_text(path), path)


def world_text(path: Path) -> str:
    """Read the text of a world file; WorldFileError if it cannot be read or is too long."""
    return read_text(path, WorldFileError)


def parse_world(text: str, path: Path) -> WorldFile:
    """Like `read_world`, from text; `path` is for the messages and for the files that it names."""
    reading = Reading(path, text, WorldFileError)
    tunables = list(tunable_problems(reading, ("site", "services")))
    try:
        world = checked(reading, WorldFile, WorldFileError)
        world = world.located(path, reading.at(("goal",), key=True).line)
    except WorldFileError as error:
        found = [*error.problems, *_beside(reading, error), *tunables]
        raise WorldFileError(path, text, found) from None
    if tunables:
        raise WorldFileError(path, text, tunables)
    reading.refuse(dangling(world))
    return world


def _beside(reading: Reading, error: WorldFileError) -> Iterator[KeyProblem]:
    """Find wrong references in a file that has wrong values as well.

    Parts with wrong values are left out; if that would be whole sections, nothing is reported.
    """
    places = {problem.keys[:2] for problem in error.problems}
    if any(len(place) < 2 or place[0] not in SECTIONS for place in places):
        return
    named = {section: dict(reading.plain[section]) for section, _ in places}
    for section, name in places:
        named[str(section)].pop(name, None)
    try:
        world = WorldFile.model_validate({**reading.plain, **named}).located(reading.path)
    except ValidationError:
        return
    for place, message in dangling(world, also={str(name) for _, name in places}):
        if place[0] != "doors" or "rooms" not in named:  # its wall may be one of these
            yield reading.problem(place, message)
