"""What a person sees while a map is made: on a terminal the map that grows, elsewhere lines."""

from __future__ import annotations

import signal
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Self

import typer
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.text import Text

from momantu_bt.failure import Failure
from momantu_bt.formats.names import counted
from momantu_skills.mapping.growing_plan import GrowingPlan
from momantu_skills.mapping.pictures.terminal import Overlay, map_text
from momantu_skills.navigation.map.maps import GridMap

if TYPE_CHECKING:
    from momantu_skills.mapping.own import Mapping
    from momantu_skills.mapping.survey import Survey

EVERY = 5.0
"""Simulated time after which a line of progress is printed, s."""
STEP = 0.05
"""Share of the scans after which a line of progress is printed."""
REDRAWN = 0.5
"""Wall time between two pictures on a terminal, s: drawing one takes a hundredth of it."""
CELL, GROWS = 0.1, 5.0
"""Cell of the picture of a log's map, m, and by how much its raster grows."""
BAR = 40
"""Columns of the bar."""


class _Display:
    """A picture on a terminal that is redrawn in place; nothing where there is no terminal."""

    def __init__(self) -> None:
        self._console = Console(file=sys.stderr)
        self._shown: RenderableType = Text()
        self.live = self._console.is_terminal and not self._console.is_dumb_terminal
        self._live = Live(
            get_renderable=lambda: self._shown,
            console=self._console,
            auto_refresh=False,
            transient=True,
        )
        self._next = 0.0

    def due(self) -> bool:
        """Whether a picture is to be drawn now."""
        now = time.monotonic()
        if not self.live or now < self._next:
            return False
        self._next = now + REDRAWN
        return True

    def show(self, head: RenderableType, grid: GridMap | None, overlay: Overlay) -> None:
        """Draw a map below a head of one or two lines."""
        width, height = self._console.size
        drawn = Text() if grid is None else map_text(grid, width, max(4, height - 4), overlay)
        self._shown = Group(head, drawn)
        self._live.refresh()

    def open(self) -> None:
        """Begin."""
        if self.live:
            self._live.start()

    def close(self) -> None:
        """Leave the terminal as it was."""
        if self._live.is_started:
            self._live.stop()


class Exploration:
    """Shows a robot that explores: the clock, what it knows, and its map."""

    def __init__(self) -> None:
        self._next = 0.0
        self._display = _Display()

    def __enter__(self) -> Self:
        self._display.open()
        return self

    def __exit__(self, *_: object) -> None:
        self._display.close()

    def __call__(self, now: float, mapping: Mapping) -> None:
        """Show what is known by now."""
        if self._display.live:
            if self._display.due():
                self._show(now, mapping)
        elif now >= self._next:
            self._next = now + EVERY
            typer.echo(_known(now, mapping), err=True)

    def _show(self, now: float, mapping: Mapping) -> None:
        grid = None
        with suppress(Failure):  # no scan yet
            grid = mapping.costmap.grid
        overlay = Overlay(mapping.survey.mapper.poses, mapping.map_from_base)
        head = Text(_known(now, mapping), style="bold", no_wrap=True, overflow="ellipsis")
        self._display.show(head, grid, overlay)


class _Counted:
    """Shows how far a log is mapped; Ctrl-C ends the work between two of what is counted.

    count: how many there are of `what`. doing: in words, such as `the log alone: `.
    """

    def __init__(self, count: int, what: str, doing: str = "") -> None:
        self._count, self._next = count, STEP
        self._what, self._doing = what, doing
        self._display = _Display()
        self._stopped = False

    def __enter__(self) -> Self:
        self._before = signal.signal(signal.SIGINT, self._stop)
        self._display.open()
        return self

    def __exit__(self, *_: object) -> None:
        self._display.close()
        signal.signal(signal.SIGINT, self._before)

    def _stop(self, *_: object) -> None:
        self._stopped = True
        typer.echo("interrupted: saving the map so far", err=True)

    def __call__(self, done: int, loops: int) -> bool:
        """Show how far it is; True if the work is to end."""
        said = f"{self._doing}{done} of {self._count} {self._what}, {counted(loops, 'loop')}"
        if self._display.live:
            if self._display.due():
                self._show(done, said)
        elif done >= self._next * self._count:
            typer.echo(said, err=True)
            self._next += STEP
        return self._stopped

    def _show(self, done: int, said: str) -> None:
        self._display.show(self._head(done, said), None, Overlay())

    def _head(self, done: int, said: str) -> RenderableType:
        return _bar(done, self._count, said)


class Scans(_Counted):
    """Shows how far a log of scans is mapped, and the map; see `_Counted`.

    survey: what the scans are added to.
    """

    def __init__(self, scans: int, survey: Survey, doing: str = "") -> None:
        super().__init__(scans, "scans", doing)
        self._survey = survey
        self._plan = GrowingPlan(CELL, GROWS)

    def _show(self, done: int, said: str) -> None:
        self._plan.follow(self._survey)
        grid = self._plan.grid()
        head = self._head(done, f"{said}, {grid.free_area:.0f} square metres known")
        poses = self._survey.mapper.poses
        self._display.show(head, grid, Overlay(poses, poses[-1]))


class Laid:
    """Shows how many scans of a log are laid on those before, where there is no odometry."""

    def __init__(self) -> None:
        self._next = STEP
        self._display = _Display()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._display.close()

    def __call__(self, done: int, count: int) -> None:
        """Show how many of how many are laid."""
        said = f"{done} of {count} scans are laid on those before"
        if done == 1:
            self._display.open()
        if self._display.live:
            if self._display.due():
                self._display.show(_bar(done, count, said), None, Overlay())
        elif done >= self._next * count:
            typer.echo(said, err=True)
            self._next += STEP


class Turns(_Counted):
    """Shows how far a log of clouds is mapped; see `_Counted`."""

    def __init__(self, turns: int) -> None:
        super().__init__(turns, "turns of the lidar")


def _bar(done: int, count: int, said: str) -> RenderableType:
    words = Text(said, style="bold", no_wrap=True)
    return Group(words, ProgressBar(total=count, completed=done, width=BAR))


def _known(now: float, mapping: Mapping) -> str:
    return (
        f"{now:7.1f} s  {mapping.known:.1f} square metres known, {counted(mapping.loops, 'loop')}"
    )
