"""Worlds as a command line names them: an installed one's name, or a file."""

from __future__ import annotations

from momantu_bt.plugins import WORLDS, load
from momantu_bt.world import WorldEntry


def load_world(name: str) -> WorldEntry:
    """The world of a name or a path; PluginError with the nearest names when there is none."""
    entry: WorldEntry = load(WORLDS, name)
    return entry
