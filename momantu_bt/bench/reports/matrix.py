"""Print the matrix of faults: the outcome of each fault, over seeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.reports.tables import rate_text
from momantu_bt.bench.rows.outcome import Outcome, outcome
from momantu_bt.bench.rows.spec import IMPOSSIBLE, Row
from momantu_bt.bench.statistics.intervals import wilson
from momantu_bt.faults.matrix import Row as Demand
from momantu_bt.formats.seeds import seeds_text

_COUNTED = tuple(how for how in Outcome if how is not Outcome.IMPOSSIBLE)
_NOT_HAPPENED = (Outcome.NOT_MET, Outcome.IMPOSSIBLE)


@dataclass(frozen=True, slots=True)
class Line:
    """One fault. seeds: by outcome. why: the reason why it cannot happen, "" if it can."""

    demand: Demand
    seeds: Mapping[Outcome, Sequence[int]]
    why: str

    @property
    def met(self) -> int:
        """Episodes in which the fault happened."""
        return sum(len(seeds) for how, seeds in self.seeds.items() if how not in _NOT_HAPPENED)

    @property
    def recovered(self) -> int:
        """Episodes that succeeded in spite of it."""
        return len(self.seeds.get(Outcome.RECOVERED, ()))

    @property
    def impossible(self) -> bool:
        """Whether it could not happen on any seed."""
        return set(self.seeds) == {Outcome.IMPOSSIBLE}

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "fault": self.demand.fault,
            "recoverable": self.demand.recoverable,
            "notice_s": self.demand.notice,
            **{how.value: list(self.seeds.get(how, ())) for how in Outcome},
            "why": self.why,
        }


@dataclass(frozen=True, slots=True)
class Matrix:
    """Lines in the order of the requested faults."""

    lines: tuple[Line, ...]

    @classmethod
    def of(cls, demands: Sequence[Demand], rows: Sequence[Row]) -> Matrix:
        """The outcomes of these faults in the rows."""
        found: dict[str, dict[Outcome, list[int]]] = {demand.fault: {} for demand in demands}
        why = dict.fromkeys(found, "")
        for demand in demands:
            for row in rows:
                if row["fault"] == demand.fault:
                    found[demand.fault].setdefault(outcome(row, demand), []).append(row["seed"])
                    if row["ended"] == IMPOSSIBLE:
                        why[demand.fault] = row["output"]
        lines = [Line(each, found[each.fault], why[each.fault]) for each in demands]
        return cls(tuple(lines))

    @property
    def pooled(self) -> tuple[int, int]:
        """Recovered, and met, over all faults that a robot can recover from."""
        rows = [line for line in self.lines if line.demand.recoverable]
        return sum(line.recovered for line in rows), sum(line.met for line in rows)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        recovered, met = self.pooled
        return {
            "faults": [line.as_dict() for line in self.lines],
            "recoverable": {
                "episodes": met,
                "recovered": recovered,
                "interval": list(wilson(recovered, met)),
            },
        }


def matrix_text(matrix: Matrix) -> str:
    """The table, the pooled rate, and the seeds to look at."""
    rows = [["fault", *(how.value for how in _COUNTED), "notice within", "recoverable"]]
    for line in matrix.lines:
        if not line.impossible:
            counts = [str(len(line.seeds.get(how, ()))) for how in _COUNTED]
            demand = line.demand
            can = "yes" if demand.recoverable else "no"
            rows.append([demand.fault, *counts, f"{demand.notice:g} s", can])
    recovered, met = matrix.pooled
    pooled = rate_text(recovered, met, wilson(recovered, met))
    told = f"recovered from what can be recovered from: {pooled}"
    return "\n".join([*columns(rows), told, *_to_look_at(matrix)])


def _to_look_at(matrix: Matrix) -> Iterator[str]:
    """Seeds of unwanted outcomes, to run them again; and faults that cannot happen."""
    for how in (Outcome.UNSAFE, Outcome.WRONG_REASON):
        for line in matrix.lines:
            if seeds := line.seeds.get(how):
                yield f"{how.value}: {line.demand.fault} on seeds {seeds_text(seeds)}"
    for line in matrix.lines:
        if seeds := line.seeds.get(Outcome.IMPOSSIBLE):
            which = "" if line.impossible else f" on seeds {seeds_text(seeds)}"
            yield f"cannot happen{which}: {line.why}"
