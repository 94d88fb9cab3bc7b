"""The world `none`: a clock and nothing else."""

from __future__ import annotations

from momantu_bt.world import TICK


class NoWorld:
    """Ticks pass; there is no robot, no site, no referee."""

    def __init__(self) -> None:
        self._ticks = 0

    def now(self) -> float:
        """Seconds since the run began."""
        return self._ticks * TICK

    def step(self) -> None:
        """Advance by one tick."""
        self._ticks += 1
