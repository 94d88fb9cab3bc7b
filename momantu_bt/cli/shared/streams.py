"""Standard output and standard error that break without breaking the program.

What cannot be shown never stops a robot: once a stream cannot be written (its reader has gone, the
disk is full, the terminal has closed), the rest is dropped and told once.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TextIO

import typer

from momantu_bt.errors import ExitCode, MomantuError

_NAMES = {1: "standard output", 2: "standard error"}


class StreamError(MomantuError, OSError):
    """Standard output cannot be written, and a verb has nothing else to do."""

    exit_code = ExitCode.INTERNAL


class Dropping(io.FileIO):
    """A file that is open already; after the first error it takes everything and writes nothing.

    It writes to a descriptor of its own, so code that closes 1 or 2 does not close it.
    closed_before: the program began without it. keep_on: drop instead of raising. broken: the
    first error. on_break: called with it, once.
    """

    def __init__(self, number: int, closed_before: bool) -> None:
        super().__init__(os.dup(number), "w")
        self.number, self.closed_before = number, closed_before
        self.keep_on = number != 1
        self.broken: OSError | None = None
        self.on_break: Callable[[str], None] | None = None

    def write(self, data: bytes) -> int:  # type: ignore[override]
        """Write all of it, or drop it."""
        if self.broken is None:
            try:
                self._write_all(data)
            except OSError as error:
                if not self.keep_on and isinstance(error, BrokenPipeError):
                    raise
                if not self.keep_on:
                    name = _NAMES[self.number]
                    raise StreamError(f"{name} cannot be written: {error.strerror}") from None
                self.broken = error
                if self.on_break is not None:
                    self.on_break(self.told())
        return len(data)

    def close(self) -> None:
        """Stay open: a skill may close `sys.stdout`, which is not its own."""

    def told(self) -> str:
        """What became of it, in a sentence."""
        why = "" if self.broken is None else self.broken.strerror
        return f"{_NAMES[self.number]} cannot be written ({why}); nothing more is shown there"

    def _write_all(self, data: bytes) -> None:
        left = memoryview(data)
        while left:
            left = left[super().write(left) or 0 :]


def open_standard_streams(*, alone: bool = False) -> None:
    """Make standard output and error safe to write to; only for a process that is all ours.

    A descriptor that is closed is opened on nothing, so that no other file takes its number.
    Characters that a stream's encoding lacks become escapes. alone: what libraries and child
    processes write to standard output goes to standard error.
    """
    closed = [number for number in (0, 1, 2) if not _is_open(number)]
    for number in closed:
        nothing = os.open(os.devnull, os.O_RDWR)
        if nothing != number:
            os.dup2(nothing, number)
            os.close(nothing)
    if sys.stdin is None:
        sys.stdin = io.TextIOWrapper(io.FileIO(0, closefd=False))
    sys.stdout = _stream(sys.stdout, 1, 1 in closed)
    sys.stderr = _stream(sys.stderr, 2, 2 in closed)
    if alone:
        os.dup2(2, 1)


def keep_on(remark: Callable[[str], None]) -> None:
    """From now on nothing that is printed can raise.

    remark: called when standard output breaks, or at once if it is broken already.
    """
    raw = _raw(sys.stdout)
    if raw is not None:
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        raw.keep_on, raw.on_break = True, remark
        if raw.broken is not None:
            remark(raw.told())
        if raw.closed_before:
            remark("standard output is closed; nothing is shown there")


def say(text: str) -> None:
    """Print a line that must be seen: on standard error if standard output is broken."""
    raw = _raw(sys.stdout)
    if raw is None or raw.broken is None:
        typer.echo(text)
    if raw is not None and (raw.broken is not None or raw.closed_before):
        typer.echo(text, err=True)


def _raw(stream: TextIO) -> Dropping | None:
    raw = getattr(stream, "buffer", None)
    return raw if isinstance(raw, Dropping) else None


def _stream(stream: TextIO | None, number: int, closed: bool) -> TextIO:
    encoding = "utf-8" if stream is None else stream.encoding
    raw = Dropping(number, closed)
    # as with `python -u`: each text goes to the system at once, and nothing is left for the end
    return io.TextIOWrapper(
        raw,
        encoding=encoding,
        errors="backslashreplace",
        line_buffering=raw.isatty(),
        write_through=True,
    )


def _is_open(number: int) -> bool:
    try:
        os.fstat(number)
    except OSError:
        return False
    return True
