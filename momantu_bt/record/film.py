"""A subscriber that films a run."""

from __future__ import annotations

from momantu_bt.engine.executor import Executor
from momantu_bt.record.text.lines import running_text, tree_lines
from momantu_bt.world import Video

FRAME_EVERY = 2
"""Ticks between two frames of a film: 10 frames a second."""


class FilmObserver:
    """Adds a frame to a video every FRAME_EVERY ticks."""

    def __init__(self, video: Video) -> None:
        self._video = video
        self._ticks = 0

    def ticked(self, run: Executor) -> None:
        """Take a picture when one is due."""
        self._ticks += 1
        if self._ticks % FRAME_EVERY == 1:
            root = run.built.root
            headline = f"{run.context.now:.1f} s  {running_text(root)}"
            self._video.add(tree_lines(root), headline)

    def close(self) -> None:
        """Finish the file."""
        self._video.close()
