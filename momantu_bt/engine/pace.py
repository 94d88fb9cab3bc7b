"""The pace of a run in real time: it never goes faster than the wall clock."""

from __future__ import annotations

import time

LATE = 0.1
"""Delay that is caught up, s. After a longer one the run goes on from there: it does not hurry,
which would make a robot jump for whoever watches or drives it."""


class Pace:
    """Holds a run back until the wall clock has come as far as the world's clock."""

    def __init__(self) -> None:
        self._began = time.perf_counter()

    def hold(self, now: float) -> None:
        """Wait as long as the world's clock, at `now` s, is ahead."""
        late = time.perf_counter() - (self._began + now)
        if late > LATE:
            self._began += late
        elif late < 0.0:
            time.sleep(-late)
