"""What skills claimed over many episodes, against ground truth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.bench.spec import Row
from momantu_bt.bench.table import columns
from momantu_bt.formats.seeds import few_seeds

_LIES = "lies"
_COLUMNS = {
    "runs": "runs",
    "successes": "successes",
    "judged_successes": "judged",
    "false_successes": "false",
    "failures": "failures",
    "judged_failures": "judged",
    "false_failures": "false",
}
"""Counts of a report's claims, and what they are called in the table."""


@dataclass(slots=True)
class Claimed:
    """One skill. counts: the sums of a report's counts. lies: its false claims."""

    counts: Counter[str] = field(default_factory=Counter)
    lies: list[dict[str, Any]] = field(default_factory=list)

    def add(self, seed: int, told: Mapping[str, Any]) -> None:
        """Add the counts of one episode."""
        self.counts.update({name: count for name, count in told.items() if name != _LIES})
        self.lies += [{"seed": seed, **lie} for lie in told.get(_LIES, ())]

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {**self.counts, _LIES: self.lies}


def claims_of(rows: Iterable[Row]) -> dict[str, Claimed]:
    """Each skill's claims, by their names."""
    found: dict[str, Claimed] = {}
    for row in rows:
        for skill, told in (row.get("claims") or {}).items():
            found.setdefault(skill, Claimed()).add(row["seed"], told)
    return {skill: found[skill] for skill in sorted(found)}


def claims_text(claims: Mapping[str, Claimed]) -> list[str]:
    """A table; a skill's seeds are those on which it claimed a false success."""
    if not any(claimed.counts["judged_successes"] for claimed in claims.values()):
        return []
    rows = [("skill", *_COLUMNS.values(), "false successes")]
    for skill, claimed in claims.items():
        seeds = [lie["seed"] for lie in claimed.lies if lie["code"] is None]
        counts = [str(claimed.counts[name]) for name in _COLUMNS]
        rows.append((skill, *counts, few_seeds(seeds) if seeds else ""))
    return ["what skills claimed, judged by ground truth:", *columns(rows)]
