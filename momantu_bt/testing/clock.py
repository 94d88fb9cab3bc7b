"""A clock that the test advances."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class ManualClock:
    """`time` in seconds; `advance` is the only thing that moves it."""

    time: float = 0.0

    def now(self) -> float:
        """Seconds since the run began."""
        return self.time

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        self.time += seconds
