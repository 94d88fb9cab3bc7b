"""Find what failed over many episodes: the innermost node, its line and its code."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from momantu_bt.bench.rows.outcome import succeeded
from momantu_bt.bench.rows.spec import REPORT, Row
from momantu_bt.engine.ending import ERROR
from momantu_bt.failure import HALTED

REFEREE = "the referee"
"""Who is to blame where the tree succeeded and ground truth denies it."""
_NUMBER = re.compile(r"-?\d+(\.\d+)?")


@dataclass(frozen=True, slots=True)
class Blame:
    """node: its name, or "the referee", "the engine", "the process". place: `file:line` or "".

    place is that of the goal if the referee denies the success. code: of the failure, or a sentence
    whose numbers are `#`.
    """

    node: str
    place: str
    code: str


def blame(row: Row) -> Blame:
    """Whom a failed row blames."""
    if row["ended"] != REPORT:
        code = row["exit_code"]
        how = "its workers died" if code is None else f"exit code {code}"
        return Blame("the process", "", f"{row['ended']}, {how}")
    if row["status"] == ERROR:
        last = (row["error"] or "").strip().rpartition("\n")[2]
        return Blame("the engine", "", general(last))
    failure = row["failure"]
    if failure is not None:
        link = innermost(failure)
        name, _, line = link["place"].rpartition(":")
        return Blame(link["node"], f"{PurePath(name).name}:{line}", link["code"])
    unmet = row["unmet"] or [f"the run was {row['status']}"]
    demands = sorted(row.get("demands") or (), key=lambda demand: bool(demand["met"]))
    place = demands[0]["place"] if demands else ""
    return Blame(REFEREE, place, "; ".join(general(sentence) for sentence in unmet))


def innermost(failure: Mapping[str, Any]) -> Mapping[str, Any]:
    """The last cause of a chain that failed on its own, not through a time limit."""
    link = failure
    while link["cause"] is not None and link["cause"]["code"] != HALTED:
        link = link["cause"]
    return link


def general(sentence: str) -> str:
    """A sentence without its numbers, so that equal reasons are equal."""
    return _NUMBER.sub("#", sentence)


def blame_table(rows: Iterable[Row]) -> list[tuple[Blame, list[int]]]:
    """Each blame with the seeds it has, the most frequent first."""
    found: dict[Blame, list[int]] = {}
    for row in rows:
        if not succeeded(row):
            found.setdefault(blame(row), []).append(row["seed"])
    return sorted(found.items(), key=lambda pair: (-len(pair[1]), pair[0].code, pair[0].place))
