"""The world of a run: the requested one, or the tree's own."""

from __future__ import annotations

from pathlib import Path

from momantu_bt.tree.model import Document
from momantu_bt.world_plugins import WORLDS

WITHOUT_WORLD = "none"
"""As a world's name: run without one."""


def world_of(document: Document, asked: str | None) -> str | None:
    """A name or a path; None without a world.

    asked: instead of the tree's own, a path of it seen from the working directory. A path that the
    tree has itself is seen from the tree's file.
    """
    if asked is not None:
        return None if asked == WITHOUT_WORLD else asked
    own = document.world
    if own is None or own == WITHOUT_WORLD:
        return None
    return str(Path(document.file).parent / own) if WORLDS.is_path(own) else own
