"""The world of a run: the requested one, or the tree's own."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.tree.model import Document
from momantu_bt.world_plugins import WORLDS

WITHOUT_WORLD = "none"
"""The name that means "run without a world"."""


def world_of(document: Document, asked: str | None) -> str | None:
    """The name or path of the run's world; None without a world.

    asked: the world to use instead of the tree's own. If it is a path, it is relative to the
    working directory; a path in the tree file is relative to that file.
    """
    if asked is not None:
        return None if asked == WITHOUT_WORLD else asked
    own = document.world
    if own is None or own == WITHOUT_WORLD:
        return None
    return str(Path(document.file).parent / own) if WORLDS.is_path(own) else own
