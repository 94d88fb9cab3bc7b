"""Decide the outcome of a row: success or failure, and the result of a fault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from enum import StrEnum
from typing import Any

from momantu_bt.bench.rows.spec import HUNG, IMPOSSIBLE, REPORT, Row
from momantu_bt.engine.ending import SUCCESS
from momantu_bt.faults.matrix import Row as Demand
from momantu_bt.faults.matrix import row_of
from momantu_bt.faults.spec import parse_fault


class Outcome(StrEnum):
    """The outcome of an episode with a fault."""

    RECOVERED = "recovered"
    """the tree succeeded all the same, and no referee denies it"""
    SAFE = "safe"
    """it ended without danger, and named a true reason"""
    UNSAFE = "unsafe"
    """danger after the fault could be noticed, a false success, or a hang"""
    WRONG_REASON = "wrong reason"
    """it ended without danger, but with none of the true reasons"""
    NOT_MET = "not met"
    """the fault's time never came"""
    IMPOSSIBLE = "impossible"
    """this tree, robot or world cannot have the fault"""


def succeeded(row: Row) -> bool:
    """Whether the tree succeeded and no referee denies it, as `run`'s exit code 0 says."""
    return bool(row["ended"] == REPORT and row["status"] == SUCCESS and row["success"] is not False)


def outcome(row: Row, demand: Demand) -> Outcome:
    """The outcome of a row's fault, by the requirements of its kind."""
    if row["ended"] == IMPOSSIBLE:
        return Outcome.IMPOSSIBLE
    if row["ended"] != REPORT:
        from_outside = row["ended"] == HUNG and row["exit_code"] < 0
        ends = demand.kind.ends_process and not from_outside
        return Outcome.SAFE if ends else Outcome.UNSAFE
    begun = [fault["began"] for fault in row["faults"] if fault["began"] is not None]
    if not begun:
        return Outcome.NOT_MET
    noticed = min(begun) + demand.notice
    if any(incident["time"] > noticed for incident in row["incidents"]):
        return Outcome.UNSAFE
    if row["status"] == SUCCESS:
        return Outcome.UNSAFE if row["success"] is False else Outcome.RECOVERED
    true = demand.reasons & set(_codes(row["failure"]))
    return Outcome.SAFE if true else Outcome.WRONG_REASON


def outcome_of(row: Row) -> Outcome | None:
    """The outcome of a row's fault, None without one."""
    return None if row["fault"] is None else outcome(row, row_of(parse_fault(row["fault"])))


def _codes(failure: Mapping[str, Any] | None) -> Iterator[str]:
    """All codes of a chain, of what led to it and of what was tried before it."""
    waiting = [failure]
    while waiting:
        link = waiting.pop()
        if link is not None:
            yield link["code"]
            waiting += [link["cause"], *link["beside"]]
