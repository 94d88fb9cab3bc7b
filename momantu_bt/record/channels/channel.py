"""The base class of channels: each writes its own messages when they are due."""

from __future__ import annotations

from typing import Protocol

from momantu_bt.engine.executor import Executor
from momantu_bt.record.mcap.file import McapFile

_SLACK = 1e-6


class Channel(Protocol):
    """One part of a record, such as the robot's pose."""

    def write(self, run: Executor, file: McapFile) -> None:
        """Write what is new after a tick, if anything is due."""
        ...


class Due:
    """Says when it is time, at a rate in the world's clock."""

    def __init__(self, rate: float) -> None:
        self._period = 1.0 / rate
        self._next = 0.0

    def __call__(self, now: float) -> bool:
        """Whether it is time; after True, not again for a period."""
        if now < self._next - _SLACK:
            return False
        self._next = now + self._period
        return True


def stamp_of(now: float) -> int:
    """Seconds as a stamp of MCAP, ns."""
    return round(now * 1e9)


def time_text(now: float) -> str:
    """Seconds as JSON, in the form for viewers."""
    whole, part = divmod(round(now * 1e9), 1_000_000_000)
    return f'{{"sec":{whole},"nsec":{part}}}'
