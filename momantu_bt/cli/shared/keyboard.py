"""Read the keys of a terminal one by one, without Enter and without showing them."""

from __future__ import annotations

import os
import re
import select
import sys
import termios
import tty
from contextlib import suppress
from types import TracebackType
from typing import Any

_SEQUENCES = {
    "\x1b[A": "up",
    "\x1b[B": "down",
    "\x1b[C": "right",
    "\x1b[D": "left",
    "\x1b[H": "home",
    "\x1b[F": "end",
    "\x1b[1~": "home",
    "\x1b[4~": "end",
    "\x1bOA": "up",
    "\x1bOB": "down",
    "\x1bOC": "right",
    "\x1bOD": "left",
    "\x1bOH": "home",
    "\x1bOF": "end",
    "\x1b": "escape",
    "\r": "enter",
    "\n": "enter",
    "\x7f": "backspace",
    "\x08": "backspace",
    "\x04": "leave",
    "\x1a": "Ctrl-Z",
}
"""Sequences that terminals send for special keys, and the end of the input, Ctrl-D."""
_KEY = re.compile(r"\x1b\[[0-9;]*[A-Za-z~]|\x1bO[A-Z]|.", re.DOTALL)
_MOST = 1024


class Keyboard:
    """A context in which the terminal gives single keys. Standard input must be a terminal.

    suspends: Ctrl-Z suspends the program, as usual; else it is a key like others.
    """

    def __init__(self, *, suspends: bool = True) -> None:
        self._file, self._suspends = sys.stdin.fileno(), suspends
        self._before: list[Any] = []

    def __enter__(self) -> Keyboard:
        self._before = termios.tcgetattr(self._file)
        tty.setcbreak(self._file)
        if not self._suspends:
            modes = termios.tcgetattr(self._file)
            modes[6][termios.VSUSP] = b"\0"
            termios.tcsetattr(self._file, termios.TCSADRAIN, modes)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with suppress(termios.error):  # the terminal has gone
            termios.tcsetattr(self._file, termios.TCSADRAIN, self._before)

    def forget(self) -> None:
        """Drop the keys that were pressed before now and not read."""
        with suppress(termios.error):
            termios.tcflush(self._file, termios.TCIFLUSH)

    def wait(self, seconds: float) -> list[str]:
        """The keys that are pressed within a time, as soon as there is one; none after it."""
        ready, _, _ = select.select([self._file], [], [], seconds)
        if not ready:
            return []
        try:
            text = os.read(self._file, _MOST).decode(errors="replace")
        except OSError:  # the terminal has gone
            text = ""
        return keys_in(text or "\x04")


def keys_in(text: str) -> list[str]:
    """Names of the keys that a terminal's characters mean; unknown sequences mean none."""
    found = [_SEQUENCES.get(key, key) for key in _KEY.findall(text)]
    return [key for key in found if not key.startswith("\x1b")]
