"""Episodes as processes of this machine."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterable, Iterator

from momantu_bt.bench.episodes.process import EpisodeProcess
from momantu_bt.bench.rows.spec import EpisodeSpec, Row

PAUSE = 0.05
"""Seconds between two checks of the processes."""


class LocalEngine:
    """Implements `Engine`; `jobs` processes at a time."""

    def __init__(self, jobs: int) -> None:
        self._jobs = jobs
        self._running: list[EpisodeProcess] = []

    @property
    def workers(self) -> int:
        """The number of processes at a time."""
        return self._jobs

    def running(self) -> tuple[EpisodeSpec, ...]:
        """Episodes that are under way."""
        return tuple(each.spec for each in self._running)

    def run(self, specs: Iterable[EpisodeSpec]) -> Generator[Row, None, None]:
        """Rows as episodes end; whatever runs is killed when the generator is closed."""
        waiting = iter(specs)
        try:
            while self._fill(waiting):
                ended = self._ended()
                yield from ended
                if not ended:
                    time.sleep(PAUSE)
        finally:
            while self._running:
                self._running.pop().kill()

    def _fill(self, waiting: Iterator[EpisodeSpec]) -> bool:
        """Start as many as there is room for; whether anything runs."""
        while len(self._running) < self._jobs:
            spec = next(waiting, None)
            if spec is None:
                break
            self._running.append(EpisodeProcess(spec))
        return bool(self._running)

    def _ended(self) -> list[Row]:
        rows: list[Row] = []
        for each in list(self._running):
            row = each.poll()
            if row is not None:
                self._running.remove(each)
                rows.append(row)
        return rows
