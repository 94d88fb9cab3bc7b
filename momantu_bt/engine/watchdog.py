"""The watchdog: ends steps that hang, by wall time.

If a skill's step in Python takes longer than the run's limit, the `patience`, a signal raises an
exception in it. Time for which the step could have run, but other processes had the cores, does not
count: a busy machine is no reason to fail. Signal handlers do not run in native code. So for native
code, and for hangs outside of skills, faulthandler's thread ends the process; it does not need the
interpreter's lock. It writes the stack of each thread to standard error and exits with code 1.
"""

from __future__ import annotations

import faulthandler
import math
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

PATIENCE = 60.0
"""Default limit of wall time for one step of a skill, s."""
LAST = 1.5
"""A tick that takes longer than this factor times the patience ends the process."""
_FRESH = 0.05
"""The faulthandler's timer is restarted at most once per this share of the patience.

Each restart costs a new thread.
"""
_LEAST = 0.02
"""Time that is left, s, for which it is not worth to wait on."""
_STDERR = 2
_SCHEDULED = Path("/proc/self/schedstat")
"""What Linux tells of the main thread: ns on a core, ns ready to run and waiting for one, ..."""


class Hung(BaseException):
    """Raised inside a skill's step. It is not an Exception, so that the skill does not catch it."""


class Watchdog:
    """A context manager that watches. It does nothing outside the main thread or without a limit.

    At the end it restores SIGALRM's handler, its timer and that of faulthandler.
    """

    def __init__(self, patience: float = math.inf) -> None:
        self.patience = patience
        self._on = False
        self._in_step = self._rung = False
        self._stretched = -math.inf
        self._before: Any = None
        self._timer_before = (0.0, 0.0)
        self._entered = 0.0
        self._begun, self._waited = 0.0, 0.0

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
        """Report that the run makes progress."""
        if self._on and time.monotonic() - self._stretched > _FRESH * self.patience:
            self._stretch()

    def begin_step(self) -> None:
        """Report that a skill will make a step or will be closed."""
        if self._on:
            self._in_step, self._rung = True, False
            self._begun = time.monotonic()
            signal.setitimer(signal.ITIMER_REAL, self.patience, self.patience)

    def end_step(self) -> None:
        """Report that the skill's step is over."""
        if self._on:
            self._in_step = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Do not count the time inside this context, while the run waits for a person."""
        if self._on:
            faulthandler.cancel_dump_traceback_later()
        try:
            yield
        finally:
            if self._on:
                self._stretch()

    def _stretch(self) -> None:
        self._stretched, self._waited = time.monotonic(), waited_for_a_core()
        faulthandler.dump_traceback_later(LAST * self.patience, exit=True, file=_STDERR)

    def _rang(self, number: int, frame: FrameType | None) -> None:
        if not self._in_step:
            return
        busy = waited_for_a_core() - self._waited
        left = self.patience - (time.monotonic() - self._begun - busy)
        if left > _LEAST and not self._rung:
            self._begun += busy
            self._stretch()
            signal.setitimer(signal.ITIMER_REAL, left, self.patience)
            return
        if not self._rung:
            self._rung = True
            self._stretch()  # once more, for the skill's own clean-up
        raise Hung


def waited_for_a_core() -> float:
    """Time for which this process was ready to run and no core was free, s; 0 if unknown."""
    try:
        return int(_SCHEDULED.read_text(encoding="ascii").split()[1]) * 1e-9
    except (OSError, ValueError, IndexError):
        return 0.0
