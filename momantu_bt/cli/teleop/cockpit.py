"""The terminal of a person who drives: its keys, as commands, and its screen, as an observer."""

from __future__ import annotations

import time
from contextlib import ExitStack

from rich.console import Console
from rich.live import Live

from momantu_bt.cli.shared.keyboard import Keyboard
from momantu_bt.cli.teleop.controls import Controls
from momantu_bt.cli.teleop.picture import Seen, picture
from momantu_bt.engine.executor import Executor
from momantu_bt.engine.status import FAILURE, RUNNING
from momantu_bt.record.text.failure import failure_line
from momantu_bt.teleoperation import Command

REFRESH = 0.1
"""Seconds of wall time between two pictures."""
MEASURED = 2.0
"""Seconds of wall time over which the pace is measured."""


class Seat:
    """A source of commands: the keys that wait in the terminal, read at each tick."""

    def __init__(self, controls: Controls) -> None:
        self.controls = controls
        self.keyboard: Keyboard | None = None

    def command(self, now: float) -> Command:
        """The person's command; nothing blocks."""
        for key in [] if self.keyboard is None else self.keyboard.wait(0.0):
            self.controls.press(key, now)
        return self.controls.command(now)


class Cockpit:
    """Takes over the terminal until it is closed; it then is as before, however the run ended.

    headline: what runs. remarks: all that was said during the run, for after it.
    """

    def __init__(self, console: Console, seat: Seat, headline: str) -> None:
        self.remarks: list[str] = []
        self._console, self._seat = console, seat
        self._headline = headline
        self._stack = ExitStack()
        self._live: Live | None = None
        self._drawn = 0.0
        self._marks: list[tuple[float, float]] = []

    def open(self) -> None:
        """Take over keyboard and screen. Keys that were pressed before do not count."""
        with ExitStack() as opening:
            opening.push(self._stack)
            keyboard = self._stack.enter_context(Keyboard(suspends=False))
            live = Live(console=self._console, screen=True, auto_refresh=False)
            self._live = self._stack.enter_context(live)
            keyboard.forget()
            self._seat.keyboard = keyboard
            opening.pop_all()

    def remark(self, text: str) -> None:
        """Show a remark, and keep it for the end."""
        self.remarks.append(text)

    def ticked(self, run: Executor) -> None:
        """Draw, when it is due."""
        now = time.perf_counter()
        if self._live is None or now - self._drawn < REFRESH:
            return
        self._drawn = now
        shown = picture(self._seat.controls, self._seen(run, now), self._console.size)
        self._live.update(shown, refresh=True)

    def close(self) -> None:
        """Give the terminal back. Calling it twice is safe."""
        self._live = None
        self._seat.keyboard = None
        self._stack.close()

    def _seen(self, run: Executor, wall: float) -> Seen:
        self._marks = [m for m in self._marks if wall - m[0] < MEASURED]
        self._marks.append((wall, run.context.now))
        (began, simulated), (ended, since) = self._marks[0], self._marks[-1]
        pace = (since - simulated) / (ended - began) if ended - began > 0.5 else 1.0
        rest = "  (coming to rest)" if run.settling else ""
        return Seen(
            headline=self._headline + rest,
            now=run.context.now,
            pace=pace,
            state=run.state,
            doing=_doing(run, self._seat.controls),
            said=self.remarks[-1] if self.remarks else "",
        )


def _doing(run: Executor, controls: Controls) -> dict[str, str]:
    """What each part's skill does, or why it has failed."""
    words: dict[str, str] = {}
    for node in run.built.nodes:
        if node.state is RUNNING:
            words[node.model.type] = node.note
        elif node.shown is FAILURE and node.failure is not None:
            words[node.model.type] = f"failed: {failure_line(node.failure)}"
    return {part: words.get(skill, "") for part, skill in controls.able.skills.items()}
