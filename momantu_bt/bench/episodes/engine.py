"""The interface of whatever runs episodes: processes of this machine, or of a cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import Protocol

from momantu_bt.bench.rows.spec import EpisodeSpec, Row
from momantu_bt.errors import MomantuError


class EngineError(MomantuError):
    """An engine cannot run episodes; the message says why and what to do."""


class Engine(Protocol):
    """Runs episodes, several at a time."""

    @property
    def workers(self) -> int:
        """The number of episodes at a time; 0 while unknown."""
        ...

    def running(self) -> tuple[EpisodeSpec, ...]:
        """Those that are under way, oldest first."""
        ...

    def run(self, specs: Iterable[EpisodeSpec]) -> Generator[Row, None, None]:
        """Rows in the order in which episodes end; each requested episode has one.

        If an episode could not begin, its row has `ended` "refused", and `output` says why.
        Closing the generator, or an exception in it, ends everything that runs.

        Raises:
            EngineError: the machine or cluster that runs the episodes is missing or was lost.
        """
        ...
