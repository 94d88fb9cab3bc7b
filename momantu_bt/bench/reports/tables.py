"""The results of a bench as text: rows, rates, spreads, failures and claims."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from momantu_bt.bench.reports.table import columns
from momantu_bt.bench.rows.outcome import succeeded
from momantu_bt.bench.rows.spec import IMPOSSIBLE, REPORT, Row
from momantu_bt.bench.statistics.blame import REFEREE, blame
from momantu_bt.bench.statistics.claims import Claimed
from momantu_bt.bench.statistics.summary import Spread, Summary
from momantu_bt.formats.seeds import few_seeds

_CLAIM_COUNTS = {
    "runs": "runs",
    "successes": "successes",
    "judged_successes": "judged",
    "false_successes": "false",
    "failures": "failures",
    "judged_failures": "judged",
    "false_failures": "false",
}
"""Counts of a report's claims, and their names in the table."""


def row_text(row: Row) -> str:
    """One line: seed, how it ended, times, and why it failed."""
    name = f"seed {row['seed']}" + (f" {row['fault']}" if row["fault"] else "")
    if row["ended"] == IMPOSSIBLE:
        return f"{row['tree']} {name}: {row['output']}"
    if row["ended"] != REPORT:
        return f"{row['tree']} {name}: {row['ended']} after {row['process_time_s']:.0f} s"
    good = succeeded(row)
    how = row["outcome"] or ("success" if good else "FAILED ")
    line = (
        f"{row['tree']} {name}: {how} {row['sim_time_s']:6.1f} s "
        f"simulated in {row['process_time_s']:.1f} s, {row['memory_mb']:.0f} MB"
    )
    if good:
        return line
    why = blame(row)
    return f"{line}  {why.code} in {why.node}" + (f" ({why.place})" if why.place else "")


def rate_text(successes: int, episodes: int, interval: tuple[float, float]) -> str:
    """`99 of 100, 99.0 % (95 % interval 94.6 % to 99.8 %)`."""
    if episodes == 0:
        return "no episode yet"
    low, high = interval
    return (
        (
            f"{successes} of {episodes}, {successes / episodes:.1%} "
            f"(95 % interval {low:.1%} to {high:.1%})"
        )
        .replace("%", " %")
        .replace("95  %", "95 %")
    )


def summary_text(name: str, summary: Summary) -> str:
    """All figures of one tree; tables that would be empty are left out."""
    lines = [f"{name}: {rate_text(summary.successes, summary.episodes, summary.interval)}"]
    lines += _figures(summary)
    lines += _blame(summary)
    lines += _claims_text(summary.claims)
    if summary.incidents:
        lines.append("incidents, by the referee:")
        lines += [
            f"  {kind}: {len(seeds)} in {few_seeds(seeds)}"
            for kind, seeds in summary.incidents.items()
        ]
    return "\n".join(lines)


def _figures(summary: Summary) -> Iterator[str]:
    times = summary.sim_time_s
    if not math.isnan(times.median):
        yield (
            f"  simulated time of successes: median {times.median:.1f} s, "
            f"95th percentile {times.p95:.1f} s, longest {times.largest:.1f} s"
        )
    if not math.isnan(summary.speed.median):
        yield f"  simulated seconds per second of wall time: median {summary.speed.median:.1f}"
    yield f"  retries: {summary.tries}, in {summary.retried} of {summary.episodes} episodes"
    if summary.strongest is not None:
        bodies = f", {summary.pushed}" if summary.pushed else ""
        yield (
            f"  force of contacts: 95th percentile {summary.force.p95:.0f} N, "
            f"largest {summary.force.largest:.0f} N (seed {summary.strongest}{bodies})"
        )
    if summary.episodes:
        yield f"  memory of a process: {_memory(summary.memory_mb)}"
    odd = {how: count for how, count in summary.ended.items() if how != REPORT}
    if odd:
        yield "  processes without a report: " + ", ".join(f"{n} {how}" for how, n in odd.items())


def _memory(spread: Spread) -> str:
    return f"median {spread.median:.0f} MB, largest {spread.largest:.0f} MB"


def _blame(summary: Summary) -> list[str]:
    if not summary.blame:
        return []
    failures = summary.episodes - summary.successes
    rows = [("share", "failures", "code", "node", "line", "seeds")]
    for each, seeds in summary.blame:
        share = f"{len(seeds) / failures:.0%}".replace("%", " %")
        rows.append((share, str(len(seeds)), each.code, each.node, each.place, few_seeds(seeds)))
    lines = ["why it failed:", *columns(rows)]
    if summary.successes == 0 and all(each.node == REFEREE for each, _ in summary.blame):
        lines.append(
            "the tree never failed: if the goal is another job than this tree's, give it with "
            "--goal; --no-referee counts what the tree says"
        )
    return lines


def _claims_text(claims: Mapping[str, Claimed]) -> list[str]:
    """A table; a skill's seeds are those on which it claimed a false success."""
    if not any(claimed.counts["judged_successes"] for claimed in claims.values()):
        return []
    rows = [("skill", *_CLAIM_COUNTS.values(), "false successes")]
    for skill, claimed in claims.items():
        seeds = [lie["seed"] for lie in claimed.lies if lie["code"] is None]
        counts = [str(claimed.counts[name]) for name in _CLAIM_COUNTS]
        rows.append((skill, *counts, few_seeds(seeds) if seeds else ""))
    return ["what skills claimed, judged by ground truth:", *columns(rows)]
