"""The live tree in a terminal: statuses, the simulated clock, failures and reactions."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from momantu_bt.engine.executor import Executor
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.world import TreeLine

REFRESH = 0.1
"""Seconds of wall time between two redraws: smooth to look at, and cheap for the run."""
LAST = 6
"""Lines of the latest events, below the tree."""

_MARKS = {
    "RUNNING": ("*", "bold cyan"),
    "SUCCESS": ("✓", "green"),
    "FAILURE": ("✗", "bold red"),
    "SKIPPED": ("-", "dim"),
    "IDLE": (" ", "dim"),
}


class LiveTree:
    """Redraws the tree in place while the run goes on."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._said: list[str] = []
        self._changes = ChangeLines(self._said.append)
        self._drawn = 0.0
        self._live = self._new()
        self._live.start()

    def ticked(self, run: Executor) -> None:
        """Remember this tick, and draw when it is due."""
        self._changes.ticked(run)
        del self._said[:-LAST]
        now = time.perf_counter()
        if now - self._drawn >= REFRESH:
            self._drawn = now
            self._live.update(self._picture(run), refresh=True)

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Leave the picture in place while a person reads and types; go on below it."""
        self._live.stop()
        try:
            yield
        finally:
            self._live = self._new()
            self._live.start()

    def _new(self) -> Live:
        return Live(console=self._console, auto_refresh=False, transient=False)

    def close(self) -> None:
        """Leave the last picture standing; safe to call twice."""
        self._live.stop()

    def _picture(self, run: Executor) -> Group:
        rest = "  (coming to rest)" if run.settling else ""
        lines = [Text(f"{run.context.now:7.1f} s simulated{rest}", style="bold")]
        lines += [line_text(line) for line in tree_lines(run.built.root)]
        lines.append(Text())
        lines += [Text(said, style="dim", no_wrap=True, overflow="ellipsis") for said in self._said]
        return Group(*lines)


def line_text(line: TreeLine) -> Text:
    """A line of the tree with the mark and the colour of its status."""
    mark, style = _MARKS[line.status]
    words = f"{'  ' * line.depth}{mark} {line.text}"
    return Text(words, style=style, no_wrap=True, overflow="ellipsis")
