"""The terminal screen of `replay`, and its keyboard loop."""

from __future__ import annotations

import time
from textwrap import wrap

from rich.console import Console, ConsoleDimensions, Group
from rich.live import Live
from rich.text import Text

from momantu_bt.cli.run.live import line_text
from momantu_bt.cli.shared.keyboard import Keyboard
from momantu_bt.folding import fitted
from momantu_bt.record.text.failure import failure_line
from momantu_bt.record.text.lines import tree_lines
from momantu_bt.replay.moment_text import board_lines, failures_of
from momantu_bt.replay.stepper import KEYS, Stepper

PICTURE_EVERY = 0.05
"""Seconds of wall time between two redraws while the record plays."""
IDLE = 0.5
"""The same while nothing happens, to notice a new window size."""
FAILED = 4
"""Largest number of lines of failures."""
SAID = 4
"""Lines of the latest messages, below the tree."""


def show(stepper: Stepper, told: list[tuple[int, str]], console: Console) -> None:
    """Let a person go through a record until the person leaves.

    told: the run's lines with the indices of their ticks.
    """
    with Keyboard() as keyboard, Live(console=console, screen=True, auto_refresh=False) as live:
        before = time.perf_counter()
        drawn: object = None
        while not stepper.leaving:
            wanted = (stepper.view, console.size)
            if wanted != drawn:
                live.update(picture(stepper, told, console.size), refresh=True)
                drawn = wanted
            for key in keyboard.wait(PICTURE_EVERY if stepper.playing else IDLE):
                stepper.press(key)
            now = time.perf_counter()
            stepper.pass_time(now - before)
            before = now


def picture(stepper: Stepper, told: list[tuple[int, str]], size: ConsoleDimensions) -> Group:
    """Header, tree, blackboard or keys if wanted, and the last lines; as high as `size`."""
    below = [*_failures(stepper, size.width), *_said(stepper, told), _last_line(stepper)]
    below = below[-max(1, size.height - 2) :]
    room = max(1, size.height - 1 - len(below))
    extra = _keys()[: room - 1] if stepper.shows_keys else []
    if stepper.shows_board and not extra:
        extra = _board(stepper)[: room // 2]
    tree = _tree(stepper, room - len(extra))
    gap = [Text() for _ in range(room - len(extra) - len(tree))]
    return Group(_header(stepper), *tree, *gap, *extra, *below)


def _header(stepper: Stepper) -> Text:
    moment, total = stepper.moment, stepper.timeline.recording.ticks[-1]
    state = f"  playing {stepper.speed:g} x" if stepper.playing else f"  {stepper.speed:g} x"
    rest = "  (coming to rest)" if moment.tick.settling else ""
    words = f"{moment.tick.now:8.2f} s of {total.now:.2f} s  tick {moment.tick.number}{state}{rest}"
    return Text(words, style="bold", no_wrap=True, overflow="ellipsis")


def _tree(stepper: Stepper, room: int) -> list[Text]:
    """As many lines of the tree as fit."""
    return [line_text(line) for line in fitted(tree_lines(stepper.moment.root), room)]


def _board(stepper: Stepper) -> list[Text]:
    return [
        _thin(f"{mark} {words}", "bold" if mark == "*" else "")
        for mark, words in board_lines(stepper.moment)
    ] or [_thin("the blackboard is empty", "dim")]


def _keys() -> list[Text]:
    return [_thin(f"  {key:7}{meaning}", "") for key, meaning in KEYS.items()]


def _failures(stepper: Stepper, width: int) -> list[Text]:
    """The failures of this tick, with their causes, in a few lines."""
    lines: list[str] = []
    for failure in failures_of(stepper.moment):
        lines += wrap(f"✗ {failure_line(failure)}", width, subsequent_indent="  ")
    return [_thin(line, "red") for line in lines[:FAILED]]


def _said(stepper: Stepper, told: list[tuple[int, str]]) -> list[Text]:
    """The last lines up to this moment; those of this tick are highlighted."""
    until = [(index, line) for index, line in told if index <= stepper.index][-SAID:]
    return [_thin(line, "" if index == stepper.index else "dim") for index, line in until]


def _last_line(stepper: Stepper) -> Text:
    if stepper.prompt is not None:
        return _thin(stepper.prompt + "▏", "bold")
    return _thin(stepper.said or "? for the keys, q to leave", "" if stepper.said else "dim")


def _thin(words: str, style: str) -> Text:
    return Text(words, style=style, no_wrap=True, overflow="ellipsis")
