"""Progress of a bench: one live line on a terminal, a line per episode elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import typer
from rich.console import Console, RenderableType
from rich.live import Live
from rich.text import Text

from momantu_bt.bench.episodes.engine import Engine
from momantu_bt.bench.reports.tables import row_text
from momantu_bt.bench.rows.outcome import succeeded
from momantu_bt.bench.rows.spec import REFUSED, Row
from momantu_bt.bench.statistics.intervals import wilson

MOST_RUNNING = 4
"""Running episodes that the live line names."""


class Progress:
    """The figures of a bench under way; implements `Watcher` with a line for each episode."""

    def __init__(self) -> None:
        self._engine: Engine | None = None
        self._there = self._done = self._good = self._waiting = 0
        self._seconds = 0.0
        self._begun = time.monotonic()

    def begin(self, rows: Sequence[Row], waiting: int, engine: Engine) -> None:
        """Say how much is there already."""
        self._engine, self._waiting, self._there = engine, waiting, len(rows)
        self._good = sum(map(succeeded, rows))
        self._seconds = sum(row["process_time_s"] for row in rows)
        self._begun = time.monotonic()
        at_a_time = f", {engine.workers} at a time" if engine.workers else ""
        had = f"{len(rows)} episodes are there already; " if rows else ""
        typer.echo(f"{had}{waiting} to run{at_a_time}")

    def row(self, row: Row) -> None:
        """Count it and say it."""
        if row["ended"] == REFUSED:
            self.say(f"{row['tree']} seed {row['seed']} cannot begin: {row['output']}")
            return
        self._done += 1
        self._good += succeeded(row)
        self._seconds += row["process_time_s"]
        self.say(f"[{self._done}/{self._waiting}] {row_text(row)}")

    def say(self, line: str) -> None:
        """Print a line that stays."""
        typer.echo(line)

    def close(self) -> None:
        """Nothing is left to do."""

    def headline(self) -> str:
        """`37 of 500, 36 successes (86.2 % to 99.5 %), 41 min left; seed 38, seed 39`."""
        had = self._there + self._done
        low, high = wilson(self._good, had)
        parts = [
            f"{had} of {self._there + self._waiting}",
            f"{self._good} successes ({100 * low:.1f} % to {100 * high:.1f} %)",
        ]
        left = self._left()
        if left is not None:
            parts.append(f"{duration(left)} left")
        running = () if self._engine is None else self._engine.running()
        names = [spec.name for spec in running[:MOST_RUNNING]]
        more = ["…"] if len(running) > MOST_RUNNING else []
        return ", ".join(parts) + ("; running " + ", ".join(names + more) if names else "")

    def _left(self) -> float | None:
        """Seconds of wall time that the rest will take, from the mean of those that are done."""
        had = self._there + self._done
        if had == 0 or self._engine is None:
            return None
        return self._seconds / had * (self._waiting - self._done) / max(1, self._engine.workers)


class LiveProgress(Progress):
    """Progress on a terminal: one line that is redrawn; failures stay above it."""

    def begin(self, rows: Sequence[Row], waiting: int, engine: Engine) -> None:
        """Begin to draw."""
        super().begin(rows, waiting, engine)
        console = Console()
        self._live = Live(console=console, get_renderable=self._drawn, transient=True)
        self._live.start()

    def row(self, row: Row) -> None:
        """Count it; it is said when it failed."""
        if row["ended"] != REFUSED and succeeded(row):
            self._done += 1
            self._good += 1
            self._seconds += row["process_time_s"]
        else:
            super().row(row)

    def say(self, line: str) -> None:
        """Print above the live line."""
        self._live.console.print(line, markup=False, highlight=False, soft_wrap=True)

    def close(self) -> None:
        """Leave the terminal as it was."""
        self._live.stop()

    def _drawn(self) -> RenderableType:
        return Text(self.headline(), no_wrap=True, overflow="ellipsis")


def progress() -> Progress:
    """The kind of progress that suits the output."""
    return LiveProgress() if sys.stdout.isatty() else Progress()


def duration(seconds: float) -> str:
    """`45 s`, `12 min`, `3 h 20 min`."""
    minutes = round(seconds / 60)
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
