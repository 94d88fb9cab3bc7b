"""The live tree in a terminal: what is prepared, statuses, the clock, failures and reactions."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from textwrap import wrap

from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from momantu_bt.engine.executor import Executor
from momantu_bt.folding import fitted
from momantu_bt.record.text.changes import ChangeLines
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.world import TreeLine

REFRESH = 0.1
"""Seconds of wall time between two redraws: smooth to look at, and cheap for the run."""
WAITING = 0.5
"""The same while the run is being prepared."""
FEWEST, MOST = 3, 10
"""Lines of events below the tree: a quarter of the screen, within these bounds."""
NEWEST = 2
"""The newest events are shown in any case; above them stand failures and what was done about them,
which would scroll away otherwise."""
ROWS = 2
"""Most lines of one event."""
INDENT = 13
"""Columns before the second line of an event."""

_MARKS = {
    "RUNNING": ("*", "bold cyan"),
    "SUCCESS": ("✓", "green"),
    "FAILURE": ("✗", "bold red"),
    "SKIPPED": ("-", "dim"),
    "IDLE": (" ", "dim"),
}


class LiveTree:
    """Draws the tree in place, first while the run is prepared, then while it goes on.

    planned: the tree's lines before the first tick. The picture is no higher than the screen. At
    the end it makes room for all events, which can be scrolled, and for the whole tree.
    """

    def __init__(self, console: Console, planned: Sequence[TreeLine] = ()) -> None:
        self._console = console
        self._events: list[tuple[str, bool]] = []
        self._changes = ChangeLines(
            lambda line: self._events.append((line, False)),
            lambda line: self._events.append((line, True)),
        )
        self._lines, self._headline = list(planned), ""
        self._prepared_from = self._stage_from = time.perf_counter()
        self._drawn = 0.0
        self._run: Executor | None = None
        self._waiting: _Redrawing | None = _Redrawing(self._redraw)
        self._live = self._new()
        self._live.start(refresh=True)
        self._waiting.start()

    def stage(self, text: str) -> None:
        """Say what is being prepared now."""
        self._headline, self._stage_from = text, time.perf_counter()
        self._live.refresh()

    def ticked(self, run: Executor) -> None:
        """Remember this tick, and draw when it is due."""
        self._end_waiting()
        self._run = run
        self._changes.ticked(run)
        now = time.perf_counter()
        if now - self._drawn >= REFRESH:
            self._drawn = now
            self._take(run)
            self._live.refresh()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Leave the picture in place while a person reads and types; go on below it."""
        self._live.transient = False
        self._live.stop()
        try:
            yield
        finally:
            self._live = self._new()
            self._live.start()

    def close(self) -> None:
        """Leave all events and the last tree standing; safe to call twice."""
        if not self._live.is_started:
            return
        self._end_waiting()
        self._live.stop()
        if self._run is not None:
            self._take(self._run)
            for text, _ in self._events:
                self._console.print(Text(text), soft_wrap=True)
            self._console.print(self._header())
            self._console.print(*map(line_text, self._lines), sep="\n")

    def _take(self, run: Executor) -> None:
        rest = "  (coming to rest)" if run.settling else ""
        self._headline = f"{run.context.now:7.1f} s simulated{rest}"
        if not run.settling or run.built.root.shown.completed:
            self._lines = tree_lines(run.built.root)  # a run that was stopped: as it was before

    def _new(self) -> Live:
        return Live(
            get_renderable=self._picture, console=self._console, auto_refresh=False, transient=True
        )

    def _redraw(self) -> None:
        self._live.refresh()

    def _end_waiting(self) -> None:
        waiting, self._waiting = self._waiting, None
        if waiting is not None:
            waiting.end()

    def _header(self) -> Text:
        words = self._headline
        if self._waiting is not None:
            now = time.perf_counter()
            words = f"preparing: {words or 'the run'} … {now - self._stage_from:.0f} s"
            if self._stage_from != self._prepared_from:
                words += f"  ({now - self._prepared_from:.0f} s in all)"
        return Text(words, style="bold", no_wrap=True, overflow="ellipsis")

    def _picture(self) -> Group:
        width, height = self._console.size
        below = self._latest(width, min(MOST, max(FEWEST, height // 4)))
        room = max(1, height - 3 - len(below))
        tree = [line_text(line) for line in fitted(self._lines, room)]
        return Group(self._header(), *tree, *([Text()] if below else []), *below)

    def _latest(self, width: int, room: int) -> list[Text]:
        """The newest events and, above them, the newest of those that matter."""
        newest = self._events[-NEWEST:]
        earlier = [each for each in self._events[:-NEWEST] if each[1]]
        rows: list[Text] = []
        for text, matters in [*earlier[-room:], *newest]:
            style = "" if matters else "dim"
            said = wrap(
                text, width, subsequent_indent=" " * INDENT, max_lines=ROWS, placeholder=" …"
            )
            for row in said:
                rows.append(Text(row, style=style, no_wrap=True, overflow="ellipsis"))
        return rows[-room:]


class _Redrawing:
    """Redraws every WAITING seconds, in a thread of its own, while the main thread prepares."""

    def __init__(self, draw: Callable[[], None]) -> None:
        self._draw = draw
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="first picture", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def end(self) -> None:
        """Draw no more."""
        self._over.set()
        self._thread.join()

    def _work(self) -> None:
        while not self._over.wait(WAITING):
            try:
                self._draw()
            except Exception:  # the terminal is broken, as the first tick will say
                return


def line_text(line: TreeLine) -> Text:
    """A line of the tree with the mark and the colour of its status."""
    mark, style = _MARKS[line.status]
    words = f"{'  ' * line.depth}{mark} {line.text}"
    return Text(words, style=style, no_wrap=True, overflow="ellipsis")
