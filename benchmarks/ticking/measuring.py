"""The cost of several ticks, measured in turn so that a slow moment of the machine hits all.

It is CPU time, which other programs on the machine disturb less than wall time.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from typing import TypeAlias

Tick: TypeAlias = Callable[[], object]

LEAST_TIME = 0.01
"""Seconds that one round of one side takes at least."""


def measured(sides: Mapping[str, Tick], rounds: int) -> dict[str, list[float]]:
    """CPU seconds of a tick by side, of each round."""
    times = {name: max(1, int(LEAST_TIME / seconds(tick, 3))) for name, tick in sides.items()}
    found: dict[str, list[float]] = {name: [] for name in sides}
    for _ in range(rounds):
        for name, tick in sides.items():
            found[name].append(seconds(tick, times[name]))
    return found


def seconds(tick: Tick, times: int) -> float:
    """CPU seconds of a tick, on average."""
    started = time.process_time()
    for _ in range(times):
        tick()
    return (time.process_time() - started) / times


def ratio(above: list[float], below: list[float]) -> float:
    """The median of the ratios of two sides, round by round."""
    return statistics.median(a / b for a, b in zip(above, below, strict=True))
