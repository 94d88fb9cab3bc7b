"""A person at the terminal, who answers the tree's questions and uses the keyboard."""

from __future__ import annotations

import os
import select
import signal
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Protocol

import typer

from momantu_bt.engine.person import Interrupted, Question

LONGEST = 4096
"""Most bytes of one line that a terminal accepts."""


class Display(Protocol):
    """Anything that draws on the terminal at the same time."""

    def paused(self) -> AbstractContextManager[None]:
        """While it is entered, nothing is drawn."""
        ...


class Terminal:
    """Implements `Person`. display: pauses while the person reads and types."""

    def __init__(self) -> None:
        self.display: Display | None = None

    def ask(self, question: Question, complaint: str) -> str | None:
        """Ask at the keyboard; None at the end of the input (Ctrl-D).

        Raises:
            Interrupted: Ctrl-C; it then interrupts the run as usual.
        """
        with self.drawing():
            if complaint:
                typer.echo(f"  {complaint}")
            return self.read(f"? {question.text}{_ways(question)}: ")

    def drawing(self) -> AbstractContextManager[None]:
        """The terminal for text alone."""
        return nullcontext() if self.display is None else self.display.paused()

    def try_read(self, prompt: str) -> str | None:
        """One line; None when the run is interrupted, by a signal or the end of the input."""
        try:
            line = self.read(prompt)
        except Interrupted:
            return None
        if line is None:
            signal.raise_signal(signal.SIGINT)
        return line

    def read(self, prompt: str) -> str | None:
        """One line; None at the end of the input.

        Raises:
            Interrupted: a signal came; its usual handler has been told.
        """
        keyboard = sys.stdin.fileno()
        with _signals() as signals:
            typer.echo(prompt, nl=False)
            # `input` would miss a signal that comes just before it begins to wait
            ready, _, _ = select.select([keyboard, signals], [], [])
        if signals in ready:
            typer.echo()
            raise Interrupted
        try:
            line = os.read(keyboard, LONGEST)
        except OSError:  # the terminal has gone
            line = b""
        if not line:
            typer.echo()
            return None
        return line.decode(errors="replace").rstrip("\n")


def is_interactive() -> bool:
    """Whether standard input and output are both a terminal."""
    return sys.stdin.isatty() and sys.stdout.isatty()


@contextmanager
def _signals() -> Iterator[int]:
    """A file that becomes readable when a signal has been handled."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    before = signal.set_wakeup_fd(writing)
    try:
        yield reading
    finally:
        signal.set_wakeup_fd(before)
        os.close(reading)
        os.close(writing)


def _ways(question: Question) -> str:
    """`  (red, green; Enter for red)`."""
    ways = ", ".join(question.choices)
    if question.default is not None:
        ways += f"{'; ' if ways else ''}Enter for {question.default}"
    return f"  ({ways})" if ways else ""
