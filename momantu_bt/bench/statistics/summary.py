"""Summarize many rows of one tree: rates, times, failures and claims."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from momantu_bt.bench.rows.outcome import succeeded
from momantu_bt.bench.rows.spec import IMPOSSIBLE, REPORT, Row
from momantu_bt.bench.statistics.blame import Blame, blame_table
from momantu_bt.bench.statistics.claims import Claimed, claims_of
from momantu_bt.bench.statistics.intervals import Interval, quantile, wilson


@dataclass(frozen=True, slots=True)
class Spread:
    """Median, 95th percentile and largest of some figures; NaN of none."""

    median: float
    p95: float
    largest: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """The spread of these values."""
        return cls(quantile(values, 0.5), quantile(values, 0.95), max(values, default=math.nan))

    def as_dict(self) -> dict[str, float | None]:
        """Plain data for JSON, which has no NaN."""
        named = {"median": self.median, "p95": self.p95, "largest": self.largest}
        return {key: None if math.isnan(value) else value for key, value in named.items()}


@dataclass(frozen=True, slots=True)
class Summary:
    """Figures of some rows.

    interval: Wilson's, of the success rate. sim_time_s: of successes. speed: simulated seconds per
    second of wall time. force: of each episode, the largest force with which the robot pushed
    anything but what it brings, N; strongest: the seed of the largest, and
    pushed: its link and body. tries: retries of nodes over
    all episodes. retried: number of episodes with a retry. claims: the auditor's counts per skill.
    ended: how the processes ended.
    """

    episodes: int
    successes: int
    interval: Interval
    sim_time_s: Spread
    speed: Spread
    memory_mb: Spread
    force: Spread
    strongest: int | None
    pushed: str
    tries: int
    retried: int
    blame: tuple[tuple[Blame, list[int]], ...]
    claims: dict[str, Claimed]
    incidents: dict[str, list[int]]
    ended: dict[str, int]

    @classmethod
    def of(cls, rows: Sequence[Row]) -> Summary:
        """The figures of these rows, without those of faults that cannot happen."""
        rows = [row for row in rows if row["ended"] != IMPOSSIBLE]
        good = [row for row in rows if succeeded(row)]
        told = [row for row in rows if row["ended"] == REPORT]
        tries = [row["tries"] for row in told]
        pushes = [(force, row) for row in told if (force := _force(row)) is not None]
        strongest = max(pushes, key=lambda push: (push[0], push[1]["seed"]), default=(0.0, None))[1]
        return cls(
            episodes=len(rows),
            successes=len(good),
            interval=wilson(len(good), len(rows)),
            sim_time_s=Spread.of([row["sim_time_s"] for row in good]),
            speed=Spread.of([_speed(row) for row in told if row["wall_time_s"] > 0.0]),
            memory_mb=Spread.of([row["memory_mb"] for row in rows if row["memory_mb"] is not None]),
            force=Spread.of([force for force, _ in pushes]),
            strongest=None if strongest is None else strongest["seed"],
            pushed="" if strongest is None else (strongest.get("causes") or {}).get("force", ""),
            tries=sum(tries),
            retried=sum(count > 0 for count in tries),
            blame=tuple(blame_table(rows)),
            claims=claims_of(told),
            incidents=_incidents(told),
            ended=dict(Counter(row["ended"] for row in rows)),
        )

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "episodes": self.episodes,
            "successes": self.successes,
            "interval": list(self.interval),
            "sim_time_s": self.sim_time_s.as_dict(),
            "speed": self.speed.as_dict(),
            "memory_mb": self.memory_mb.as_dict(),
            "force": {**self.force.as_dict(), "seed": self.strongest, "bodies": self.pushed},
            "tries": self.tries,
            "retried": self.retried,
            "blame": [
                {"node": b.node, "place": b.place, "code": b.code, "seeds": seeds}
                for b, seeds in self.blame
            ],
            "claims": {skill: each.as_dict() for skill, each in self.claims.items()},
            "incidents": self.incidents,
            "ended": self.ended,
        }


def _speed(row: Row) -> float:
    speed: float = row["sim_time_s"] / row["wall_time_s"]
    return speed


def _force(row: Row) -> float | None:
    """The largest force that the referee saw, N; None without a referee."""
    force: float | None = (row.get("measures") or {}).get("force")
    return force


def _incidents(rows: Iterable[Row]) -> dict[str, list[int]]:
    """Seeds by kind of incident, a seed for each of its incidents."""
    found: dict[str, list[int]] = {}
    for row in rows:
        for incident in row.get("incidents") or ():
            found.setdefault(incident["kind"], []).append(row["seed"])
    return {kind: found[kind] for kind in sorted(found)}
