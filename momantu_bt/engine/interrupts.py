"""Ctrl-C, SIGTERM and SIGHUP: noted when they arrive, handled between two ticks.

So native code (a planner, a renderer) is never interrupted. Before the first tick, and on a second
signal, a StopRequested is raised at once. SIGHUP comes when the terminal closes; a process that
ignores it, as under `nohup`, goes on ignoring it.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

from momantu_bt.errors import StopRequested

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupts:
    """A context manager that catches the signals. Outside the main thread it does nothing.

    requested: a signal has arrived. by: the name of the first, such as SIGTERM.
    patient: handle it between two ticks; else at once.
    """

    def __init__(self) -> None:
        self.requested = False
        self.patient = False
        self.by: str | None = None
        self._before: dict[signal.Signals, Any] = {}
        self._handler: Callable[[int, FrameType | None], None] = self._note

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            for number in _SIGNALS:
                if number is signal.SIGHUP and signal.getsignal(number) is signal.SIG_IGN:
                    continue
                self._before[number] = signal.signal(number, self._handler)
        return self

    def __exit__(self, *exception: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()

    @property
    def caught(self) -> bool:
        """Whether it catches the signals, so that they reach the run as StopRequested only."""
        return bool(self._before)

    def hold(self) -> tuple[str, ...]:
        """Take back the signals whose handlers other code has changed; returns their names."""
        taken = [n for n in self._before if signal.getsignal(n) is not self._handler]
        for number in taken:
            signal.signal(number, self._handler)
        return tuple(number.name for number in taken)

    def begin_again(self) -> None:
        """Forget the request: from now on the next signal is noted, and the one after it raises."""
        self.requested, self.patient = False, True

    def _note(self, number: int, frame: FrameType | None) -> None:
        again, self.requested = self.requested, True
        self.by = self.by or signal.Signals(number).name
        if again or not self.patient:
            raise StopRequested
