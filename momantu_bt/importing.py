"""Other people's code: what it prints goes to standard error, and an import that hangs is named."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SLOW = 5.0
"""Seconds of wall time after which an import that goes on is named."""


@contextmanager
def output_aside() -> Iterator[None]:
    """What is printed meanwhile goes to standard error, so that a verb's output stays its own."""
    out, sys.stdout = sys.stdout, sys.stderr
    try:
        yield
    finally:
        sys.stdout = out


@contextmanager
def importing(module: str, what: Callable[[], str]) -> Iterator[None]:
    """Around the import of a module: its output is put aside, and it is named when it is slow.

    what: says what is imported, such as "the skill 'turn' (turn.skill:Turn of turn)"; it is asked
    only then, since a package's name must be read from its files.
    """
    if module in sys.modules:
        yield
        return
    timer = threading.Timer(SLOW, _tell, (what,))
    timer.daemon = True
    timer.start()
    try:
        with output_aside():
            yield
    finally:
        timer.cancel()


def _tell(what: Callable[[], str]) -> None:
    print(f"momantu-bt: still importing {what()}; Ctrl-C ends it", file=sys.stderr, flush=True)
