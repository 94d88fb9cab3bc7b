"""Episodes on the machines of a Ray cluster, or as tasks of a Ray of this machine alone."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from momantu_bt.bench.episodes.engine import EngineError
from momantu_bt.bench.episodes.parcel import Parcel
from momantu_bt.bench.episodes.ray_cluster import cluster
from momantu_bt.bench.episodes.ray_task import errand, order
from momantu_bt.bench.rows.spec import CRASHED, REFUSED, EpisodeSpec, Row
from momantu_bt.formats.files import OutputError

MOST_DEATHS = 3
"""When this many workers have died while running one episode, it counts as crashed."""
_PAUSE = 0.5
"""Seconds between two checks for more machines."""
_GRACE = 10.0
"""Seconds that workers have to end their episodes when the bench ends."""


@dataclass(slots=True)
class _Task:
    """An episode that a worker runs. deaths: why earlier workers did not finish it."""

    spec: EpisodeSpec
    begun: float = field(default_factory=time.monotonic)
    deaths: list[str] = field(default_factory=list)


class RayEngine:
    """Implements `Engine`: one task for each episode, which starts its process where it is.

    jobs: episodes at a time; None for as many as there are processors. address: as `cluster`
    takes it. If a worker or a machine dies, its episode starts again elsewhere. An episode that
    takes down every worker gets a row with `ended` "crashed".
    """

    def __init__(self, jobs: int | None, address: str | None = None) -> None:
        self._jobs, self._address = jobs, address
        self._workers = jobs or (0 if address else os.cpu_count() or 1)
        self._tasks: dict[Any, _Task] = {}
        self._parcels: dict[str, Parcel] = {}

    @property
    def workers(self) -> int:
        """How many episodes run at a time; 0 until the cluster has reported its size."""
        return self._workers

    def running(self) -> tuple[EpisodeSpec, ...]:
        """Episodes that workers have."""
        return tuple(task.spec for task in self._tasks.values())

    def run(self, specs: Iterable[EpisodeSpec]) -> Generator[Row, None, None]:
        """Yield rows as episodes end; closing the iterator ends all that runs.

        Raises:
            EngineError: Ray is not installed, or the cluster cannot be reached.
        """
        waiting = iter(specs)
        with cluster(self._address, self._workers) as ray:
            remote = ray.remote(num_cpus=1, max_retries=0)(errand())
            try:
                while self._fill(ray, remote, waiting):
                    ended, _ = ray.wait(list(self._tasks), timeout=_PAUSE)
                    for reference in ended:
                        row = self._collect(ray, remote, reference)
                        if row is not None:
                            yield row
            except ray.exceptions.RayError as error:
                raise EngineError(f"the Ray cluster was lost: {error}") from error
            finally:
                self._cancel(ray)

    def _fill(self, ray: Any, remote: Any, waiting: Iterator[EpisodeSpec]) -> bool:
        """Give out as many as there are processors now; whether any episode is under way."""
        processors = int(ray.cluster_resources().get("CPU", 0))
        self._workers = max(1, min(self._jobs or processors, processors))
        while len(self._tasks) < self._workers:
            spec = next(waiting, None)
            if spec is None:
                break
            self._give(remote, _Task(spec))
        return bool(self._tasks)

    def _give(self, remote: Any, task: _Task) -> None:
        tree = task.spec.tree
        if tree not in self._parcels:
            self._parcels[tree] = Parcel.of(tree)
        self._tasks[remote.remote(order(task.spec, self._parcels[tree]))] = task

    def _collect(self, ray: Any, remote: Any, reference: Any) -> Row | None:
        """The row of a task that ended; None where its worker died and another has it now."""
        task = self._tasks.pop(reference)
        try:
            answer: Mapping[str, Any] = ray.get(reference)
        except ray.exceptions.RayError as error:
            task.deaths.append(str(error).strip().partition("\n")[0])
            if len(task.deaths) < MOST_DEATHS:
                self._give(remote, task)
                return None
            told = f"{MOST_DEATHS} workers died under this episode: {'; '.join(task.deaths)}"
            return _row_without(task, CRASHED, told)
        if "refused" in answer:
            return _row_without(task, REFUSED, answer["refused"])
        _keep(answer["record"], task.spec)
        row: Row = answer["row"]
        return row

    def _cancel(self, ray: Any) -> None:
        """End all episodes: workers are asked to stop, and those that do not are killed."""
        references = list(self._tasks)
        self._tasks.clear()
        for force, grace in ((False, _GRACE), (True, _GRACE)):
            for reference in references:
                ray.cancel(reference, force=force)
            if references:
                _, references = ray.wait(references, num_returns=len(references), timeout=grace)


def _row_without(task: _Task, ended: str, told: str) -> Row:
    """The row of an episode that no process brought to its end."""
    return {
        **task.spec.row(),
        "exit_code": None,
        "ended": ended,
        "output": told,
        "memory_mb": None,
        "process_time_s": round(time.monotonic() - task.begun, 3),
        "unix_time": round(time.time(), 3),
    }


def _keep(record: Mapping[str, bytes], spec: EpisodeSpec) -> None:
    """Put a record where the bench wants it; OutputError when that is not possible."""
    if spec.record is None:
        return
    folder = Path(spec.record)
    shutil.rmtree(folder, ignore_errors=True)
    try:
        for name, data in record.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written: {error.strerror or error}") from None
