"""Run the missing episodes of a plan, and write their rows to disk."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Protocol

from momantu_bt.bench.episodes.engine import Engine
from momantu_bt.bench.planning.plan import RECORDS, Plan, record_name
from momantu_bt.bench.rows.outcome import Outcome, outcome_of, succeeded
from momantu_bt.bench.rows.spec import REFUSED, EpisodeSpec, Row
from momantu_bt.bench.rows.store import Store
from momantu_bt.engine.interrupts import Interrupts

MOST_REFUSED = 3
"""After this many consecutive episodes that cannot begin, the bench stops."""


class Watcher(Protocol):
    """Shows a bench while it runs."""

    def begin(self, rows: Sequence[Row], waiting: int, engine: Engine) -> None:
        """rows: those that were there already; waiting: how many episodes are to be run."""
        ...

    def row(self, row: Row) -> None:
        """An episode ended."""
        ...

    def close(self) -> None:
        """The bench is over; safe to call twice."""
        ...


@dataclass(slots=True)
class Ended:
    """How a bench ended.

    refused: rows of the episodes that could not begin. refused_in_a_row: the latest of them, since
    the last episode that did begin.
    """

    interrupted: bool = False
    refused: list[Row] = field(default_factory=list)
    refused_in_a_row: list[Row] = field(default_factory=list)


def carry_out(work: Sequence[tuple[Plan, Store]], engine: Engine, watcher: Watcher) -> Ended:
    """Run the missing episodes, the trees in turn, and add each row to its store when it ends.

    Raises:
        OutputError: a row cannot be written; the rows before it are written.
    """
    asked = [plan.specs(store.rows, store.folder) for plan, store in work]
    homes = {spec.key: pair for specs, pair in zip(asked, work, strict=True) for spec in specs}
    waiting = _turn_about(asked)
    there = [row for plan, store in work for row in plan.wanted.present(store.rows)]
    watcher.begin(there, len(waiting), engine)
    ended = Ended()
    with Interrupts() as interrupts:
        try:
            with closing(engine.run(waiting)) as rows:
                for row in rows:
                    interrupts.patient = True  # first keep a row that has arrived
                    _take(row, *homes[row["key"]], ended)
                    watcher.row(row)
                    interrupts.patient = False
                    if interrupts.requested:
                        raise KeyboardInterrupt
                    if len(ended.refused_in_a_row) >= MOST_REFUSED:
                        break
        except KeyboardInterrupt:
            ended.interrupted = True
        finally:
            watcher.close()
    return ended


def _turn_about(asked: Sequence[Sequence[EpisodeSpec]]) -> list[EpisodeSpec]:
    """The first of each, the second of each, and so on."""
    return [spec for turn in zip_longest(*asked) for spec in turn if spec is not None]


def _take(row: Row, plan: Plan, store: Store, ended: Ended) -> None:
    """Store a row, and its record if wanted; a refused episode is not stored."""
    if row["ended"] == REFUSED:
        ended.refused_in_a_row.append(row)
        ended.refused.append(row)
        return
    ended.refused_in_a_row.clear()
    row["outcome"] = outcome_of(row)
    store.add(row)
    fine = succeeded(row) and row["outcome"] in (None, Outcome.RECOVERED)
    if plan.record == "failures" and fine:
        name = record_name(row["seed"], row["fault"], row["key"])
        shutil.rmtree(store.folder / RECORDS / name, ignore_errors=True)
