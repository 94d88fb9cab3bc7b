"""The entry point of `momantu_bt.labelled`: cheap to import; it loads the simulator when called."""

from __future__ import annotations

from collections.abc import Sequence

from momantu_bt.labelled import Renderer
from momantu_bt.lazy import lazily

with lazily():
    from momantu_worlds.labelled import studio


def tables(worlds: Sequence[str] = (), *, testing: bool = False) -> Renderer:
    """What renders heaps on the tables of worlds; see `Studio`."""
    return studio.Studio(worlds, testing=testing)
