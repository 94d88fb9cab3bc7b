"""The summary of a world file for `momantu-bt worlds show`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from momantu_bt.descriptions.reading import DescriptionError, Reading, read_text

VARIES = ("shift", "turn", "lift", "belief_shift", "belief_turn")
"""Keys of random variations, in any section."""
SECTIONS = ("unknown", "light", "distractors")
"""Sections that contain variations only."""
MOST = 60
"""Largest number of lines in a section."""


def world_summary(path: Path) -> dict[str, dict[str, str]]:
    """Tags, loose objects, what varies between episodes, the goal; empty sections are left out."""
    world = Reading(path, read_text(path, DescriptionError), DescriptionError).plain
    sections = {
        "Tags": dict(_named(world, "tag", "tags")),
        "Loose things": dict(_named(world, "item", "objects")),
        "What an episode varies": dict(_varying(world)),
        "Goal": dict(_goal(world.get("goal"))),
    }
    return {title: dict(list(lines.items())[:MOST]) for title, lines in sections.items() if lines}


def _goal(goal: Any) -> Iterator[tuple[str, str]]:
    if isinstance(goal, dict):
        yield from ((key, _words(value)) for key, value in goal.items())
    elif isinstance(goal, str):
        yield "demand", goal
    for number, demand in enumerate(goal if isinstance(goal, list) else (), 1):
        yield f"demand {number}", _words(demand)


def _named(world: dict[str, Any], one: str, many: str) -> Iterator[tuple[str, str]]:
    single = _part(world, one)
    if single:
        yield str(single.get("name", one)), _words({k: v for k, v in single.items() if k != "name"})
    for name, note in _part(world, many).items():
        yield name, _words(note)


def _varying(world: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for section, part in world.items():
        if section in SECTIONS:
            if isinstance(part, dict):
                yield section, _words(part)
            continue
        for name, note in _notes(section, part):
            words = {key: note[key] for key in VARIES if key in note}
            if words:
                yield name, _words(words)
    moving = [
        name for name, note in _notes("furniture", _part(world, "furniture")) if "moves" in note
    ]
    if moving:
        yield "furniture that may be moved", ", ".join(moving)


def _notes(section: str, part: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    """A section of the file, and its named parts."""
    if isinstance(part, dict):
        yield section, part
        yield from ((name, note) for name, note in part.items() if isinstance(note, dict))


def _part(world: dict[str, Any], name: str) -> Mapping[str, Any]:
    found = world.get(name)
    return found if isinstance(found, dict) else {}


def _words(value: Any) -> str:
    """A value as it stands in the file, on one line."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_inner(inner)}" for key, inner in value.items())
    return _inner(value)


def _inner(value: Any) -> str:
    if isinstance(value, dict):
        return f"({_words(value)})"
    if isinstance(value, list):
        return f"[{', '.join(_inner(each) for each in value)}]"
    return f"{value:g}" if isinstance(value, float) else str(value)
