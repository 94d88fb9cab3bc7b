"""Compare two trees on the same seeds, with McNemar's test."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.bench.rows.outcome import succeeded
from momantu_bt.bench.rows.spec import Row
from momantu_bt.bench.statistics.intervals import Interval, mcnemar, paired_difference, quantile
from momantu_bt.formats.seeds import seeds_text


@dataclass(frozen=True, slots=True)
class Paired:
    """Seeds by which tree succeeded. slower: A's simulated time minus B's if both did, s."""

    both: tuple[int, ...]
    only_a: tuple[int, ...]
    only_b: tuple[int, ...]
    neither: tuple[int, ...]
    slower: tuple[float, ...]

    @classmethod
    def of(cls, rows_a: Sequence[Row], rows_b: Sequence[Row]) -> Paired:
        """The seeds that both have a row of."""
        others = {row["seed"]: row for row in rows_b}
        sorted_out: dict[tuple[bool, bool], list[int]] = {}
        slower = []
        for row in rows_a:
            other = others.get(row["seed"])
            if other is None:
                continue
            how = succeeded(row), succeeded(other)
            sorted_out.setdefault(how, []).append(row["seed"])
            if all(how):
                slower.append(row["sim_time_s"] - other["sim_time_s"])
        return cls(
            both=tuple(sorted_out.get((True, True), ())),
            only_a=tuple(sorted_out.get((True, False), ())),
            only_b=tuple(sorted_out.get((False, True), ())),
            neither=tuple(sorted_out.get((False, False), ())),
            slower=tuple(slower),
        )

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """The numbers of seeds: both, only A, only B, neither."""
        return len(self.both), len(self.only_a), len(self.only_b), len(self.neither)

    @property
    def pairs(self) -> int:
        """The number of seeds."""
        return sum(self.counts)

    @property
    def p(self) -> float:
        """McNemar's exact two-sided p."""
        return mcnemar(len(self.only_a), len(self.only_b))

    @property
    def difference(self) -> float:
        """Rate of A minus rate of B; 0 of no pairs."""
        return (len(self.only_a) - len(self.only_b)) / max(1, self.pairs)

    @property
    def interval(self) -> Interval:
        """95 % interval of the difference, Newcombe's for paired rates."""
        return paired_difference(*self.counts)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "pairs": self.pairs,
            "both": list(self.both),
            "only_a": list(self.only_a),
            "only_b": list(self.only_b),
            "neither": list(self.neither),
            "p": self.p,
            "difference": self.difference,
            "interval": list(self.interval),
            "slower_s": quantile(self.slower, 0.5) if self.slower else None,
        }


def paired_text(paired: Paired, name_a: str, name_b: str) -> str:
    """The table of pairs, its p-value and its interval."""
    both, only_a, only_b, neither = paired.counts
    width = max(len(name_a), len(name_b)) + len(" succeeded")
    low, high = paired.interval
    column = len(name_b) + len(" succeeded")
    lines = [
        f"on the same {paired.pairs} seeds:",
        f"  {'':{width}}  {name_b} succeeded  {name_b} failed",
        f"  {name_a + ' succeeded':{width}}  {both:{column}}  {only_a:{column - 3}}",
        f"  {name_a + ' failed':{width}}  {only_b:{column}}  {neither:{column - 3}}",
        f"chance that equally good trees differ so much: p = {paired.p:.3g} (McNemar's exact test, "
        "two-sided)",
        f"rate of {name_a} minus rate of {name_b}: {100 * paired.difference:+.1f} %, 95 % interval "
        f"{100 * low:+.1f} % to {100 * high:+.1f} % (Newcombe's, paired)",
    ]
    if paired.slower:
        lines.append(
            "simulated time where both succeeded, the one minus the other: median "
            f"{quantile(paired.slower, 0.5):+.1f} s"
        )
    for name, seeds in ((name_a, paired.only_a), (name_b, paired.only_b)):
        if seeds:
            lines.append(f"only {name} succeeded on seeds {seeds_text(seeds)}")
    return "\n".join(lines)
