"""Ctrl-C and SIGTERM: noted when they arrive, handled between two ticks.

So native code (a planner, a renderer) is never interrupted. Before the first tick, and on a second
signal, a KeyboardInterrupt is raised at once.
"""

from __future__ import annotations

import signal
import threading
from types import FrameType
from typing import Any

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """A context manager that catches the signals. Outside the main thread it does nothing.

    requested: a signal has arrived. patient: handle it between two ticks; else at once.
    """

    def __init__(self) -> None:
        self.requested = False
        self.patient = False
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread():
            for number in _SIGNALS:
                self._before[number] = signal.signal(number, self._note)
        return self

    def __exit__(self, *exception: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()

    def _note(self, number: int, frame: FrameType | None) -> None:
        again, self.requested = self.requested, True
        if again or not self.patient:
            raise KeyboardInterrupt
