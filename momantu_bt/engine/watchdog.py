"""The watchdog: ends what hangs, by wall time.

A skill's step in Python that takes longer than the run's patience is left by an exception that a
signal raises. What hangs elsewhere, or in native code, where no handler of a signal ever runs,
ends the process: faulthandler's own thread needs no lock of the interpreter's. It writes where
each thread is to standard error and exits with code 1.
"""

from __future__ import annotations

import faulthandler
import math
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

PATIENCE = 60.0
"""Seconds of wall time that one step of a skill may take."""
LAST = 1.5
"""Times the patience, after which a tick that is not over ends the process."""
_FRESH = 0.05
"""Share of the patience for which the last net is not stretched anew: that costs a thread."""
_STDERR = 2


class Hung(BaseException):
    """Raised within a step of a skill; no Exception, which the skill might catch."""


class Watchdog:
    """While it is entered it watches. Outside the main thread, and with no end of patience, never.

    SIGALRM, its timer and faulthandler's are given back afterwards as they were found.
    """

    def __init__(self, patience: float = math.inf) -> None:
        self.patience = patience
        self._on = False
        self._in_step = self._rung = False
        self._stretched = -math.inf
        self._before: Any = None
        self._timer_before = (0.0, 0.0)
        self._entered = 0.0

    def __enter__(self) -> Watchdog:
        in_main = threading.current_thread() is threading.main_thread()
        if in_main and math.isfinite(self.patience):
            self._entered = time.monotonic()
            self._timer_before = signal.setitimer(signal.ITIMER_REAL, 0.0)
            self._before = signal.signal(signal.SIGALRM, self._rang)
            self._on = True
            self.beat()
        return self

    def __exit__(self, *exception: object) -> None:
        if not self._on:
            return
        self._on = False
        faulthandler.cancel_dump_traceback_later()
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, self._before)
        left, interval = self._timer_before
        if left > 0.0:
            left = max(1e-3, left - (time.monotonic() - self._entered))
            signal.setitimer(signal.ITIMER_REAL, left, interval)

    def beat(self) -> None:
        """The run goes on."""
        if self._on and time.monotonic() - self._stretched > _FRESH * self.patience:
            self._stretch()

    def begin_step(self) -> None:
        """A skill is about to make a step, or to be closed."""
        if self._on:
            self._in_step, self._rung = True, False
            signal.setitimer(signal.ITIMER_REAL, self.patience, self.patience)

    def end_step(self) -> None:
        """It is back."""
        if self._on:
            self._in_step = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Do not count this time: the run waits for a person."""
        if self._on:
            faulthandler.cancel_dump_traceback_later()
        try:
            yield
        finally:
            if self._on:
                self._stretch()

    def _stretch(self) -> None:
        self._stretched = time.monotonic()
        faulthandler.dump_traceback_later(LAST * self.patience, exit=True, file=_STDERR)

    def _rang(self, number: int, frame: FrameType | None) -> None:
        if not self._in_step:
            return
        if not self._rung:
            self._rung = True
            self._stretch()  # once, for what the skill does to close itself
        raise Hung
