"""Compare what skills claimed over many episodes with ground truth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from momantu_bt.bench.rows.spec import Row

_LIES = "lies"


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
